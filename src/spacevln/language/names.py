"""Names that a detector gave, made harmless before a person or a model reads them.

A label is untrusted: it may come from a remote detector, a scene's metadata or a sign on a wall. Where detections are lifted, it
is cut to one short line without anything that could end a quotation or begin a section; prompts show it in double quotes and
declare those to be data.
"""

from __future__ import annotations

import unicodedata
from functools import lru_cache

MAX_NAME_CHARS = 40
_MARKUP = frozenset("\"'`<>{}[]|#*\\=")


@lru_cache(maxsize=4096)
def plain_name(text: str) -> str:
    """One line of at most ``MAX_NAME_CHARS`` printable characters without markup; ``"unnamed"`` when nothing is left."""
    kept = (" " if character in _MARKUP or unicodedata.category(character)[0] in "CZ" else character for character in text)
    line = " ".join("".join(kept).split())
    if len(line) > MAX_NAME_CHARS:
        line = line[: MAX_NAME_CHARS - 3].rstrip() + "..."
    return line or "unnamed"


def quoted(text: str) -> str:
    """A plain name in double quotes."""
    return f'"{plain_name(text)}"'


def tidy(text: str) -> str:
    """A text of several lines without control characters."""
    return "".join(character for character in text if character == "\n" or unicodedata.category(character)[0] != "C").strip()


def full_name(category: str, attributes: tuple[str, ...]) -> str:
    """A plain name with its first attribute: ``"white sofa"``."""
    return plain_name(" ".join((*attributes[:1], category)))
