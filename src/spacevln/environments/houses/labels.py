"""Simulator labels: what the instances of a house are called. Never room types."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from spacevln.core.sensing import InstanceLabel, Labels
from spacevln.environments.houses.plan import House


def house_labels(house: House) -> Mapping[int, InstanceLabel]:
    """Label of every instance of a house by its id: items, doorways, openings, windows and stairs."""
    labels = {item.id: InstanceLabel(item.category, item.attributes) for item in house.items}
    labels |= {opening.id: InstanceLabel(opening.kind, opening.attributes) for opening in house.openings}
    labels |= {stairs.id: InstanceLabel("stairs") for stairs in house.stairs}
    return MappingProxyType(labels)


def image_labels(instance_ids: NDArray[np.int32], labels: Mapping[int, InstanceLabel]) -> Labels:
    """Labels of one image: the ids of its pixels, and the names of these very ids."""
    present = np.flatnonzero(np.bincount(instance_ids.ravel()))
    return Labels(instance_ids, {int(k): labels[int(k)] for k in present if k != 0})
