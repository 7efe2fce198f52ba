"""Made-up dataset files of exact shape: a few episodes of every format, values invented."""

from __future__ import annotations

import copy
import gzip
import json
import math
from pathlib import Path
from typing import Any

SCENE = "mp3d/AAAAAAAAAAA/AAAAAAAAAAA.glb"
SIXTY_DEGREES = [-0.0, 0.5, 0.0, math.sqrt(0.75)]


def write_json(path: Path, content: Any) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    data = json.dumps(content).encode()
    path.write_bytes(gzip.compress(data, mtime=0) if path.suffix == ".gz" else data)
    return path


def r2r_episode(number: int, **changes: Any) -> dict[str, Any]:
    episode = {
        "episode_id": number,
        "trajectory_id": 40 + number // 3,
        "scene_id": SCENE,
        "start_position": [1.0, 0.17, -2.5],
        "start_rotation": SIXTY_DEGREES,
        "info": {"geodesic_distance": 6.2},
        "goals": [{"position": [4.0, 0.17, -6.0], "radius": 3.0}],
        "reference_path": [[1.0, 0.17, -2.5], [2.2, 0.17, -3.9], [3.1, 0.17, -5.2], [4.0, 0.17, -6.0]],
        "instruction": {"instruction_text": "Walk past the  table and stop. ", "instruction_tokens": [5, 9, 3, 0]},
    }
    return {**copy.deepcopy(episode), **changes}


def r2r_vocabulary() -> dict[str, Any]:
    return {
        "word_list": ["<pad>"],
        "word2idx_dict": {},
        "stoi": {},
        "itos": [],
        "num_vocab": 1,
        "UNK_INDEX": 1,
        "PAD_INDEX": 0,
    }


def gt_path() -> dict[str, Any]:
    return {"locations": [[1.0, 0.17, -2.5], [1.1, 0.17, -2.72]], "actions": [3, 1, 0], "forward_steps": 1}


def write_r2r(folder: Path, split: str = "val_unseen", count: int = 3, *, flat: bool = False, gt: bool = True) -> Path:
    """A split of R2R-CE as ``{split}/{split}.json.gz`` with its ``_gt``."""
    home = folder if flat else folder / split
    content = {"episodes": [r2r_episode(number) for number in range(1, count + 1)], "instruction_vocab": r2r_vocabulary()}
    if gt:
        write_json(home / f"{split}_gt.json.gz", {str(number): gt_path() for number in range(count, 0, -1)})
    return write_json(home / f"{split}.json.gz", content)


def rxr_episode(number: int, role: str = "guide", language: str = "en-US", **changes: Any) -> dict[str, Any]:
    info: dict[str, Any] = {"role": role}
    if role == "follower":
        info |= {"demonstration_id": "9", "metrics": {"ndtw": 0.9, "ne": 1.2, "sdtw": 0.9, "spl": 0.8, "sr": 1.0}}
    episode = {
        "episode_id": str(number),
        "trajectory_id": "1",
        "scene_id": SCENE,
        "info": info,
        "start_position": [0.2, 3.9, -16.0],
        "start_rotation": [-0.0, 0.156, 0.0, math.sqrt(1 - 0.156**2)],
        "goals": [{"position": [1.0, 3.9, -18.5], "radius": 3.0}],
        "reference_path": [[0.2, 3.9, -16.0], [1.0, 3.9, -18.5]],
        "instruction": {
            "instruction_id": "12",
            "instruction_text": "You are facing a door.",
            "language": language,
            "annotator_id": "0",
            "edit_distance": 0.08,
            "timed_instruction": [
                {"word": "You", "start_time": 1.0, "end_time": 1.5},
                {"word": "are", "start_time": math.nan, "end_time": math.nan},
            ],
        },
    }
    if role == "follower":
        del episode["trajectory_id"]
    return {**copy.deepcopy(episode), **changes}


def write_rxr(folder: Path, split: str = "val_unseen") -> Path:
    """Guides in four languages and followers in two, with their ``_gt``; word timings hold NaN."""
    guides = [rxr_episode(n, language=language) for n, language in enumerate(("en-US", "en-US", "en-IN", "hi-IN", "te-IN"), 1)]
    followers = [rxr_episode(n, "follower", language) for n, language in enumerate(("en-US", "hi-IN"), 60301)]
    for role, episodes in (("guide", guides), ("follower", followers)):
        write_json(folder / split / f"{split}_{role}.json.gz", {"episodes": episodes})
        write_json(folder / split / f"{split}_{role}_gt.json.gz", {each["episode_id"]: gt_path() for each in episodes})
    return folder / split / f"{split}_guide.json.gz"


