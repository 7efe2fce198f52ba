"""Words that stand for nothing (appendix "Model-output validation": unresolved placeholders)."""

from __future__ import annotations

import re

from spacevln.core import Anchor

_NEVER_A_NAME = frozenset({"unknown", "n/a", "null", "tbd", "todo", "undefined", "unspecified"})
_EMPTY_ANSWERS = _NEVER_A_NAME | {"na", "none", "nil", "nothing", "?", "-", "--", "..."}
_BARE_SPACES = frozenset({"area", "room", "space", "zone", "section", "place", "location", "spot"})
_ARTICLES = frozenset({"a", "an", "the", "some", "this", "that", "next", "current", "other"})
_TEMPLATE = re.compile(r"<[^<>]*>|\{[^{}]*\}|\[[^\[\]]*\]")


def is_placeholder(text: str) -> bool:
    """Whether a text is ``"none"``, ``"n/a"`` or the like, or still holds a template's slot. Empty text is not one."""
    return text.casefold().strip() in _EMPTY_ANSWERS or bool(_TEMPLATE.search(text))


def is_placeholder_name(name: str) -> bool:
    """The same for a name, which may not hold such a word anywhere: ``"unknown room"``."""
    return is_placeholder(name) or any(word.strip(".,;:()") in _NEVER_A_NAME for word in name.casefold().split())


def is_bare_space(anchor: Anchor) -> bool:
    """Whether an anchor is nothing but "the room" or "an area": no type and no cue to tell it by."""
    words = [word for word in anchor.space.casefold().split() if word not in _ARTICLES]
    return not anchor.cue and bool(words) and all(word in _BARE_SPACES for word in words)
