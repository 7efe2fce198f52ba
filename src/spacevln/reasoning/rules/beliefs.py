"""What a room probably is and whether it holds the object: general knowledge of homes joined with what is seen of this one."""

from __future__ import annotations

import math

from spacevln.language import FREE_FLOOR_M2, LOWER_STOREY, OPENS_ON, ROOM_SHARES, SINGLE_ROOMS, chance_in_room
from spacevln.reasoning.rules.grid import NOWHERE
from spacevln.reasoning.rules.world import World

EVIDENCE = 1.0  # log odds for each unit of a region type's score
MOST_EVIDENCE = 7.0
SECOND_OF_A_KIND = 0.2  # share of homes with two kitchens, etc.
SURE = 2.5  # score from which a room's type counts as known
LEAST_UNSEEN = 0.3  # a view through a door leaves corners
LEAST_SHARE = 0.1  # of the usual share, of a type that a room does not usually open on
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
        leads = world.leads_from(world.floor)
        self._lower = None if len(leads) != 1 else leads == {"up"}  # a home with more than two storeys tells nothing
        self._taken: dict[str, set[int]] = {region: set() for region in SINGLE_ROOMS}
        for floor, room in sorted(world.visited_rooms):
            region = world.region(floor, room) if room and floor == world.floor else ""
            if region in self._taken and world.scores(floor, room)[region] >= SURE:
                self._taken[region].add(room)

    def types(self, room: int, before: int = NOWHERE) -> dict[str, float]:
        """Probability of each type of a room of the current storey.

        Args:
            room: its number; 0 for one of which nothing is seen.
            before: the room from which it is entered; 0 when unknown.
        """
        weights = {}
        scores = self._scores(room)
        for region, share in self._shares(before).items():
            taken = SECOND_OF_A_KIND if self._taken.get(region, set()) - {room} else 1.0
            weights[region] = share * taken * math.exp(EVIDENCE * min(scores.get(region, 0.0), MOST_EVIDENCE))
        total = sum(weights.values())
        return {region: weight / total for region, weight in weights.items()}

    def _scores(self, room: int) -> dict[str, float]:
        return self._world.scores(self._world.floor, room) if room else {}

    def _shares(self, before: int) -> dict[str, float]:
        """How likely a room behind another one is of each type, before it is seen."""
        region = self._world.region(self._world.floor, before) if before else ""
        opens = OPENS_ON.get(region)
        shares = dict(ROOM_SHARES)
        if opens is not None:
            total = sum(opens.values())
            shares = {name: opens.get(name, 0.0) / total + LEAST_SHARE * share for name, share in ROOM_SHARES.items()}
        return _on_storey(shares, self._lower)

    def holds(self, room: int, before: int = NOWHERE) -> float:
        """Chance that a room holds the object, whatever was seen of it."""
        return sum(p * self._chance[region] for region, p in self.types(room, before).items())

    def unseen(self, room: int) -> float:
        """Share of a room that no look-around has shown, by its known floor and what rooms of its type measure."""
        if room == NOWHERE:
            return 1.0
        whole_m2 = sum(p * FREE_FLOOR_M2[region] for region, p in self.types(room).items())
        return max(LEAST_UNSEEN, 1.0 - self._world.grids[self._world.floor].area_m2(room) / whole_m2)

    def leads_on(self, room: int, before: int = NOWHERE) -> float:
        """Chance that a room which a room opens on holds the object."""
        here = self.types(room, before)
        missed = 1.0
        for region in ROOM_SHARES:
            taken = SECOND_OF_A_KIND if self._taken.get(region) else 1.0
            rooms = sum(p * OPENS_ON[name].get(region, 0.0) for name, p in here.items())
            missed *= (1.0 - min(self._chance[region], 0.95)) ** (rooms * taken)
        return 1.0 - missed

    def on_another_storey(self) -> float:
        """Chance that a storey that was never entered holds the object."""
        shares = _on_storey(dict(ROOM_SHARES), None if self._lower is None else not self._lower)
        in_room = sum(share * self._chance[region] for region, share in shares.items()) / sum(shares.values())
        return 1.0 - (1.0 - in_room) ** ROOMS_ON_A_STOREY


def _on_storey(shares: dict[str, float], lower: bool | None) -> dict[str, float]:
    """Shares of the types of rooms on the lower or upper of two storeys; as they are where that is not known."""
    if lower is None:
        return shares
    return {name: share * (LOWER_STOREY[name] if lower else 1.0 - LOWER_STOREY[name]) for name, share in shares.items()}
