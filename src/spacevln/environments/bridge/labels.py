"""What a scene's semantic annotations call the things in an image."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from spacevln.core.sensing import InstanceLabel, Labels

STRUCTURE = frozenset({"", "unknown", "void", "wall", "ceiling", "floor", "misc", "objects", "structure"})
"""Categories that name nothing one could go to."""


class SceneLabels:
    """Labels of the images of one scene.

    Args:
        names: of the scene's annotations, by id.
    """

    def __init__(self, names: Mapping[int, str]) -> None:
        self._named = {k: label_of(name) for k, name in names.items() if k > 0 and name.lower() not in STRUCTURE}
        self._kept = np.zeros(max(self._named, default=0) + 2, np.int32)  # the last stands for all ids beyond
        self._kept[list(self._named)] = list(self._named)

    def of(self, ids: NDArray[np.int32]) -> Labels:
        """Labels of an image (H, W) of annotation ids; what has no name of use becomes 0."""
        kept = self._kept.take(ids, mode="clip")
        seen = np.zeros(len(self._kept), np.bool_)
        seen[kept.ravel()] = True
        return Labels(kept, {int(k): self._named[int(k)] for k in np.flatnonzero(seen) if k})


def label_of(name: str) -> InstanceLabel:
    """The label in an annotation; exported houses put a thing's attributes in brackets behind it, "sofa (white leather)"."""
    category, _, attributes = name.lower().rstrip(")").partition(" (")
    return InstanceLabel(category, tuple(attributes.split()))
