"""Making a house: geometry and compilation, then one route episode with its fields (goals: 0.5 s and 1 s)."""

from __future__ import annotations

from itertools import count

import pytest

from spacevln.environments.houses.episodes import Grounds, first_route_episode
from spacevln.environments.houses.furniture import furnish
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.layout import generate_layout
from spacevln.environments.houses.scene import compile_scene


@pytest.mark.benchmark(group="house")
def test_geometry_and_compilation(benchmark):
    compile_scene(furnish(generate_layout(0)))
    seeds = count(20)
    scene = benchmark.pedantic(lambda: compile_scene(furnish(generate_layout(next(seeds)))), rounds=20)
    assert scene.model.ngeom > 100


@pytest.mark.benchmark(group="house")
def test_fields_and_a_route_episode(benchmark):
    first_route_episode(build_house(0))
    seeds = count(20)

    def setup():
        return (build_house(next(seeds)),), {}

    episode = benchmark.pedantic(lambda house: (Grounds(house).geodesics, first_route_episode(house))[1], setup=setup, rounds=10)
    assert episode.geodesic_m > 3
