"""Stored suites: the same bytes every time, read by the benchmarks' loaders, judged in the house."""

from __future__ import annotations

import gzip
import hashlib
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spacevln.evaluation import datasets
from spacevln.evaluation.datasets.r2r_ce import load_r2r_ce
from spacevln.evaluation.houses import TEST_SEEDS_FROM
from spacevln.evaluation.stored import copy_suite, stored_suite
from spacevln.evaluation.suites import PLANS, Plan, write_suite

SMALL = Plan(first_seed=7, houses=2, per_house=1)
STORED = [(suite, split) for suite in ("houses-vln", "houses-objectnav") for split in ("test", "dev")]


def text_of(file: Path) -> bytes:
    return gzip.decompress(file.read_bytes())


def digests(file: Path) -> dict[str, str]:
    """What the .sha256 files beside a suite's file say."""
    stem = file.name.partition(".")[0]
    return {path.name: path.read_text() for path in file.parent.glob(f"{stem}*.sha256")}


def coordinates(data: Any) -> Iterator[float]:
    """Every number of a file that is no rotation."""
    if isinstance(data, dict):
        for key, value in data.items():
            if "rotation" not in key:
                yield from coordinates(value)
    elif isinstance(data, list):
        for value in data:
            yield from coordinates(value)
    elif isinstance(data, float):
        yield data


def test_suites_have_houses_of_their_own() -> None:
    seeds = {split: range(plan.first_seed, plan.first_seed + 2 * plan.houses) for split, plan in PLANS.items()}
    assert PLANS["test"].houses * PLANS["test"].per_house == 200
    assert PLANS["dev"].houses * PLANS["dev"].per_house == 50
    assert min(seeds["test"]) >= TEST_SEEDS_FROM > max(seeds["dev"])
    for other in (range(1000), range(100_000, 100_100)):  # development, and the fresh test seeds
        assert not any(set(own) & set(other) for own in seeds.values())


@pytest.mark.parametrize("suite", ["houses-vln", "houses-objectnav"])
def test_a_suite_is_written_again_to_the_byte_and_read_back(suite: str, tmp_path: Path) -> None:
    file = write_suite(suite, "dev", tmp_path / "a", SMALL)
    again = write_suite(suite, "dev", tmp_path / "b", SMALL)
    assert sorted(path.name for path in (tmp_path / "a").iterdir()) == sorted(path.name for path in (tmp_path / "b").iterdir())
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()
    digest = hashlib.sha256(gzip.decompress(again.read_bytes())).hexdigest()
    assert again.with_name(again.name + ".sha256").read_text().strip() == digest

    episodes = datasets.load(suite, file, split="dev")
    assert len(episodes) == 2
    assert episodes.notes == ()
    first = episodes[0]
    assert first.scene == "house-000007"
    assert first.tags["split"] == "dev"
    assert first.truth is not None
    assert first.annotations is not None
    start_m = float(first.truth.distances_m(first.start.position_m[None])[0])
    assert start_m == pytest.approx(first.annotations.geodesic_m, abs=0.06)
    assert not first.truth.reached(first.start.position_m)
    if suite == "houses-vln":
        assert first.instruction
        assert first.truth.reached(first.annotations.targets[0])
        plain = load_r2r_ce(file, "dev")  # any reader of R2R-CE sees the same
        assert plain[0].instruction == first.instruction
        reference = first.annotations.reference_path
        assert reference is not None
        assert np.linalg.norm(np.diff(reference, axis=0), axis=1).max() <= 0.252
    else:
        assert first.goal
        assert all(first.truth.reached(point) for point in first.annotations.targets[:5])
        assert first.truth.viewpoint_m(first.annotations.targets[0]) == pytest.approx(0.0, abs=0.08)


@pytest.mark.parametrize(("suite", "split"), STORED)
def test_stored_suites_are_whole(suite: str, split: str, tmp_path: Path) -> None:
    copy = copy_suite(suite, split, tmp_path)
    said = digests(copy)
    assert len(said) == (2 if suite == "houses-vln" else 1)
    for name, digest in said.items():
        assert hashlib.sha256(text_of(tmp_path / name.removesuffix(".sha256"))).hexdigest() == digest.strip()
    assert all(round(number, 3) == number for number in coordinates(json.loads(text_of(copy))))
    plan = PLANS[split]
    stored = datasets.load(suite, split=split)
    assert stored.ids == datasets.load(suite, copy, split=split).ids
    assert len(set(stored.ids)) == plan.houses * plan.per_house
    assert len(set(stored.scenes)) == plan.houses
    assert stored.notes == ()
    assert stored.source is not None
    assert dict(stored.source.files)[copy.name] == hashlib.sha256(stored_suite(suite, split).read_bytes()).hexdigest()
    assert {"length_bin", "floors", "anchors", "places", "ambiguity_m"} <= set(stored[0].tags)
    assert datasets.Selection(suite=suite, split=split).name == f"{suite} {split} v1"


@pytest.mark.slow
@pytest.mark.timeout(900)
@pytest.mark.parametrize(("suite", "split"), STORED)
def test_stored_suites_are_made_again_to_the_letter(suite: str, split: str, tmp_path: Path) -> None:
    assert digests(write_suite(suite, split, tmp_path)) == digests(stored_suite(suite, split))
