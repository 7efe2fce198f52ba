"""One exception tree.

SpaceVLNError
├── UsageError              a value that a person gave is not allowed             exit code 2
│   └── UnknownNameError    a name that is in no list; says the nearest match
├── PrerequisiteError       something that must be installed or reachable is not  exit code 3
├── ContractError           a component broke its interface's contract (a bug, ours or a plug-in's)
├── RecordError             a run record cannot be read or written
├── ReplyRejected           one reply of a model is unusable; asked again with the reason
├── ModelError              a planner, executor or chat model failed for good     episode ends: model_failure
├── SpendingLimit           the run has spent what it may                         episode ends: interrupted; so does the run
├── EnvironmentFailure      a simulator or robot failed                           episode ends: environment_failure
└── SafetyStop              a safety rule ended the motion                        episode ends: safety

Every message is one sentence: what was wrong (with the value), what is allowed, what to do.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class SpaceVLNError(Exception):
    """Base of every error that spacevln raises on purpose."""


class UsageError(SpaceVLNError):
    """A value given by a person or a file is not allowed."""


class UnknownNameError(UsageError):
    """A name is in no list.

    Args:
        kind: what the name should have named, e.g. ``"suite"``.
        name: the name as it was given.
        allowed: every name that would have been accepted.
    """

    def __init__(self, kind: str, name: str, allowed: Iterable[str]) -> None:
        self.name = name
        self.allowed = tuple(sorted(allowed))
        near = difflib.get_close_matches(name, self.allowed, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        super().__init__(f"Unknown {kind} {name!r}: allowed are {', '.join(self.allowed)}.{hint}")


class PrerequisiteError(SpaceVLNError):
    """Something that must be installed or reachable is not; the message names the command that mends it."""


class ContractError(SpaceVLNError):
    """A component broke the contract of its interface."""


class RecordError(SpaceVLNError):
    """A run record cannot be read or written."""


class ReplyRejected(SpaceVLNError):  # noqa: N818 - an event, not a failure
    """One reply of a planner or executor is unusable.

    Args:
        kind: class of the rejection, e.g. ``"parse"``, ``"direction"``; counted in the report.
        reason: what was wrong, in words that go back to the model.
        fallbacks: what was let pass in it before, e.g. an object found in prose; counted like those of a usable reply.
    """

    def __init__(self, kind: str, reason: str, fallbacks: tuple[str, ...] = ()) -> None:
        super().__init__(reason)
        self.kind = kind
        self.reason = reason
        self.fallbacks = fallbacks


class ModelError(SpaceVLNError):
    """A planner, executor or chat model failed for good; the episode ends as ``model_failure``."""


class SpendingLimit(SpaceVLNError):  # noqa: N818 - a limit, not a failure: the episode can be resumed
    """The run has spent what ``--max-usd`` allows; it ends, and its open episodes have no result until it is resumed.

    The agent's loop ends its episode by a forced STOP, as :attr:`~spacevln.core.StopReason.SPENDING`, and returns; the attempt
    raises this again for the run.
    """


class EnvironmentFailure(SpaceVLNError):  # noqa: N818 - the word of the status it becomes
    """A simulator or robot failed; the episode ends as ``environment_failure``."""


class SafetyStop(SpaceVLNError):  # noqa: N818 - the word of the status it becomes
    """A safety rule ended the motion; the episode ends as ``safety``."""