def ovon_goal(category: str, number: int, x: float) -> dict[str, Any]:
    state = {"position": [x, 0.06, -6.2], "rotation": [0, 0, 0, 1]}
    return {
        "object_category": category,
        "object_id": f"{category}_{number}",
        "position": [x, 0.4, -7.0],
        "radius": None,
        "object_name": f"{category}_{number}",
        "object_name_id": None,
        "room_id": None,
        "room_name": None,
        "view_points": [{"agent_state": state, "iou": 0.08}],
    }


def ovon_episode(number: int, scene: str, category: str = "coffee table", **changes: Any) -> dict[str, Any]:
    episode = {
        "episode_id": str(number),
        "scene_id": f"hm3d/val/00800-{scene}/{scene}.basis.glb",
        "scene_dataset_config": "./data/scene_datasets/hm3d/hm3d_annotated_basis.scene_dataset_config.json",
        "additional_obj_config_paths": [],
        "start_position": [1.2, 0.06, -3.4],
        "start_rotation": [0, 0.7071068, 0, 0.7071068],
        "info": {"geodesic_distance": 5.1, "euclidean_distance": 4.0},
        "goals": [],
        "start_room": None,
        "shortest_paths": None,
        "object_category": category,
        "children_object_categories": [],
    }
    return {**copy.deepcopy(episode), **changes}


def ovon_shard(scene: str) -> dict[str, Any]:
    file = f"{scene}.basis.glb"
    return {
        "episodes": [
            ovon_episode(0, scene),
            ovon_episode(1, scene, "table", children_object_categories=["coffee table", "ottoman"]),
        ],
        "goals_by_category": {
            f"{file}_coffee table": [ovon_goal("coffee table", 12, 3.0), ovon_goal("coffee table", 13, 5.0)],
            f"{file}_table": [ovon_goal("table", 2, 8.0)],
        },
        "category_to_task_category_id": {},
        "category_to_scene_annotation_category_id": {},
    }


def write_ovon(folder: Path, split: str = "val_unseen", stub: str = "val_unseen_hard.json.gz") -> Path:
    """Two shards whose episode ids collide, a stub without episodes, and what macOS leaves behind."""
    write_json(folder / split / stub, {**ovon_shard("AAAAAAAAAAA"), "episodes": [], "goals_by_category": {}})
    for scene in ("AAAAAAAAAAA", "BBBBBBBBBBB"):
        write_json(folder / split / "content" / f"{scene}.json.gz", ovon_shard(scene))
    (folder / split / "content" / "._AAAAAAAAAAA.json.gz").write_bytes(b"\0\5\26\7")
    return folder / split / "content" / "AAAAAAAAAAA.json.gz"


def gn_row(number: int, **changes: Any) -> dict[str, Any]:
    row = {
        "scene": "0001_000000",
        "trajectory_id": number,
        "instruction": "Leave the bedroom and stop by the sofa.",
        "grounded_instruction": "Leave the bedroom and stop by the sofa_17.",
        "label_ins_id": 17,
        "label_label": "sofa",
        "label_goal_pixel_x": 120,
        "label_goal_pixel_y": 88,
        "start_world_x": 1.0,
        "start_world_y": 2.0,
        "start_facing_unit_dx": 0.0,
        "start_facing_unit_dy": 1.0,
        "start_facing_heading_degrees": 90.0,
        "goal_world_x": 4.0,
        "goal_world_y": 5.5,
        "path_raster_world_x": [1.0, 1.1],
        "path_raster_world_y": [2.0, 2.1],
        "path_raster_pixel_x": [200, 202],
        "path_raster_pixel_y": [150, 152],
    }
    return {**copy.deepcopy(row), **changes}


def write_gn(path: Path, rows: list[dict[str, Any]]) -> Path:
    import pyarrow
    import pyarrow.parquet

    path.parent.mkdir(parents=True, exist_ok=True)
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist(rows), path)
    return path
