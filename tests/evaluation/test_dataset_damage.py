"""Thirty kinds of damage to every format end in one sentence that names the file, the record and the field."""

from __future__ import annotations

import copy
import gzip
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import made_up
import pytest

from spacevln.evaluation import datasets
from spacevln.evaluation.datasets import DatasetError

Content = dict[str, Any]
RECORD = 1  # the damaged one of three, so that its number in the message means something


def load(suite: str, path: Path) -> None:
    with pytest.raises(DatasetError) as caught:
        datasets.load(suite, path)
    message = str(caught.value)
    assert "\n" not in message
    assert message.endswith("get the file again, or mend the record.")
    raise caught.value


def put(*path: str | int, value: Any) -> Callable[[Content], None]:
    """Set what lies at a path."""

    def change(content: Content) -> None:
        node: Any = content
        for key in path[:-1]:
            node = node[key]
        node[path[-1]] = value

    return change


def drop(*path: str | int) -> Callable[[Content], None]:
    """Remove what lies at a path."""

    def change(content: Content) -> None:
        node: Any = content
        for key in path[:-1]:
            node = node[key]
        del node[path[-1]]

    return change


# -- damage to the bytes of any JSON file ------------------------------------------------------------------------------------


def cut_short(data: bytes) -> bytes:
    return gzip.compress(data)[: len(gzip.compress(data)) // 2]


def not_gzip(data: bytes) -> bytes:
    return data


def flipped(data: bytes) -> bytes:
    packed = bytearray(gzip.compress(data))
    packed[len(packed) // 2] ^= 0xFF
    return bytes(packed)


def half_json(data: bytes) -> bytes:
    return gzip.compress(data[: len(data) // 2])


def not_utf8(data: bytes) -> bytes:
    return gzip.compress(data.replace(b"A", b"\xff", 1))


def empty(data: bytes) -> bytes:
    del data
    return b""


BYTES = (cut_short, not_gzip, flipped, half_json, not_utf8, empty)
WHOLE = {
    "a list": [],
    "a number": 3,
    "no episodes": {"instruction_vocab": {}},
    "episodes is an object": {"episodes": {}},
    "episodes is empty": {"episodes": []},
    "an episode is a string": {"episodes": ["x"]},
    "an episode is null": {"episodes": [None]},
}

E = ("episodes", RECORD)
POSE = {
    "id missing": (drop(*E, "episode_id"), "episode_id"),
    "id null": (put(*E, "episode_id", value=None), "episode_id"),
    "id empty": (put(*E, "episode_id", value=" "), "episode_id"),
    "id a list": (put(*E, "episode_id", value=[1]), "episode_id"),
    "scene missing": (drop(*E, "scene_id"), "scene_id"),
    "scene a number": (put(*E, "scene_id", value=7), "scene_id"),
    "scene empty": (put(*E, "scene_id", value=""), "scene_id"),
    "position missing": (drop(*E, "start_position"), "start_position"),
    "position of two": (put(*E, "start_position", value=[1.0, 2.0]), "start_position"),
    "position a word": (put(*E, "start_position", 1, value="0.17"), "start_position.1"),
    "position NaN": (put(*E, "start_position", 0, value=math.nan), "start_position.0"),
    "position infinite": (put(*E, "start_position", 2, value=math.inf), "start_position.2"),
    "position on the moon": (put(*E, "start_position", 2, value=3.8e8), "start_position.2"),
    "position null": (put(*E, "start_position", 2, value=None), "start_position.2"),
    "rotation missing": (drop(*E, "start_rotation"), "start_rotation"),
    "rotation of three": (put(*E, "start_rotation", value=[0, 1, 0]), "start_rotation"),
    "rotation zero": (put(*E, "start_rotation", value=[0, 0, 0, 0]), "start_rotation"),
    "rotation not of length 1": (put(*E, "start_rotation", value=[0, 1, 0, 1]), "start_rotation"),
    "rotation tilted": (put(*E, "start_rotation", value=[0.6, 0, 0, 0.8]), "start_rotation"),
    "rotation w first": (put(*E, "start_rotation", value=[1.0, 0.0, 0.0, 0.0]), "start_rotation"),
}
ROUTE = POSE | {
    "goals missing": (drop(*E, "goals"), "goals"),
    "goals empty": (put(*E, "goals", value=[]), "goals"),
    "goal without position": (drop(*E, "goals", 0, "position"), "goals.0.position"),
    "goal position of two": (put(*E, "goals", 0, "position", value=[1.0, 2.0]), "goals.0.position"),
    "goal position NaN": (put(*E, "goals", 0, "position", 1, value=math.nan), "goals.0.position.1"),
    "radius missing": (drop(*E, "goals", 0, "radius"), "goals.0.radius"),
    "radius negative": (put(*E, "goals", 0, "radius", value=-3.0), "goals.0.radius"),
    "path missing": (drop(*E, "reference_path"), "reference_path"),
    "path empty": (put(*E, "reference_path", value=[]), "reference_path"),
    "path with a hole": (put(*E, "reference_path", 1, value=None), "reference_path.1"),
    "instruction missing": (drop(*E, "instruction"), "instruction"),
    "instruction a string": (put(*E, "instruction", value="Go."), "instruction"),
    "text missing": (drop(*E, "instruction", "instruction_text"), "instruction.instruction_text"),
    "text blank": (put(*E, "instruction", "instruction_text", value=" \n"), "instruction.instruction_text"),
    "text a number": (put(*E, "instruction", "instruction_text", value=4), "instruction.instruction_text"),
}
R2R = ROUTE | {
    "trajectory missing": (drop(*E, "trajectory_id"), "trajectory_id"),
    "distance negative": (put(*E, "info", "geodesic_distance", value=-1.0), "info.geodesic_distance"),
    "distance NaN": (put(*E, "info", "geodesic_distance", value=math.nan), "info.geodesic_distance"),
    "same id twice": (put(*E, "episode_id", value=1), "episode_id"),
}
RXR = ROUTE | {
    "unknown language": (put(*E, "instruction", "language", value="xx-XX"), "instruction.language"),
    "unknown role": (put(*E, "info", "role", value="leader"), "info.role"),
    "timings no list": (put(*E, "instruction", "timed_instruction", value="3"), "instruction.timed_instruction"),
    "same id twice": (put(*E, "episode_id", value="1"), "episode_id"),
}
CATEGORY = "AAAAAAAAAAA.basis.glb_coffee table"
G = ("goals_by_category", CATEGORY)
OVON_EPISODE = POSE | {
    "category missing": (drop(*E, "object_category"), "object_category"),
    "category without goals": (put(*E, "object_category", value="unicorn"), "object_category"),
    "children a word": (put(*E, "children_object_categories", value="desk"), "children_object_categories"),
    "distance a word": (put(*E, "info", "geodesic_distance", value="far"), "info.geodesic_distance"),
    "same id twice": (put(*E, "episode_id", value="0"), "episode_id"),
}
OVON_GOAL = {
    "goals missing": (drop("goals_by_category"), "field goals_by_category"),
    "goals a list": (put("goals_by_category", value=[]), "field goals_by_category"),
    "group null": (put(*G, value=None), CATEGORY),
    "goal a string": (put(*G, 1, value="x"), f"goal 1 of {CATEGORY!r}"),
    "goal without view points": (drop(*G, 1, "view_points"), "field view_points"),
    "view point without state": (drop(*G, 1, "view_points", 0, "agent_state"), "field view_points.0.agent_state"),
    "view point of two": (
        put(*G, 1, "view_points", 0, "agent_state", "position", value=[1.0, 2.0]),
        "field view_points.0.agent_state.position",
    ),
    "view point not turned": (
        put(*G, 1, "view_points", 0, "agent_state", "rotation", value=[0, 0, 0, 0]),
        "field view_points.0.agent_state.rotation",
    ),
    "goal position NaN": (put(*G, 1, "position", 0, value=math.nan), "field position.0"),
    "object id missing": (drop(*G, 1, "object_id"), "field object_id"),
}


@pytest.mark.parametrize("damage", BYTES)
@pytest.mark.parametrize("suite", ["r2r-ce", "rxr-ce", "hm3d-ovon"])
def test_damaged_bytes_name_the_file(suite: str, damage: Callable[[bytes], bytes], tmp_path: Path) -> None:
    file = tmp_path / "val_unseen.json.gz"
    content = {"r2r-ce": lambda: {"episodes": [made_up.r2r_episode(1)]}, "rxr-ce": lambda: {"episodes": [made_up.rxr_episode(1)]}}
    data = json.dumps(content.get(suite, lambda: made_up.ovon_shard("AAAAAAAAAAA"))()).encode()
    file.write_bytes(damage(data))
    with pytest.raises(DatasetError, match=r"val_unseen\.json\.gz"):
        load(suite, file)


@pytest.mark.parametrize("kind", WHOLE)
@pytest.mark.parametrize("suite", ["r2r-ce", "rxr-ce", "hm3d-ovon"])
def test_a_file_of_another_shape_is_refused(suite: str, kind: str, tmp_path: Path) -> None:
    file = made_up.write_json(tmp_path / "x.json.gz", WHOLE[kind])
    with pytest.raises(DatasetError, match=r"x\.json\.gz"):
        load(suite, file)


def damaged(suite: str, content: Content, change: Callable[[Content], None], field: str, place: str, tmp_path: Path) -> None:
    content = copy.deepcopy(content)
    change(content)
    file = made_up.write_json(tmp_path / "some_split.json.gz", content)
    with pytest.raises(DatasetError) as caught:
        load(suite, file)
    message = str(caught.value)
    assert str(file) in message
    assert place in message
    assert field in message


@pytest.mark.parametrize("kind", R2R)
def test_damaged_r2r_ce(kind: str, tmp_path: Path) -> None:
    content = {"episodes": [made_up.r2r_episode(n) for n in (1, 2, 3)], "instruction_vocab": {}}
    damaged("r2r-ce", content, *R2R[kind], f"episode {RECORD}", tmp_path)


@pytest.mark.parametrize("kind", RXR)
def test_damaged_rxr_ce(kind: str, tmp_path: Path) -> None:
    damaged("rxr-ce", {"episodes": [made_up.rxr_episode(n) for n in (1, 2, 3)]}, *RXR[kind], f"episode {RECORD}", tmp_path)


@pytest.mark.parametrize("kind", OVON_EPISODE)
def test_damaged_ovon_episodes(kind: str, tmp_path: Path) -> None:
    damaged("hm3d-ovon", made_up.ovon_shard("AAAAAAAAAAA"), *OVON_EPISODE[kind], f"episode {RECORD}", tmp_path)


@pytest.mark.parametrize("kind", OVON_GOAL)
def test_damaged_ovon_goals(kind: str, tmp_path: Path) -> None:
    damaged("hm3d-ovon", made_up.ovon_shard("AAAAAAAAAAA"), *OVON_GOAL[kind], "goal", tmp_path)


GT = {
    "a list": ([], "an object"),
    "a path null": ({"1": None}, "path of episode 1"),
    "no locations": ({"1": {"actions": [0], "forward_steps": 0}}, "path of episode 1, field locations"),
    "locations empty": ({"1": made_up.gt_path() | {"locations": []}}, "path of episode 1, field locations"),
    "a location of two": ({"1": made_up.gt_path() | {"locations": [[1, 2]]}}, "path of episode 1, field locations.0"),
    "an unknown action": ({"1": made_up.gt_path() | {"actions": [7]}}, "path of episode 1, field actions.0"),
    "steps and locations disagree": ({"1": made_up.gt_path() | {"forward_steps": 5}}, "path of episode 1, field locations"),
}


@pytest.mark.parametrize("kind", GT)
@pytest.mark.parametrize("suite", ["r2r-ce", "rxr-ce"])
def test_damaged_ground_truth_paths(suite: str, kind: str, tmp_path: Path) -> None:
    content, place = GT[kind]
    episode = made_up.r2r_episode(1) if suite == "r2r-ce" else made_up.rxr_episode(1)
    made_up.write_json(tmp_path / "val_unseen_gt.json.gz", content)
    file = made_up.write_json(tmp_path / "val_unseen.json.gz", {"episodes": [episode]})
    with pytest.raises(DatasetError, match=r"val_unseen_gt\.json\.gz") as caught:
        load(suite, file)
    assert place in str(caught.value)


ROW = made_up.gn_row(3)
GN = (
    {
        f"without {column}": (column, None)
        for column, value in ROW.items()
        if column in ("scene", "instruction") or "world" in column
    }
    | {"without trajectory_id": ("trajectory_id", None), "without heading": ("start_facing_heading_degrees", None)}
    | {"without dx": ("start_facing_unit_dx", None), "without dy": ("start_facing_unit_dy", None)}
)
GN_VALUES = {
    "scene blank": ("scene", " "),
    "instruction blank": ("instruction", ""),
    "instruction a number": ("instruction", 4),
    "start NaN": ("start_world_x", math.nan),
    "start infinite": ("start_world_y", math.inf),
    "start far away": ("start_world_y", 1e9),
    "start a word": ("start_world_x", "1.0"),
    "goal NaN": ("goal_world_x", math.nan),
    "goal a word": ("goal_world_y", "x"),
    "heading NaN": ("start_facing_heading_degrees", math.nan),
    "heading elsewhere": ("start_facing_heading_degrees", 270.0),
    "heading in radians": ("start_facing_heading_degrees", 1.5708),
    "path empty": ("path_raster_world_x", []),
    "path shorter in y": ("path_raster_world_y", [2.0]),
    "path NaN": ("path_raster_world_x", [1.0, math.nan]),
    "path a number": ("path_raster_world_x", 1.0),
    "trajectory blank": ("trajectory_id", ""),
    "pixels a word": ("path_raster_pixel_x", "x"),
}


@pytest.mark.parametrize("kind", GN | GN_VALUES)
@pytest.mark.parametrize("null", [False, True])
def test_damaged_gn_bench(kind: str, null: bool, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    column, value = (GN | GN_VALUES)[kind]
    row = dict(ROW)
    if kind in GN and not null:
        del row[column]
    else:
        row[column] = value
    if column == "path_raster_world_x" and value == []:
        row["path_raster_world_y"] = []
    file = made_up.write_gn(tmp_path / "InteriorGS_test_unseen.parquet", [row])
    with pytest.raises(DatasetError) as caught:
        load("gn-bench", file)
    assert f"{str(file)!r}, row 0, field {column}" in str(caught.value)


@pytest.mark.parametrize("kind", ["cut short", "empty", "text", "no rows", "same trajectory twice"])
def test_damaged_gn_bench_files(kind: str, tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    rows = [made_up.gn_row(3), made_up.gn_row(3)] if kind == "same trajectory twice" else [made_up.gn_row(3)]
    file = made_up.write_gn(tmp_path / "x.parquet", rows)
    data = file.read_bytes()
    if kind == "no rows":
        import pyarrow.parquet

        pyarrow.parquet.write_table(pyarrow.parquet.read_table(file)[:0], file)
    elif kind != "same trajectory twice":
        file.write_bytes({"cut short": data[: len(data) // 2], "empty": b"", "text": b"a,b\n1,2\n"}[kind])
    with pytest.raises(DatasetError, match=r"x\.parquet"):
        load("gn-bench", file)


def test_there_are_at_least_thirty_kinds_for_every_format() -> None:
    common = len(BYTES) + len(WHOLE)
    assert common + len(R2R) >= 30
    assert common + len(RXR) >= 30
    assert common + len(OVON_EPISODE) + len(OVON_GOAL) >= 30
    assert len(GN) + len(GN_VALUES) + 5 >= 30
