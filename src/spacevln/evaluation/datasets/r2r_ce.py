"""R2R-CE in VLN-CE's format: ``R2R_VLNCE_v1-3`` and ``v1-2``, preprocessed or not.

Source: https://github.com/jacobkrantz/VLN-CE, "Data". Ground-truth paths (``{split}_gt.json.gz``) are used where they lie beside
the episodes; the test split has neither goals nor paths.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import Field

from spacevln.core import EpisodeSpec, InstructionTask
from spacevln.environments.bridge.frame import points_from_habitat, pose_from_habitat
from spacevln.evaluation.datasets.files import (
    DatasetError,
    FileRecord,
    Identifier,
    Length,
    Position,
    Text,
    UprightQuaternion,
    list_of,
    read_json,
    read_record,
    record_place,
    refuse_duplicates,
    unknown_note,
)
from spacevln.evaluation.datasets.locate import locate_split
from spacevln.evaluation.datasets.scenes import scene_name
from spacevln.evaluation.datasets.sequence import EpisodeSequence, Source
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.truth import Annotations, Points

SPLITS = ("train", "val_seen", "val_unseen", "test")
VAL_UNSEEN_EPISODES = 1839

KNOWN_SHA256 = {
    "1767a407e2c8a011fbb7abece76cd64c5b39ff9fa0e9e340ebdce5a490d167c3": "R2R_VLNCE_v1-3_preprocessed val_unseen",
    "d173d8028537f30ab652dc5d24ead737e2b6010b6a4599f974351685710d18e8": "R2R_VLNCE_v1-3 val_unseen",
    "b48654aed06f0323340b6a3b3854ca98e049cb77e612b0b4e55f45a77f8e9a27": "R2R_VLNCE_v1-2_preprocessed val_unseen",
    "7db0a39bef374cf5ce986473f8b35c9721f962c6c1a9af069257aa710df16365": "R2R_VLNCE_v1-2_preprocessed_BERTidx val_unseen",
}


class Goal(FileRecord):
    """A goal position and its success radius."""

    position: Position
    radius: Annotated[float, Field(strict=True, gt=0, allow_inf_nan=False)]


class Instruction(FileRecord):
    """The words."""

    instruction_text: Text
    instruction_tokens: tuple[int, ...] | None = None


class Info(FileRecord):
    """Start-to-goal distance; RxR-CE has a role instead; our suites add difficulty tags."""

    geodesic_distance: Length | None = None
    tags: dict[str, str | float | int | bool] = Field(default_factory=dict)


class RouteRecord(FileRecord):
    """What episodes of R2R-CE and RxR-CE have in common."""

    episode_id: Identifier
    trajectory_id: Identifier | None = None
    scene_id: Text
    start_position: Position
    start_rotation: UprightQuaternion
    info: Info | None = None
    goals: Annotated[tuple[Goal, ...], Field(min_length=1)] | None = None
    reference_path: Annotated[tuple[Position, ...], Field(min_length=1)] | None = None
    instruction: Instruction

    @property
    def records(self) -> tuple[tuple[str, FileRecord], ...]:
        """The record and its parts, with their places."""
        parts: list[tuple[str, FileRecord]] = [("episodes[]", self), ("episodes[].instruction", self.instruction)]
        if self.info is not None:
            parts.append(("episodes[].info", self.info))
        parts += [("episodes[].goals[]", goal) for goal in self.goals or ()]
        return tuple(parts)


class R2RRecord(RouteRecord):
    """An episode of the file."""

    trajectory_id: Identifier


class PathRecord(FileRecord):
    """A ground-truth path of the ``_gt`` file."""

    locations: Annotated[tuple[Position, ...], Field(min_length=1)]
    actions: tuple[Annotated[int, Field(strict=True, ge=0, le=3)], ...] | None = None
    forward_steps: Annotated[int, Field(strict=True, ge=0)]


def load_r2r_ce(path: Path, split: str) -> EpisodeSequence:
    """The episodes of a split.

    Args:
        path: the file, its folder, or the folder of all splits.
        split: one of :data:`SPLITS`.

    Raises:
        DatasetError: a file is missing or damaged.
    """
    file = locate_split(path, split)
    records = read_episodes(file, R2RRecord, needs_truth=not split.startswith("test"))
    paths, gt_file = read_paths(file)
    episodes = [
        Episode(
            EpisodeSpec(
                record.episode_id,
                scene_name(record.scene_id),
                pose_from_habitat(record.start_position, record.start_rotation),
                InstructionTask(record.instruction.instruction_text),
            ),
            annotations=annotations_of(record, paths),
            tags={"split": split, "trajectory": record.trajectory_id, **(record.info.tags if record.info else {})},
        )
        for record in records
    ]
    source = Source.of(file, *([gt_file] if gt_file else []))
    notes = (
        *_version_notes(episodes, source),
        *unknown_note(part for record in records for part in record.records),
        *path_notes(records, paths, gt_file),
    )
    return EpisodeSequence.of(episodes, notes=notes, source=source)


T = TypeVar("T", bound=RouteRecord)


def read_episodes(file: Path, kind: type[T], *, needs_truth: bool) -> list[T]:
    """Every record of a file, validated.

    Raises:
        DatasetError: damaged, or two records share an id.
    """
    data = list_of(file, read_json(file), "episodes")
    records = []
    for index, each in enumerate(data):
        place = record_place("episode", index, each)
        record = read_record(file, place, kind, each)
        if needs_truth and record.goals is None:
            raise DatasetError(file, f"{place}, field goals", "it is missing, and only test splits come without goals")
        if needs_truth and record.reference_path is None:
            raise DatasetError(file, f"{place}, field reference_path", "it is missing, and only test splits come without paths")
        records.append(record)
    refuse_duplicates(file, (record.episode_id for record in records))
    return records


def read_paths(file: Path) -> tuple[dict[str, Points], Path | None]:
    """Dense ground-truth paths by episode id, scene frame, and their file; none where it is not there.

    Raises:
        DatasetError: the file is damaged.
    """
    stem = file.name.partition(".")[0]
    candidates = [file.with_name(file.name.replace(stem, f"{stem}_gt", 1)), file.with_name(f"{stem}_gt.json")]
    gt_file = next((candidate for candidate in candidates if candidate.exists()), None)
    if gt_file is None:
        return {}, None
    content = read_json(gt_file)
    if not isinstance(content, Mapping):
        raise DatasetError(gt_file, "", "an object from episode id to path is needed")
    return {name: _path(gt_file, str(name), data) for name, data in content.items()}, gt_file


def _path(file: Path, name: str, data: Any) -> Points:
    place = f"path of episode {name}"
    record = read_record(file, place, PathRecord, data)
    if len(record.locations) != record.forward_steps + 1:
        raise DatasetError(
            file,
            f"{place}, field locations",
            f"{record.forward_steps} forward steps visit {record.forward_steps + 1} positions, got {len(record.locations)}",
        )
    return points_from_habitat(record.locations)


def annotations_of(record: RouteRecord, paths: Mapping[str, Points]) -> Annotations | None:
    """The truth of a record; None for test splits."""
    if record.goals is None:
        return None
    return Annotations(
        targets=points_from_habitat([goal.position for goal in record.goals]),
        radius_m=record.goals[0].radius,
        nodes=points_from_habitat(record.reference_path or ()),
        reference_path=paths.get(record.episode_id),
        geodesic_m=record.info.geodesic_distance if record.info else None,
    )


def path_notes(records: Sequence[RouteRecord], paths: Mapping[str, Points], gt_file: Path | None) -> tuple[str, ...]:
    """What is to be said about ground-truth paths that are missing."""
    if gt_file is None:
        return ("no ground-truth paths (_gt file) beside the episodes: nDTW and SDTW are null",)
    missing = [record.episode_id for record in records if record.episode_id not in paths]
    return (f"{len(missing)} episodes have no ground-truth path, e.g. {missing[0]}: their nDTW is null",) if missing else ()


def _version_notes(episodes: Sequence[Episode], source: Source) -> tuple[str, ...]:
    known = next((KNOWN_SHA256[digest] for _, digest in source.files if digest in KNOWN_SHA256), None)
    turns = np.array([episode.start.yaw_rad for episode in episodes]) / math.radians(30)
    regular = bool(np.all(np.abs(turns - np.round(turns)) < 1e-3))
    notes = [f"known file: {known}"] if known else []
    if not regular:
        notes.append("start headings are no multiples of 30 degrees: this is version v1-2, the paper's is v1-3")
    return tuple(notes)
