"""What a room probably is and whether it holds the object: general knowledge of homes joined with what is seen of this one."""

from __future__ import annotations

import math

from spacevln.language import LEADS_ON, ROOM_SHARES, SINGLE_ROOMS, chance_in_room
from spacevln.reasoning.rules.grid import NOWHERE
from spacevln.reasoning.rules.world import World

EVIDENCE = 0.7  # log odds for each unit of a region type's score
MOST_EVIDENCE = 7.0
SECOND_OF_A_KIND = 0.2  # share of homes with two kitchens, etc.
SURE = 2.5  # score from which a room's type counts as known
SEEN_WHOLE_M2 = 14.0
LEAST_UNSEEN = 0.2
LEADS_WEIGHT = 0.45
ROOMS_ON_A_STOREY = 5


class Beliefs:
    """Probabilities for one object in one home; for no object at all, every room is as good.

    Args:
        world: the perceived home.
        goal: the object; ``""`` for none.
    """

    def __init__(self, world: World, goal: str) -> None:
        self._world = world
        self._chance = {region: chance_in_room(goal, region) if goal else 0.5 for region in ROOM_SHARES}
        self._taken: dict[str, set[int]] = {region: set() for region in SINGLE_ROOMS}
        for floor, room in sorted(world.visited_rooms):
            region = world.region(floor, room) if room else ""
            if region in self._taken and world.scores(floor, room)[region] >= SURE:
                self._taken[region].add(room)

    def types(self, room: int) -> dict[str, float]:
        """Probability of each type of a room of the current storey; of an unseen one for 0."""
        scores = self._world.scores(self._world.floor, room) if room else {}
        weights = {}
        for region, share in ROOM_SHARES.items():
            taken = SECOND_OF_A_KIND if self._taken.get(region, set()) - {room} else 1.0
            weights[region] = share * taken * math.exp(EVIDENCE * min(scores.get(region, 0.0), MOST_EVIDENCE))
        total = sum(weights.values())
        return {region: weight / total for region, weight in weights.items()}

    def holds(self, room: int) -> float:
        """Chance that a room holds the object, whatever was seen of it."""
        return sum(p * self._chance[region] for region, p in self.types(room).items())

    def unseen(self, room: int) -> float:
        """Share of a room that no look-around has shown, by its known floor."""
        if room == NOWHERE:
            return 1.0
        return max(LEAST_UNSEEN, 1.0 - self._world.grids[self._world.floor].area_m2(room) / SEEN_WHOLE_M2)

    def leads_on(self, room: int) -> float:
        """What the rooms behind a room that was not entered are worth."""
        share = sum(p * LEADS_ON.get(region, 0.0) for region, p in self.types(room).items())
        return LEADS_WEIGHT * share * math.sqrt(self.holds(NOWHERE))

    def on_another_storey(self) -> float:
        """Chance that a storey that was never entered holds the object."""
        return 1.0 - (1.0 - self.holds(NOWHERE)) ** ROOMS_ON_A_STOREY
