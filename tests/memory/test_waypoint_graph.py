import math

import numpy as np
import pytest
from drawn_house import house
from drawn_map import DrawnMap
from hypothesis import given, settings
from hypothesis import strategies as st

from spacevln.core import Pose, SpatialWaypoint
from spacevln.memory.graph import REACH_M, EdgeKind, WaypointGraph, nearest_on_path

MAP = house()
INSIDE = [(x, y) for x in np.arange(0.3, 15, 0.35) for y in np.arange(-0.7, 7, 0.35) if MAP.is_passable(x, y)]


def waypoint(index: int, x: float, y: float, floor: int = 0) -> SpatialWaypoint:
    return SpatialWaypoint(index, Pose(float(x), float(y)), floor, "", (), "")


def graph_of(points: list[tuple[float, float]], metric_map: DrawnMap = MAP) -> WaypointGraph:
    graph, waypoints = WaypointGraph(), []
    for index, (x, y) in enumerate(points):
        new = waypoint(index, x, y)
        graph.connect_map(new, waypoints, metric_map)
        waypoints.append(new)
    return graph


@settings(max_examples=25, deadline=None)
@given(st.lists(st.sampled_from(INSIDE), min_size=2, max_size=10))
def test_edges_are_symmetric_local_and_never_shorter_than_straight(points: list[tuple[float, float]]) -> None:
    graph = graph_of(points)
    for edge in graph.edges:
        assert edge.a < edge.b
        assert edge.length_m >= math.dist(points[edge.a], points[edge.b]) - 1e-9
        assert edge.length_m <= REACH_M
        assert graph.neighbours(edge.a)[edge.b] == graph.neighbours(edge.b)[edge.a] == edge.length_m


@settings(max_examples=25, deadline=None)
@given(st.lists(st.sampled_from(INSIDE), min_size=2, max_size=10, unique=True))
def test_a_way_over_edges_is_never_shorter_than_the_geodesic(points: list[tuple[float, float]]) -> None:
    distance, previous = graph_of(points).shortest({0: 0.0})
    for index, way in distance.items():
        assert way >= MAP.geodesic_m(points[0], points[index]) - 0.15
        while index in previous:
            index = previous[index]
        assert index == 0


def test_no_edge_through_a_wall_or_past_a_third_waypoint() -> None:
    graph = graph_of([(5.0, 2.1), (7.0, 2.1), (9.0, 2.1)])
    assert [(edge.a, edge.b) for edge in graph.edges] == [(0, 1), (1, 2)]
    wall = graph_of([(2.0, 3.6), (5.5, 3.6)])  # 3.5 m apart, but round by two doorways
    assert wall.edges == ()


def test_a_later_waypoint_splits_the_edge_it_stands_on() -> None:
    graph = graph_of([(5.0, 2.1), (9.0, 2.1), (7.0, 2.1)])
    assert [(edge.a, edge.b) for edge in graph.edges] == [(0, 2), (1, 2)]
    distance, previous = graph.shortest({0: 0.0})
    assert previous == {2: 0, 1: 2}
    assert distance[1] == pytest.approx(4.0, abs=0.1)


def test_chain_edges_join_floors_and_keep_the_shorter_way() -> None:
    graph = WaypointGraph()
    way = np.array([[0.0, 0.0], [3.0, 4.0]])
    down, up = waypoint(0, 0, 0), waypoint(1, 3, 4, floor=1)
    graph.connect_chain(down, up, way, 9.0)
    graph.connect_chain(up, down, way, 8.0)
    graph.connect_chain(up, down, way, 1.0)
    (edge,) = graph.edges
    assert edge.kind is EdgeKind.CHAIN
    assert edge.floor_transition
    assert edge.length_m == 5.0


def test_a_waypoint_behind_a_wall_does_not_split_an_edge() -> None:
    graph = graph_of([(5.2, 2.5), (6.3, 2.5), (5.75, 3.0)])  # two in the hallway, one in the kitchen
    assert (0, 1) in [(edge.a, edge.b) for edge in graph.edges]


def test_nearest_points_of_a_polyline() -> None:
    path = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]])
    nearest = nearest_on_path(path, np.array([[2.0, 1.0], [5.0, 2.0], [-3.0, 4.0]]))
    assert nearest.tolist() == [[2.0, 0.0], [4.0, 2.0], [0.0, 0.0]]
    assert nearest_on_path(path[:1], np.array([[3.0, 4.0]])).tolist() == [[0.0, 0.0]]
