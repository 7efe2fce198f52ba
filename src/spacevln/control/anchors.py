"""When two anchors, or two spaces, are the same."""

from __future__ import annotations

from spacevln.core import Anchor


def _words(text: str) -> str:
    return " ".join(text.casefold().replace("_", " ").split())


def same_space(a: str, b: str) -> bool:
    """Whether two space names are equal but for case and blanks."""
    return _words(a) == _words(b)


def same_anchor(a: Anchor, b: Anchor) -> bool:
    """Whether two anchors name the same space by the same cue; their kinds may have been refined."""
    return same_space(a.space, b.space) and _words(a.cue) == _words(b.cue)
