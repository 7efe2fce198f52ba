"""When two anchors, or two spaces, are the same."""

from __future__ import annotations

from spacevln.core import Anchor
from spacevln.language import normalise_region


def same_space(a: str, b: str) -> bool:
    """Whether two space names are of the same region type, or equal free text."""
    return normalise_region(a) == normalise_region(b)


def same_anchor(a: Anchor, b: Anchor) -> bool:
    """Whether two anchors name the same space by the same cue; their kinds may have been refined."""
    return same_space(a.space, b.space) and a.cue.casefold().split() == b.cue.casefold().split()
