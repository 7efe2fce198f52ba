"""Every format, from made-up files of exact shape, and R2R-CE val_seen where it is at hand."""

from __future__ import annotations

import math
import os
from pathlib import Path

import made_up
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from spacevln.core import Pose, PrerequisiteError, UsageError
from spacevln.environments.bridge.frame import (
    points_from_habitat,
    points_to_habitat,
    pose_from_habitat,
    pose_to_habitat,
)
from spacevln.evaluation import datasets
from spacevln.evaluation.datasets.scenes import scene_path

R2R_FOLDER = os.environ.get("SPACEVLN_R2R_CE")


def test_r2r_ce(tmp_path: Path) -> None:
    made_up.write_r2r(tmp_path)
    episodes = datasets.load("r2r-ce", tmp_path)
    assert episodes.ids == ("1", "2", "3")
    first = episodes[0]
    assert first.instruction == "Walk past the table and stop."
    assert first.scene == made_up.SCENE
    assert first.start.position_m == pytest.approx([2.5, -1.0, 0.17])
    assert math.degrees(first.start.yaw_rad) == pytest.approx(60)
    assert first.truth is None
    known = first.annotations
    assert known is not None
    assert known.targets.tolist() == [pytest.approx([6.0, -4.0, 0.17])]
    assert known.radius_m == 3.0
    assert known.geodesic_m == 6.2
    assert known.nodes is not None
    assert known.nodes.shape == (4, 3)
    assert known.reference_path is not None
    assert known.reference_path.tolist()[1] == pytest.approx([2.72, -1.1, 0.17])
    assert episodes.notes == ()
    assert episodes.source is not None
    assert [name for name, _ in episodes.source.files] == ["val_unseen.json.gz", "val_unseen_gt.json.gz"]


@pytest.mark.parametrize("where", ["root", "folder", "file"])
def test_a_split_is_found_by_its_root_its_folder_or_its_file(tmp_path: Path, where: str) -> None:
    file = made_up.write_r2r(tmp_path, flat=where == "folder")
    assert len(datasets.load("r2r-ce", file if where == "file" else tmp_path)) == 3


def test_version_1_2_is_noticed_by_its_headings(tmp_path: Path) -> None:
    odd = [made_up.r2r_episode(1, start_rotation=[0.0, math.sin(0.1), 0.0, math.cos(0.1)])]
    file = made_up.write_json(tmp_path / "val_unseen.json", {"episodes": odd})
    notes = " ".join(datasets.load("r2r-ce", file).notes)
    assert "v1-2" in notes
    assert "nDTW and SDTW are null" in notes


def test_the_test_split_comes_without_goals(tmp_path: Path) -> None:
    episode = made_up.r2r_episode(5)
    for key in ("goals", "reference_path", "info"):
        del episode[key]
    made_up.write_json(tmp_path / "test/test.json.gz", {"episodes": [episode]})
    (loaded,) = datasets.load("r2r-ce", tmp_path, split="test")
    assert loaded.annotations is None
    assert loaded.instruction


def test_unknown_keys_are_listed_and_not_fatal(tmp_path: Path) -> None:
    episodes = [made_up.r2r_episode(n, weather="rain") for n in (1, 2)]
    episodes[0]["instruction"]["mood"] = "cheerful"
    file = made_up.write_json(tmp_path / "val_seen.json.gz", {"episodes": episodes})
    notes = " ".join(datasets.load("r2r-ce", file, split="val_seen").notes)
    assert "episodes[].weather (2x)" in notes
    assert "episodes[].instruction.mood (1x)" in notes


def test_rxr_ce_roles_languages_and_nan(tmp_path: Path) -> None:
    made_up.write_rxr(tmp_path)
    guides = datasets.load("rxr-ce", tmp_path)
    assert len(guides) == 5
    assert "guide en-US 2" in guides.notes[0]
    both = datasets.load("rxr-ce", tmp_path, role=["guide", "follower"], language="en-US")
    assert both.ids == ("1", "2", "60301")
    assert [episode.tags["role"] for episode in both] == ["guide", "guide", "follower"]
    assert both[2].annotations is not None
    assert both[2].annotations.reference_path is not None
    assert datasets.load("rxr-ce", tmp_path, language=("hi-IN", "te-IN")).ids == ("4", "5")


def test_a_language_cannot_be_picked_where_none_is_named(tmp_path: Path) -> None:
    plain = made_up.rxr_episode(1, instruction={"instruction_text": "Go.", "instruction_tokens": []})
    file = made_up.write_json(tmp_path / "val_unseen_guide_en.json.gz", {"episodes": [plain]})
    assert len(datasets.load("rxr-ce", file)) == 1
    with pytest.raises(UsageError, match="names no language"):
        datasets.load("rxr-ce", file, language="en-US")


