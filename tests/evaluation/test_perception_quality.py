"""Judging detectors against labels: errors that are put in come out as the numbers say."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from spacevln.core import Camera, Detection, Environment, Observation
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.evaluation.houses import fresh_episodes
from spacevln.evaluation.perception_quality import box_iou, judge_walk, mask_iou, matched
from spacevln.evaluation.perception_report import panels, report_of
from spacevln.evaluation.perception_success import Level, levels_of, success_panels, successes
from spacevln.evaluation.perception_walks import Walk
from spacevln.perception import LabelDetector
from spacevln.viewer.curves import draw_curves

CAMERA = Camera(160, 120, 79.0, 0.88)


def found(category: str, box: tuple[int, int, int, int], confidence: float = 0.9) -> Detection:
    x0, y0, x1, y1 = box
    return Detection(category, box, confidence, np.ones((y1 - y0, x1 - x0), np.bool_))


def test_an_instance_is_found_once_by_the_surest_detection_that_names_and_covers_it() -> None:
    truth = [found("dining table", (0, 0, 40, 40)), found("sofa", (50, 0, 90, 40))]
    detections = [
        found("table", (2, 0, 40, 40), 0.6),
        found("table", (0, 0, 40, 38), 0.8),  # a second box of the same thing
        found("armchair", (50, 0, 90, 40)),  # another name
        found("couch", (50, 0, 68, 40)),  # covers less than half
    ]
    assert matched(truth, detections) == [(0, 1)]
    assert matched(truth, [found("couch", (50, 0, 90, 30))]) == [(1, 0)]


def test_overlaps() -> None:
    assert box_iou((0, 0, 10, 10), (5, 0, 15, 10)) == pytest.approx(1 / 3)
    assert box_iou((0, 0, 10, 10), (20, 0, 30, 10)) == 0.0
    half = found("sofa", (0, 0, 10, 10))
    assert half.mask is not None
    half.mask[:, 5:] = False
    assert mask_iou(half, found("sofa", (0, 0, 10, 10))) == pytest.approx(0.5)
    assert mask_iou(half, Detection("sofa", (0, 0, 10, 10), 0.5)) is None


class Short(Walk):
    """Only the first look-around and a few steps."""

    def images(self, environment: Environment) -> Iterator[Observation]:
        yield from islice(super().images(environment), 24)


class Renaming:
    """Calls every sofa and chair of the labels a lamp, and everything else as it is."""

    def detect(self, observations: Sequence[Observation], queries: Sequence[str]) -> list[tuple[Detection, ...]]:
        return [
            tuple(
                Detection("lamp", each.box_px, each.confidence, each.mask) if "chair" in each.category else each
                for each in detections
            )
            for detections in LabelDetector().detect(observations, queries)
        ]


def test_what_is_put_in_comes_out() -> None:
    environment = HousesEnvironment(CAMERA, renderer="raycast")
    (episode,) = fresh_episodes("houses-objectnav", [3])
    walk = Short.of(episode)
    assert {"doorway", "bed"} <= set(walk.vocabulary)
    perfect = judge_walk(walk, environment, LabelDetector())
    assert (perfect.whole.precision, perfect.whole.recall) == (1.0, 1.0)
    assert max(perfect.whole.errors_m) == 0.0
    assert (perfect.arrivals[1].accuracy, perfect.arrivals[3].precision) == (1.0, 1.0)
    assert sum(each.instances for each in perfect.by_distance) <= perfect.whole.instances

    worse = judge_walk(walk, environment, LabelDetector(miss_rate=0.3, jitter_px=4))
    assert worse.whole.recall == pytest.approx(0.7, abs=0.1)
    assert worse.whole.errors_m
    assert np.median(worse.whole.errors_m) > 0

    renamed = judge_walk(walk, environment, Renaming())
    assert renamed.whole.precision < 1
    assert renamed.whole.detections - renamed.whole.right == renamed.whole.instances - renamed.whole.found > 0

    report = report_of([perfect, worse], {"name": "both"})
    assert perfect.whole.recall > (report.recall.value or 0) > worse.whole.recall
    assert (report.recall.low or 0) <= (report.recall.value or 0) <= (report.recall.high or 0)
    assert math.isclose(
        sum(each.instances for each in report.by_distance),
        sum(tally.instances for walked in (perfect, worse) for tally in walked.by_distance),
    )
    drawn = draw_curves(panels(report))
    assert drawn.count("<polyline") == 6
    assert "Whether one has arrived" in drawn
    environment.close()


def test_confusions_make_false_arrivals_and_more_pictures_remove_them() -> None:
    environment = HousesEnvironment(CAMERA, renderer="raycast")
    (episode,) = fresh_episodes("houses-objectnav", [700])
    judged = judge_walk(Short.of(episode), environment, LabelDetector(confusion_rate=0.3))
    environment.close()
    once, thrice = judged.arrivals[1], judged.arrivals[3]
    assert once.false > 0
    assert thrice.precision > once.precision
    assert thrice.recall < 1


def test_levels_have_folders_of_their_own_and_both_errors_are_tried_alone() -> None:
    levels = levels_of((0.5,), (0.1, 0.2), (1, 3))
    assert [level.folder for level in levels if level.arrival_sightings == 1] == [
        "none", "confusions-0.1", "confusions-0.2", "misses-0.5",
    ]  # fmt: skip
    assert Level(0.0, 0.2, 3).folder == "confusions-0.2-sightings-3"
    assert len({level.folder for level in levels}) == 8


def test_the_command_judges_and_draws(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from spacevln.cli.app import cli

    monkeypatch.chdir(tmp_path)
    command = ["bench-perception", "houses", "--seeds", "700:701", "--renderer", "raycast", "--miss-rate", "0.2"]
    result = CliRunner().invoke(cli, [*command, "--out", "judged"], standalone_mode=False)
    assert result.return_value == 0, result.output
    assert "precision 100.0 %" in result.output
    assert "arrival by 3 pictures" in result.output
    assert (tmp_path / "judged" / "perception.json").exists()
    assert (tmp_path / "judged" / "perception.svg").read_text().startswith("<svg")


@pytest.mark.slow
def test_the_agent_s_success_is_measured_for_every_level_and_resumes(tmp_path: Path) -> None:
    from spacevln.cli.app import cli

    command = ["bench-perception", "success", "houses-objectnav", "--seeds", "3:4", "--renderer", "raycast", "--misses", "1"]
    command += ["--confusions", "0.2", "--arrival-sightings", "1", "--arrival-sightings", "3", "--out", str(tmp_path)]
    first = CliRunner().invoke(cli, command, standalone_mode=False)
    assert first.return_value == 0, first.output
    assert "misses-1                     SR   0.0 %" in first.output
    assert "against one picture" in first.output
    again = CliRunner().invoke(cli, command, standalone_mode=False)
    assert again.output == first.output
    assert (tmp_path / "success.svg").read_text().count("<polyline") == 4
    assert successes({}) == {}
    assert len(success_panels({})) == 2
