"""GN-Bench (GN-Matrix, InteriorGS scenes): instructions in 3-D-Gaussian-splatting worlds, one parquet file per split.

Source: arXiv 2606.03682 and https://github.com/TeleHuman/GN0. World coordinates are z-up and
need no conversion; the floor is z = 0.
Reading parquet needs the extra ``datasets``.
"""

from __future__ import annotations

import importlib
import math
from pathlib import Path
from typing import Any

import numpy as np

from spacevln.core import EpisodeSpec, InstructionTask, Pose, PrerequisiteError, wrap_angle
from spacevln.evaluation.datasets.files import (
    Coordinate,
    DatasetError,
    FileRecord,
    Identifier,
    Number,
    Text,
    read_record,
    refuse_duplicates,
    unknown_note,
)
from spacevln.evaluation.datasets.locate import locate_split
from spacevln.evaluation.datasets.sequence import EpisodeSequence, Source
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.metrics import VLN_RADIUS_M
from spacevln.evaluation.truth import Annotations, Points

SPLITS = ("train_seen", "test_seen", "test_unseen")
HEADING_TOLERANCE = 0.02


class GNRecord(FileRecord):
    """A row of the file."""

    scene: Text
    trajectory_id: Identifier
    instruction: Text
    grounded_instruction: str | None = None
    label_ins_id: Any = None
    label_label: str | None = None
    label_goal_pixel_x: int | None = None
    label_goal_pixel_y: int | None = None
    start_world_x: Coordinate
    start_world_y: Coordinate
    start_facing_unit_dx: Number
    start_facing_unit_dy: Number
    start_facing_heading_degrees: Number
    goal_world_x: Coordinate
    goal_world_y: Coordinate
    path_raster_world_x: tuple[Coordinate, ...]
    path_raster_world_y: tuple[Coordinate, ...]
    path_raster_pixel_x: tuple[int, ...] | None = None
    path_raster_pixel_y: tuple[int, ...] | None = None


def load_gn_bench(path: Path, split: str) -> EpisodeSequence:
    """The episodes of a split; the id is ``<scene>_<trajectory_id>``.

    Args:
        path: the parquet file or its folder.
        split: one of :data:`SPLITS`.

    Raises:
        DatasetError: the file is damaged.
        PrerequisiteError: pyarrow or the file is missing.
    """
    file = locate_split(path, split, f"InteriorGS_{split}", (".parquet",))
    episodes = []
    records = []
    for index, row in enumerate(_rows(file)):
        place = f"row {index}"
        record = read_record(file, place, GNRecord, row)
        records.append(("row", record))
        episodes.append(_episode(file, place, record, split))
    if not episodes:
        raise DatasetError(file, "", "it holds no row")
    refuse_duplicates(file, (episode.episode_id for episode in episodes), "trajectory_id")
    return EpisodeSequence.of(episodes, notes=unknown_note(records), source=Source.of(file))


def _rows(file: Path) -> list[dict[str, Any]]:
    try:
        parquet = importlib.import_module("pyarrow.parquet")
    except ImportError as error:
        raise PrerequisiteError("Reading GN-Bench needs pyarrow: install it with `pip install 'spacevln[datasets]'`.") from error
    arrow = importlib.import_module("pyarrow")
    try:
        rows: list[dict[str, Any]] = parquet.read_table(file).to_pylist()
    except (arrow.ArrowException, OSError, ValueError) as error:
        first = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise DatasetError(file, "", f"it is no readable parquet file ({first})") from error
    return rows


def _episode(file: Path, place: str, record: GNRecord, split: str) -> Episode:
    if len(record.path_raster_world_x) != len(record.path_raster_world_y):
        raise DatasetError(
            file,
            f"{place}, field path_raster_world_y",
            f"as many values as in path_raster_world_x are needed ({len(record.path_raster_world_x)}), "
            f"got {len(record.path_raster_world_y)}",
        )
    if not record.path_raster_world_x:
        raise DatasetError(file, f"{place}, field path_raster_world_x", "the path is empty")
    yaw = math.radians(record.start_facing_heading_degrees)
    off = math.hypot(math.cos(yaw) - record.start_facing_unit_dx, math.sin(yaw) - record.start_facing_unit_dy)
    if off > HEADING_TOLERANCE:
        raise DatasetError(
            file,
            f"{place}, field start_facing_heading_degrees",
            f"{record.start_facing_heading_degrees:g} degrees do not point along start_facing_unit_dx, _dy",
        )
    path = _on_floor(record.path_raster_world_x, record.path_raster_world_y)
    start = Pose(record.start_world_x, record.start_world_y, 0.0, wrap_angle(yaw))
    name = f"{record.scene}_{record.trajectory_id}"
    annotations = Annotations(
        targets=_on_floor((record.goal_world_x,), (record.goal_world_y,)), radius_m=VLN_RADIUS_M, nodes=path, reference_path=path
    )
    tags = {"split": split} | ({"label": record.label_label} if record.label_label else {})
    return Episode(
        EpisodeSpec(name, record.scene, start, InstructionTask(record.instruction)), annotations=annotations, tags=tags
    )


def _on_floor(x: tuple[float, ...], y: tuple[float, ...]) -> Points:
    return np.column_stack([x, y, np.zeros(len(x))])