def test_hm3d_ovon_shards_goals_by_category_and_children(tmp_path: Path) -> None:
    made_up.write_ovon(tmp_path)
    episodes = datasets.load("hm3d-ovon", tmp_path)
    assert episodes.ids == ("AAAAAAAAAAA-0", "AAAAAAAAAAA-1", "BBBBBBBBBBB-0", "BBBBBBBBBBB-1")
    assert episodes[0].goal == "coffee table"
    own, with_children = episodes[0].annotations, episodes[1].annotations
    assert own is not None
    assert with_children is not None
    assert own.radius_m == 0.25
    assert own.targets.shape == (2, 3)  # the nearest view point of any instance counts
    assert with_children.targets.shape == (3, 3)  # the category's and its children's; a child without goals is skipped
    assert own.objects is not None
    assert len(datasets.load("hm3d-ovon", tmp_path / "val_unseen")) == 4
    assert len(datasets.load("hm3d-ovon", tmp_path, scene="BBBBBBBBBBB")) == 2
    assert len(datasets.load("hm3d-ovon", tmp_path, scene="00800-AAAAAAAAAAA")) == 2


def test_gn_bench(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    made_up.write_gn(tmp_path / "InteriorGS_test_unseen.parquet", [made_up.gn_row(n) for n in (3, 4)])
    episodes = datasets.load("gn-bench", tmp_path)
    assert episodes.ids == ("0001_000000_3", "0001_000000_4")
    assert episodes[0].start == Pose(1.0, 2.0, 0.0, pytest.approx(math.pi / 2))
    known = episodes[0].annotations
    assert known is not None
    assert known.targets.tolist() == [[4.0, 5.5, 0.0]]
    assert known.reference_path is not None
    assert len(known.reference_path) == 2


def test_filters(tmp_path: Path) -> None:
    made_up.write_r2r(tmp_path, count=40)

    def ids(**filters: object) -> tuple[str, ...]:
        return datasets.load("r2r-ce", tmp_path, **filters).ids

    assert ids(slice="10:13") == ("11", "12", "13")
    assert ids(slice="38:") == ("39", "40")
    assert ids(ids=("7", "2")) == ("7", "2")
    assert ids(episodes=2) == ("1", "2")
    sample = ids(sample=8, seed=5)
    assert sample == ids(sample=8, seed=5)
    assert sample != ids(sample=8, seed=6)
    assert len(set(sample)) == 8
    assert list(sample) == sorted(sample, key=int)
    assert len(ids(scene="AAAAAAAAAAA")) == 40


def test_episodes_whose_scene_is_not_here_are_left_out_and_told(tmp_path: Path) -> None:
    made_up.write_ovon(tmp_path / "data")
    scenes = tmp_path / "scenes"
    there = scenes / "hm3d/val/00800-BBBBBBBBBBB/BBBBBBBBBBB.basis.glb"
    there.parent.mkdir(parents=True)
    there.touch()
    episodes = datasets.load("hm3d-ovon", tmp_path / "data", available_in=scenes)
    assert episodes.ids == ("BBBBBBBBBBB-0", "BBBBBBBBBBB-1")
    assert "1 scenes are not in" in episodes.notes[-1]
    assert scene_path("hm3d-ovon", scenes, episodes[0].scene) == there
    with pytest.raises(PrerequisiteError, match=r"licence.*hm3d_val_v0.2"):
        scene_path("hm3d-ovon", scenes, "hm3d/val/x/x.basis.glb")


@pytest.mark.parametrize(
    ("suite", "expected"),
    [("r2r-ce", "1839"), ("rxr-ce", "2433"), ("hm3d-ovon", "3000"), ("gn-bench", "1000")],
)
def test_the_papers_subset_states_a_mismatch(suite: str, expected: str, tmp_path: Path) -> None:
    if suite == "gn-bench":
        pytest.importorskip("pyarrow")
        made_up.write_gn(tmp_path / "InteriorGS_test_unseen.parquet", [made_up.gn_row(1)])
    else:
        {"r2r-ce": made_up.write_r2r, "rxr-ce": made_up.write_rxr, "hm3d-ovon": made_up.write_ovon}[suite](tmp_path)
    episodes = datasets.load(suite, tmp_path, split="paper")
    assert f"MISMATCH: {len(episodes)} episodes, the paper has {expected}" in episodes.notes[-1]
    if suite == "rxr-ce":
        assert episodes.ids == ("1", "2")


def test_the_papers_subset_confirms_its_number(tmp_path: Path) -> None:
    made_up.write_r2r(tmp_path, count=1839, gt=False)
    assert "1839 episodes, as in the paper" in datasets.load("r2r-ce", tmp_path, split="paper").notes[-1]


def test_the_authors_list_of_ids_is_the_papers_subset_of_gn_bench(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    made_up.write_gn(tmp_path / "InteriorGS_test_unseen.parquet", [made_up.gn_row(n) for n in range(1001)])
    listed = [f"0001_000000_{n}" for n in range(1000)]
    episodes = datasets.load("gn-bench", tmp_path, split="paper", ids=listed)
    assert len(episodes) == 1000
    assert "1000 episodes, as in the paper" in episodes.notes[-1]
    assert datasets.Filters(ids=tuple(listed)).words.startswith("ids=1000 of sha256 ")


@pytest.mark.parametrize(
    ("name", "filters"),
    [
        ("r2r-cd", {}),
        ("r2r-ce", {"split": "val_umseen"}),
        ("r2r-ce", {"language": "en-US"}),
        ("r2r-ce", {"role": "guide"}),
        ("r2r-ce", {"seeds": (0, 3)}),
        ("r2r-ce", {"colour": "red"}),
        ("r2r-ce", {"ids": "99"}),
        ("r2r-ce", {"scene": "nowhere"}),
        ("r2r-ce", {"slice": "9-12"}),
        ("r2r-ce", {"slice": "3:3"}),
        ("r2r-ce", {"sample": 4}),
        ("r2r-ce", {"sample": 0}),
        ("r2r-ce", {"episodes": 0}),
        ("rxr-ce", {"language": "de-DE"}),
        ("houses-vln", {"split": "val_unseen"}),
        ("houses-vln", {"available_in": "."}),
    ],
)
def test_wrong_names_and_filters_are_one_sentence(name: str, filters: dict[str, object], tmp_path: Path) -> None:
    made_up.write_r2r(tmp_path)
    made_up.write_rxr(tmp_path)
    with pytest.raises(UsageError) as caught:
        datasets.load(name, None if name == "houses-vln" else tmp_path, **filters)
    assert "\n" not in str(caught.value)


def test_missing_data_is_a_prerequisite(tmp_path: Path) -> None:
    for path in (None, tmp_path):
        for suite in datasets.BENCHMARKS:
            with pytest.raises(PrerequisiteError, match=r"benchmarks\.md"):
                datasets.load(suite, path)


COORDINATES = st.tuples(*[st.floats(-1000, 1000)] * 3)


@given(st.lists(COORDINATES, min_size=1, max_size=5))
def test_the_frame_change_is_a_rotation_and_its_inverse(points: list[tuple[float, float, float]]) -> None:
    ours = points_from_habitat(points)
    assert points_to_habitat(ours) == pytest.approx(np.array(points))
    assert np.linalg.norm(ours, axis=1) == pytest.approx(np.linalg.norm(np.array(points), axis=1))


@given(COORDINATES, st.floats(-math.pi + 1e-6, math.pi))
def test_poses_go_there_and_back(position: tuple[float, float, float], yaw: float) -> None:
    pose = Pose(*position, yaw)
    there, rotation = pose_to_habitat(pose)
    back = pose_from_habitat(there, tuple(rotation))
    assert back.position_m == pytest.approx(pose.position_m)
    assert math.cos(back.yaw_rad - yaw) == pytest.approx(1.0)


def test_heading_and_forward_agree_with_habitat() -> None:
    """Worked example 22: yaw 60 degrees looks along Habitat's (-sin 60, 0, -cos 60); identity along (0, 0, -1)."""
    pose = pose_from_habitat([0, 0, 0], (0.0, 0.5, 0.0, math.sqrt(0.75)))
    assert math.degrees(pose.yaw_rad) == pytest.approx(60)
    ahead = pose.compose(Pose(1.0, 0.0)).position_m
    assert points_to_habitat(ahead)[0] == pytest.approx([-math.sin(math.radians(60)), 0, -math.cos(math.radians(60))])
    assert points_to_habitat([[1.0, 0, 0]])[0] == pytest.approx([0, 0, -1])
    negated = pose_from_habitat([0, 0, 0], (0.0, -0.5, 0.0, -math.sqrt(0.75)))
    assert math.cos(negated.yaw_rad - pose.yaw_rad) == pytest.approx(1.0)  # q and -q are one rotation


@pytest.mark.skipif(R2R_FOLDER is None, reason="SPACEVLN_R2R_CE names no folder with R2R-CE's val_seen.json.gz (licensed data)")
def test_the_real_val_seen_loads() -> None:
    episodes = datasets.load("r2r-ce", R2R_FOLDER, split="val_seen")
    assert len(episodes) == 778
    assert len(set(episodes.scenes)) == 53
    everything = list(episodes)
    assert len({episode.tags["trajectory"] for episode in everything}) == 259
    turns = np.array([episode.start.yaw_rad for episode in everything]) / math.radians(30)
    assert np.abs(turns - np.round(turns)).max() < 1e-6
    lengths = [episode.annotations.geodesic_m for episode in everything if episode.annotations]
    assert np.mean(lengths) == pytest.approx(9.58, abs=0.005)
    assert max(lengths) == pytest.approx(17.9, abs=0.05)
    nodes = [len(episode.annotations.nodes) for episode in everything if episode.annotations]
    assert np.mean(nodes) == pytest.approx(6.1, abs=0.05)
    words = [len(episode.instruction.split()) for episode in everything if episode.instruction]
    assert np.mean(words) == pytest.approx(27.0, abs=1.5)  # the statistics count punctuation apart
    assert all(episode.annotations.reference_path is not None for episode in everything if episode.annotations)
    assert not any("unknown" in note for note in episodes.notes)
