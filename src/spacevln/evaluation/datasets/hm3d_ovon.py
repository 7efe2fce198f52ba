"""HM3D-OVON: open-vocabulary object goals in HM3D scenes, sharded by scene.

Source: https://github.com/naokiyokoyama/ovon (dataset generator and loader). A split's folder holds a stub without episodes and
``content/<scene>.json.gz``; goals are shared by category. Episode ids restart in every scene, so ours are ``<scene>-<id>``.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path, PurePosixPath
from typing import Annotated, Any

from pydantic import Field

from spacevln.core import EpisodeSpec, ObjectGoalTask, PrerequisiteError
from spacevln.environments.bridge.frame import points_from_habitat, pose_from_habitat
from spacevln.evaluation.datasets.files import (
    DatasetError,
    FileRecord,
    Identifier,
    Length,
    Position,
    Quaternion,
    Text,
    UprightQuaternion,
    list_of,
    read_json,
    read_record,
    record_place,
    refuse_duplicates,
    shown,
    unknown_note,
)
from spacevln.evaluation.datasets.scenes import scene_name
from spacevln.evaluation.datasets.sequence import EpisodeSequence, Source
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.metrics import VIEWPOINT_RADIUS_M
from spacevln.evaluation.truth import Annotations

SPLITS = ("train", "val_seen", "val_seen_synonyms", "val_unseen")


class AgentState(FileRecord):
    """Where a camera stood that saw the goal."""

    position: Position
    rotation: Quaternion


class ViewPoint(FileRecord):
    """A place from which the goal object is seen from at most 1 m."""

    agent_state: AgentState
    iou: Annotated[float, Field(strict=True, ge=0, allow_inf_nan=False)] | None = None
    radius: float | None = None


class ObjectGoalRecord(FileRecord):
    """An instance of a category."""

    object_category: Text
    object_id: Identifier
    position: Position
    view_points: tuple[ViewPoint, ...]
    radius: float | None = None
    object_name: Any = None
    object_name_id: Any = None
    room_id: Any = None
    room_name: Any = None


class OvonInfo(FileRecord):
    """Distances to the nearest view point."""

    geodesic_distance: Length | None = None
    euclidean_distance: Length | None = None
    tags: dict[str, str | float | int | bool] = Field(default_factory=dict)


class OvonRecord(FileRecord):
    """An episode of a shard."""

    episode_id: Identifier
    scene_id: Text
    start_position: Position
    start_rotation: UprightQuaternion
    object_category: Text
    children_object_categories: tuple[Text, ...] = ()
    info: OvonInfo | None = None
    scene_dataset_config: Any = None
    additional_obj_config_paths: Any = None
    goals: Any = None
    start_room: Any = None
    shortest_paths: Any = None


Goals = dict[str, tuple[ObjectGoalRecord, ...]]


def load_hm3d_ovon(path: Path, split: str) -> EpisodeSequence:
    """The episodes of a split, scene by scene.

    Args:
        path: the folder of a split (with ``content/``), of all splits, or one shard.
        split: one of :data:`SPLITS`.

    Raises:
        DatasetError: a shard is damaged.
        PrerequisiteError: there are no shards.
    """
    shards = _shards(path, split)
    episodes: list[Episode] = []
    read: list[tuple[str, FileRecord]] = []
    for shard in shards:
        content = read_json(shard)
        data = list_of(shard, content, "episodes", empty_ok=len(shards) > 1)
        goals = _goals(shard, content)
        read += [("goals_by_category[][]", goal) for group in goals.values() for goal in group]
        shard_ids = []
        for index, each in enumerate(data):
            place = record_place("episode", index, each)
            record = read_record(shard, place, OvonRecord, each)
            read.append(("episodes[]", record))
            shard_ids.append(record.episode_id)
            episodes.append(_episode(shard, place, record, goals, split))
        refuse_duplicates(shard, shard_ids)
    if not episodes:
        raise DatasetError(shards[0].parent, "", "no shard holds an episode")
    refuse_duplicates(shards[-1], (episode.episode_id for episode in episodes))
    return EpisodeSequence.of(episodes, notes=unknown_note(read), source=Source.of(*shards))


def _shards(path: Path, split: str) -> list[Path]:
    if path.is_file():
        return [path]
    for folder in (path / split, path):
        content = _json_files(folder / "content")
        if content:
            return content
        single = _json_files(folder)
        if single:  # a split in one file
            return single
    raise PrerequisiteError(
        f"Split {split!r} of HM3D-OVON is not at {str(path)!r}: looked for content/*.json.gz in {split}/ and there; "
        "give the folder of the split (docs/benchmarks.md says where to get it)."
    )


def _json_files(folder: Path) -> list[Path]:
    names = sorted(folder.glob("*.json.gz")) + sorted(folder.glob("*.json"))
    return [name for name in names if not name.name.startswith("._")]  # what macOS leaves in archives


def _goals(shard: Path, content: Mapping[str, Any]) -> Goals:
    table = content.get("goals_by_category")
    if not isinstance(table, Mapping):
        raise DatasetError(
            shard, "field goals_by_category", f"an object from category to goals is needed, this is {shown(table)}"
        )
    goals: Goals = {}
    for key, group in table.items():
        if not isinstance(group, list):
            raise DatasetError(shard, f"field goals_by_category.{key}", f"a list of goals is needed, this is {shown(group)}")
        goals[key] = tuple(
            read_record(shard, f"goal {index} of {key!r}", ObjectGoalRecord, each) for index, each in enumerate(group)
        )
    return goals


def _episode(shard: Path, place: str, record: OvonRecord, goals: Goals, split: str) -> Episode:
    """OVON's rule: the targets are the view points of the category's goals and of its children's, missing children skipped."""
    file_name = PurePosixPath(record.scene_id).name
    own = goals.get(f"{file_name}_{record.object_category}")
    if not own:
        raise DatasetError(
            shard,
            f"{place}, field object_category",
            f"goals_by_category has no goals of {record.object_category!r} in {file_name!r}",
        )
    wanted = [*own]
    for child in record.children_object_categories:
        wanted += goals.get(f"{file_name}_{child}", ())
    viewpoints = [viewpoint.agent_state.position for goal in wanted for viewpoint in goal.view_points]
    if not viewpoints:
        raise DatasetError(shard, f"{place}, field object_category", f"no goal of {record.object_category!r} has a view point")
    scene = scene_name(record.scene_id)
    annotations = Annotations(
        targets=points_from_habitat(viewpoints),
        radius_m=VIEWPOINT_RADIUS_M,
        geodesic_m=record.info.geodesic_distance if record.info else None,
        objects=points_from_habitat([goal.position for goal in wanted]),
    )
    return Episode(
        EpisodeSpec(
            f"{file_name.partition('.')[0]}-{record.episode_id}",
            scene,
            pose_from_habitat(record.start_position, record.start_rotation),
            ObjectGoalTask(record.object_category),
        ),
        annotations=annotations,
        tags={"split": split, "category": record.object_category, **(record.info.tags if record.info else {})},
    )
