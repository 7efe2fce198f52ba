"""Keys: read from the environment, kept where nothing prints them."""

from __future__ import annotations

import hmac
import os
from typing import NoReturn

from spacevln.core import PrerequisiteError

MASK = "***"


class Secret:
    """A string that shows itself only when asked by name. It cannot be pickled or formatted into a text."""

    __slots__ = ("_value",)

    def __init__(self, value: str) -> None:
        self._value = value

    def reveal(self) -> str:
        """The value, for the one place that sends it."""
        return self._value

    def scrub(self, text: str) -> str:
        """The text with the value masked, wherever a server or library repeated it."""
        return text.replace(self._value, MASK) if self._value else text

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Secret) and hmac.compare_digest(self._value.encode(), other._value.encode())

    def __hash__(self) -> int:
        return hash((Secret, self._value))

    def __bool__(self) -> bool:
        return bool(self._value)

    def __repr__(self) -> str:
        return f"Secret({MASK!r})"

    def __str__(self) -> str:
        return MASK

    def __format__(self, spec: str) -> str:
        return format(MASK, spec)

    def __reduce__(self) -> NoReturn:
        raise TypeError("A Secret is never pickled: name the environment variable instead.")


def key_from_environment(name: str, *, optional: bool, purpose: str) -> Secret:
    """The key in an environment variable; an empty one where the endpoint needs none.

    Args:
        name: of the variable.
        optional: whether the endpoint may work without a key.
        purpose: whose key it is, for the message.

    Raises:
        PrerequisiteError: it is needed and not set.
    """
    value = os.environ.get(name, "").strip()
    if not (value or optional):
        raise PrerequisiteError(f"The key of {purpose} is not set: export {name}=... in this shell.")
    return Secret(value)
