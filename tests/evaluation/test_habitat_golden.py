"""The metrics agree with habitat-lab's own on walks of the real Habitat-Sim (data/README.md)."""

from __future__ import annotations

import gzip
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from spacevln.core import Action, Pose, Stop
from spacevln.environments.bridge.frame import points_from_habitat
from spacevln.evaluation.judging import Verdict, judge
from spacevln.evaluation.truth import Annotations, MeasuredTruth, Points

GOLDEN: dict[str, Any] = json.loads(gzip.decompress((Path(__file__).parent / "data/habitat_golden.json.gz").read_bytes()))
TRACES: dict[str, dict[str, Any]] = GOLDEN["traces"]
ROUTES = [name for name, trace in TRACES.items() if trace["dataset"] == "r2r"]
OBJECTS = [name for name, trace in TRACES.items() if trace["dataset"] != "r2r"]
CLOSE = 1e-4


class Recorded:
    """Geodesics as the simulator measured them, by position."""

    def __init__(self, trace: dict[str, Any]) -> None:
        positions = points_from_habitat(trace["positions"])
        self._known = {tuple(p): d for p, d in zip(positions.tolist(), trace["distances"], strict=True)}

    def distances_m(self, positions: Points, targets: Points) -> Points:
        del targets
        return np.array([self._known[tuple(position)] for position in positions.tolist()])

    def path(self, start: Points, targets: Points) -> Points:
        return np.vstack([start, targets[:1]])

    def follow(self, pose: Pose, targets: Points) -> Action:
        del pose, targets
        return Stop()


def verdict(name: str) -> Verdict:
    trace = TRACES[name]
    positions = points_from_habitat(trace["positions"])
    route = trace["dataset"] == "r2r"
    annotations = Annotations(
        targets=positions[-1:],
        radius_m=3.0 if route else 0.25,
        reference_path=points_from_habitat(GOLDEN["reference_paths"][trace["episode"]]) if route else None,
        objects=None if route else positions[-1:],
    )
    truth = MeasuredTruth(annotations, Recorded(trace), Pose(*positions[0]))
    return judge(truth, positions, stopped=trace["stopped"])


def test_the_walks_are_all_there() -> None:
    assert (len(ROUTES), len(OBJECTS)) == (37, 8)


@pytest.mark.parametrize("name", ROUTES)
def test_routes_agree_with_habitat_lab(name: str) -> None:
    found, lab, own = verdict(name), TRACES[name]["lab"], TRACES[name]["metrics"]
    assert lab["success"] == found.SR
    assert pytest.approx(lab["distance_to_goal"], abs=CLOSE) == found.NE
    assert pytest.approx(lab["spl"], abs=CLOSE) == found.SPL
    assert found.SoftSPL == pytest.approx(lab["soft_spl"], abs=CLOSE)
    assert own["oracle_success"] == found.OSR
    assert found.oracle_NE == pytest.approx(own["oracle_navigation_error"], abs=CLOSE)
    assert found.nDTW == pytest.approx(own["ndtw"], abs=CLOSE)
    assert pytest.approx(own["sdtw"], abs=CLOSE) == found.SDTW
    assert found.start_m == pytest.approx(own["start_distance"], abs=CLOSE)
    assert found.SR_viewpoint is None


@pytest.mark.parametrize("name", OBJECTS)
def test_object_goals_agree_with_the_simulator(name: str) -> None:
    found, own = verdict(name), TRACES[name]["metrics"]
    assert found.SR == found.SR_viewpoint == own["success"]
    assert found.SR_viewpoint_1m == own["success_at_1_0"]
    assert pytest.approx(own["spl"], abs=CLOSE) == found.SPL
    assert found.SoftSPL == pytest.approx(own["soft_spl"], abs=CLOSE)
    assert found.nDTW is None
    assert own["oracle_success"] == found.OSR


def test_a_time_out_inside_the_radius_is_a_success_only_without_stop() -> None:
    found = verdict("d04/r010/slide")
    assert (found.SR, found.SPL, found.OSR) == (0.0, 0.0, 1.0)
    assert found.NE < 3.0
    assert found.SR_no_stop == 1.0
    assert found.SPL_no_stop > 0.0


def test_stop_as_the_last_allowed_action_counts() -> None:
    assert verdict("d13/r010/slide").SR == 1.0
