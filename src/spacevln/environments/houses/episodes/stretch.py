"""One leg of a route with what its description needs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spacevln.environments.houses.episodes.clauses import Clause, Thing
from spacevln.environments.houses.episodes.nouns import is_landmark, salience, thing_for
from spacevln.environments.houses.episodes.routes import Route
from spacevln.environments.houses.episodes.topology import Leg, Node, Passed, Topology
from spacevln.environments.houses.plan import Item, Room

CLEAR_TURN_RAD = math.radians(48)
CLEAR_PASS_M = 1.7


@dataclass(frozen=True)
class Stretch:
    """One leg of a route with what its description needs."""

    topology: Topology
    route: Route
    index: int
    rng: np.random.Generator
    detail: float

    @property
    def node(self) -> Node:
        """Where the leg begins."""
        return self.route.nodes[self.index]

    @property
    def leg(self) -> Leg:
        """The leg."""
        return self.route.legs[self.index]

    @property
    def room(self) -> Room:
        """Its room."""
        return self.topology.house.rooms[self.node.room]

    @property
    def next_room(self) -> Room | None:
        """The room behind its portal."""
        return None if self.leg.portal is None else self.topology.house.rooms[self.leg.portal.other(self.room.id)]

    def chance(self, p: float) -> bool:
        """A coin; details make it likelier."""
        return bool(self.rng.random() < min(1.0, p * self.detail))

    def pick(self, options: list[tuple[float, Callable[[], Clause]]]) -> Clause:
        """One of some weighted clauses."""
        weights = np.array([w for w, _ in options])
        return options[int(self.rng.choice(len(options), p=weights / weights.sum()))][1]()

    def landmarks(self) -> list[tuple[Passed, Item]]:
        """Items that are clearly passed: near, seen, neither at the very start nor the end."""
        z_m = self.topology.house.floors[self.room.floor].z_m
        out = []
        for passed in self.leg.passed:
            item = self.topology.item[passed.item]
            if (
                passed.seen
                and passed.inner
                and passed.distance_m < CLEAR_PASS_M
                and item.room == self.room.id
                and is_landmark(item, z_m)
            ):
                out.append((passed, item))
        return out

    def thing(self, item: Item) -> Thing:
        """A noun phrase for an item: mostly the bare noun."""
        rare = min(0.8, 0.1 * self.detail * self.detail)
        count = 0 if self.rng.random() > rare else (1 if self.rng.random() < 0.8 else 2)
        same = sum(o.category == item.category and o.room == item.room for o in self.topology.house.items)
        return thing_for(item, self.rng, count, crowded=same > 2)

    def salient(self, items: list[Item]) -> Item:
        """One of some items, the more striking the likelier."""
        weights = np.array([salience(item) for item in items])
        return items[int(self.rng.choice(len(items), p=weights / weights.sum()))]
