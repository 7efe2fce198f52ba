"""Ways that lead over stairs."""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable

from numpy.typing import ArrayLike

from spacevln.mapping.floors import Floor, FloorTracker
from spacevln.mapping.geodesics import GeodesicField

Place = tuple[ArrayLike, int]


def across_floors_m(tracker: FloorTracker, field: Callable[[Floor, ArrayLike], GeodesicField], a: Place, b: Place) -> float:
    """Shortest known way between two places (xy, floor) over the walked stairs [m]; inf when there is none."""
    if a[1] not in tracker.floors or b[1] not in tracker.floors:
        return math.inf
    # Nodes: 0 is a, 1 is b, then the two ends of every connector.
    places: list[Place] = [a, b]
    hops: dict[int, tuple[int, float]] = {}
    for connector in tracker.connectors:
        first = len(places)
        places += [(connector.start.xy_m, connector.from_floor), (connector.end.xy_m, connector.to_floor)]
        hops[first], hops[first + 1] = (first + 1, connector.length_m), (first, connector.length_m)
    best = {0: 0.0}
    queue = [(0.0, 0)]
    while queue:
        length_m, node = heapq.heappop(queue)
        if node == 1:
            return length_m
        if length_m > best[node]:
            continue
        ways = field(tracker.floors[places[node][1]], places[node][0])
        steps = [
            (other, float(ways.at(place[0])[0]))
            for other, place in enumerate(places)
            if place[1] == places[node][1] and other != node
        ]
        for other, step_m in [*steps, *([hops[node]] if node in hops else [])]:
            if length_m + step_m < best.get(other, math.inf):
                best[other] = length_m + step_m
                heapq.heappush(queue, (best[other], other))
    return math.inf
