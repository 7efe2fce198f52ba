"""How well one clause fits one leg, and where on it: the space-landmark anchors' Verify, made of small judgements."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from spacevln.core import wrap_angle
from spacevln.language import Clause, ClauseType, NounKind, NounPhrase
from spacevln.perception.matching import fit
from spacevln.reasoning.rules.legs import Leg
from spacevln.reasoning.rules.sightings import Thing
from spacevln.reasoning.rules.thresholds import Thresholds, side_fits
from spacevln.reasoning.rules.world import World

T = ClauseType
WEIGHT = {
    T.TURN: 1.0,
    T.TURN_AROUND: 0.4,
    T.STRAIGHT: 0.3,
    T.LEAVE: 0.8,
    T.ENTER: 1.2,
    T.THROUGH: 0.8,
    T.PAST: 1.0,
    T.TO: 0.8,
    T.TOWARD: 0.8,
    T.ALONG: 0.8,
    T.ACROSS: 0.4,
    T.AROUND: 0.8,
    T.BETWEEN: 1.0,
    T.STAIRS: 1.6,
    T.STOP: 1.4,
    T.ORIENT: 0.5,
    T.NOTICE: 0.2,
}
PASS_M = 2.5
SURELY = 0.3  # agreement of a room with a region type
NEAR_M = 1.5
STRAIGHT_RAD = math.radians(50)
# what an option does with the crossing at the end of a leg; one crossing can leave, go through and enter, each once
LEAVES, THROUGH, ENTERS = 1, 2, 4


@dataclass(frozen=True, slots=True)
class Option:
    """One way in which a clause holds on a leg: arc position, score up to the clause's weight, use of the crossing."""

    s_m: float
    score: float
    crossing: int = 0
    bars: int = 0  # uses of the crossing after which this one is out of order
    turn: int = -1  # index of the bend that it explains


def thing_fits(phrase: NounPhrase, thing: Thing) -> float:
    """1 when a thing is what a phrase names, less when attributes are not known, 0 when it is not."""
    verdict = fit(phrase.phrase, thing.category, thing.attributes)
    return 0.0 if verdict is None or verdict.value < 0.5 else verdict.value


class Matcher:
    """Judges clauses on legs of one world."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.thresholds = Thresholds(world)
        self._options: dict[tuple[int, int], list[Option]] = {}
        self._named: dict[tuple[str, int], list[tuple[Thing, float]]] = {}

    def named(self, phrase: NounPhrase, floor: int) -> list[tuple[Thing, float]]:
        """Seen things of a floor that a phrase fits."""
        key = (phrase.phrase, floor)
        if key not in self._named:
            fits = ((thing, thing_fits(phrase, thing)) for thing in self.world.sightings.things if thing.floor == floor)
            self._named[key] = [(thing, value) for thing, value in fits if value > 0]
        return self._named[key]

    def options(self, clause: Clause, leg: Leg) -> list[Option]:
        """Every way in which the clause holds on the leg; legs and clauses are kept by the world and the search."""
        key = (id(leg), id(clause))
        if key not in self._options:
            options = self._judge(clause, leg)
            if clause.degree == "straight" and any(abs(angle) > STRAIGHT_RAD for _, angle in leg.turns):
                options = [replace(option, score=0.6 * option.score) for option in options if option.score > 0]
            self._options[key] = options
        return self._options[key]

    def _judge(self, clause: Clause, leg: Leg) -> list[Option]:
        match clause.type:
            case T.TURN:
                return [*self._turn(clause, leg), *self._branch(clause, leg)]
            case T.TURN_AROUND:
                return [Option(0.0, WEIGHT[T.TURN_AROUND])] if abs(leg.turns[0][1]) > math.radians(95) else []
            case T.STRAIGHT:
                return [Option(0.0, WEIGHT[T.STRAIGHT])] if abs(leg.turns[0][1]) < math.radians(50) and leg.length_m > 0.8 else []
            case T.PAST | T.AROUND | T.BETWEEN:
                return self._past(clause, leg)
            case T.TO | T.TOWARD:
                return [*self._toward(clause, leg), *self._cross(clause, leg)]
            case T.ALONG | T.ACROSS:
                return [*self._along(clause, leg), *self._past(clause, leg, 0.7)]
            case T.LEAVE | T.ENTER | T.STAIRS:
                return self._cross(clause, leg)
            case T.THROUGH:
                return [*self._cross(clause, leg), *self._along(clause, leg)]
            case T.ORIENT | T.NOTICE:
                return self._sees(clause, leg)
            case T.STOP:
                return []
        return []

    def _branch(self, clause: Clause, leg: Leg) -> list[Option]:
        """A "second left" to take is a way out of the space, counted on its side."""
        if not clause.ordinal or leg.kind != "cross" or leg.portal is None:
            return []
        side, number = self.thresholds.ordinal(leg, leg.portal)
        if (side and side != clause.side) or (not side and not self.thresholds.lies(leg, leg.portal, clause.side)):
            return []
        agree = 1.3 if number == clause.ordinal else 0.7 if number == 0 and clause.ordinal in (1, -1) else 0.2
        return [Option(leg.length_m, WEIGHT[T.TURN] * agree, THROUGH)]

    def _turn(self, clause: Clause, leg: Leg) -> list[Option]:
        found = []
        for index, (s, angle) in enumerate(leg.turns):
            agree = side_fits(clause.side, angle)
            if agree <= 0:
                continue
            score = WEIGHT[T.TURN] * agree
            if clause.place is not None:
                beside = self._beside(clause.place, leg, s)
                score *= 1.0 if beside else 0.45
            score *= 0.2 if clause.ordinal else 1.0
            found.append(Option(s, score, turn=index))
        return found

    def _beside(self, phrase: NounPhrase, leg: Leg, s: float) -> bool:
        k = min(round(s / 0.2), len(leg.points) - 1)
        here = leg.points[k : k + 1]
        if phrase.kind is NounKind.OBJECT or phrase.kind is NounKind.STAIRS:
            return any(thing.distance_m(here)[0] < PASS_M + 0.3 for thing, _ in self.named(phrase, leg.node.floor))
        if phrase.kind is NounKind.OPENING:
            return any(math.dist(p.xy, here[0]) < PASS_M for p, _ in self.world.portals_of(leg.node.floor, leg.node.room))
        if phrase.kind is NounKind.REGION:
            return self.world.compatible(phrase.head, leg.node.floor, leg.node.room) > 0 or any(
                math.dist(p.xy, here[0]) < PASS_M
                and self.world.compatible(phrase.head, p.floor, self.world.portal_rooms[p.id][1 - side]) >= 0
                for p, side in self.world.portals_of(leg.node.floor, leg.node.room)
            )
        return True

    def _past(self, clause: Clause, leg: Leg, share: float = 1.0) -> list[Option]:
        if clause.place is None:
            return []
        phrase = clause.place
        weight = WEIGHT[clause.type] * share
        found = []
        for x, y, quality, reach in self._passable(phrase, leg):
            d = reach
            k = int(np.argmin(d))
            if d[k] > PASS_M:
                continue
            score = weight * quality * (1.0 if d[k] < 1.8 else 0.8)
            if leg.length_m - k * 0.2 < 0.15 and leg.kind == "place":
                score *= 0.8
            side = self._side(leg, k, x, y)
            if phrase.side in ("left", "right") and side and side != phrase.side:
                score *= 0.25
            found.append(Option(k * 0.2, score))
        if phrase.also is not None and found:
            other = self._past(Clause(T.PAST, "", phrase.also), leg)
            found = [Option(o.s_m, o.score * (1.0 if other else 0.6)) for o in found]
        if phrase.kind is NounKind.REGION and self.world.compatible(phrase.head, leg.node.floor, leg.node.room) > 0.3:
            found.append(Option(leg.length_m, 0.8 * weight))
        return sorted(found, key=lambda o: -o.score)[:4]

    def _passable(self, phrase: NounPhrase, leg: Leg) -> list[tuple[float, float, float, np.ndarray]]:
        """(x, y, quality, distances from the leg's points) of everything that a phrase may name beside a leg."""
        out = []
        if phrase.kind in (NounKind.OBJECT, NounKind.STAIRS):
            for thing, value in self.named(phrase, leg.node.floor):
                if self.world.room_of_thing[thing.id][1] in (leg.node.room, 0) or value >= 1.0:
                    out.append((*thing.xy, value, thing.distance_m(leg.points)))
        elif phrase.kind in (NounKind.OPENING, NounKind.REGION):
            for portal, side in self.world.portals_of(leg.node.floor, leg.node.room):
                if leg.portal is not None and portal.id == leg.portal.id:
                    continue
                value = 1.0
                if phrase.region:
                    value = 0.6 + 0.4 * self.world.compatible(
                        phrase.region, portal.floor, self.world.portal_rooms[portal.id][1 - side]
                    )
                if value > 0.3:
                    out.append((*portal.xy, value, np.hypot(*(leg.points - np.array(portal.xy)).T)))
        return out

    @staticmethod
    def _side(leg: Leg, k: int, x: float, y: float) -> str:
        dx, dy = x - leg.points[k, 0], y - leg.points[k, 1]
        across = -math.sin(leg.yaws[k]) * dx + math.cos(leg.yaws[k]) * dy
        return "" if abs(across) < 0.3 else "left" if across > 0 else "right"

    def _toward(self, clause: Clause, leg: Leg) -> list[Option]:
        phrase = clause.place
        if phrase is None:
            return []
        weight = WEIGHT[clause.type]
        found = []
        if phrase.kind in (NounKind.OBJECT, NounKind.STAIRS):
            for thing, value in self.named(phrase, leg.node.floor):
                d = thing.distance_m(leg.points)
                k = int(np.argmin(d))
                if d[k] < NEAR_M + 0.6 and (d[0] - d[k] > 0.4 or d[k] < 1.0):
                    found.append(Option(k * 0.2, weight * value * (1.0 if d[k] < NEAR_M else 0.8)))
        elif phrase.kind is NounKind.OPENING:
            for portal, _ in self.world.portals_of(leg.node.floor, leg.node.room):
                d = np.hypot(*(leg.points - np.array(portal.xy)).T)
                k = int(np.argmin(d))
                if d[k] < NEAR_M:
                    found.append(Option(k * 0.2, 0.7 * weight * self.thresholds.fits(phrase, portal, leg)))
        if phrase.part in ("end", "far end", "other end") and leg.length_m > 1.5:
            found.append(Option(leg.length_m, weight * 0.8))
        return found

    def _along(self, clause: Clause, leg: Leg) -> list[Option]:
        phrase = clause.place
        weight = WEIGHT[clause.type]
        if phrase is None or leg.length_m < 0.9:
            return []
        if phrase.kind is NounKind.REGION:
            agree = self.world.compatible(phrase.head, leg.node.floor, leg.node.room)
            if agree < -0.2:
                return []
            score = weight * (0.6 + 0.4 * agree)
        elif phrase.kind is NounKind.GENERIC:
            score = 0.7 * weight
        else:
            return []
        if phrase.part in ("end", "far end", "other end"):
            score *= 1.0 if leg.label == "end" else 0.85 if leg.length_m > 2.5 else 0.6
        return [Option(max(0.0, leg.length_m - 0.5), score)]

    def _cross(self, clause: Clause, leg: Leg) -> list[Option]:
        """Clauses that the portal at the end of the leg fulfils."""
        if leg.kind == "stairs":
            if clause.type is not T.STAIRS:
                return []
            climbs = leg.label == "" or clause.vertical in ("", leg.label)
            return [Option(leg.length_m, WEIGHT[T.STAIRS] if climbs else -0.5 * WEIGHT[T.STAIRS], THROUGH)]
        if leg.kind != "cross" or leg.portal is None or clause.type is T.STAIRS:
            return []
        weight = WEIGHT[clause.type]
        phrase = clause.place
        target = self.world.portal_rooms[leg.portal.id][1 - leg.side]
        if clause.type is T.LEAVE:
            agree = (
                0.0
                if phrase is None or not phrase.region
                else self.world.compatible(phrase.region, leg.node.floor, leg.node.room)
            )
            return [Option(leg.length_m, weight * (0.7 + 0.3 * agree), LEAVES, bars=ENTERS)]
        if phrase is None:
            return [Option(leg.length_m, 0.7 * weight, ENTERS)]
        if phrase.kind is NounKind.OPENING:
            use = ENTERS if clause.type is T.TO else THROUGH
            agree = self.thresholds.fits(phrase, leg.portal, leg)
            if phrase.region:
                agree *= 0.7 + 0.3 * self.world.compatible(phrase.region, leg.node.floor, target)
            own_way = use == THROUGH and not clause.text.startswith("through")  # "enter it through the door" is one crossing
            return [Option(leg.length_m, weight * agree, use, bars=ENTERS if own_way else 0)]
        if phrase.kind is NounKind.REGION:
            if clause.type is T.THROUGH:
                return []
            agree = self.world.compatible(phrase.head, leg.node.floor, target)
            side = self.thresholds.fits(phrase, leg.portal, leg)
            score = 0.45 + 0.55 * agree if agree >= 0 else 0.45 + 1.2 * agree
            return [Option(leg.length_m, weight * score * side if score > 0 else weight * score, ENTERS)]
        if phrase.kind is NounKind.GENERIC and clause.type is not T.THROUGH:
            hall = self.world.compatible("hallway", leg.node.floor, target)
            return [
                Option(
                    leg.length_m,
                    weight * (0.6 - 0.3 * max(hall, 0.0)) * self.thresholds.fits(phrase, leg.portal, leg),
                    ENTERS,
                )
            ]
        return []

    def goes_on_beyond(self, clause: Clause, leg: Leg) -> bool:
        """Whether a clause happens in the space behind the crossing at the end of a leg, which implies to go there."""
        phrase = clause.place
        if phrase is None or phrase.kind is not NounKind.REGION or leg.portal is None:
            return False
        beyond = self.world.portal_rooms[leg.portal.id][1 - leg.side]
        return clause.type in (T.ALONG, T.ACROSS, T.LEAVE) and self.world.compatible(phrase.head, leg.node.floor, beyond) > SURELY

    def _sees(self, clause: Clause, leg: Leg) -> list[Option]:
        phrase = clause.place
        if phrase is None or phrase.kind not in (NounKind.OBJECT, NounKind.STAIRS):
            return []
        weight = WEIGHT[clause.type]
        start = leg.points[:1]
        for thing, value in self.named(phrase, leg.node.floor):
            if thing.distance_m(start)[0] > 6.0:
                continue
            yaw = float(leg.yaws[0])
            bearing = wrap_angle(math.atan2(thing.xy[1] - start[0, 1], thing.xy[0] - start[0, 0]) - yaw)
            agree = {
                "left": bearing > -0.3,
                "right": bearing < 0.3,
                "ahead": abs(bearing) < 0.9,
                "behind": abs(bearing) > 1.5,
            }.get(phrase.side, True)
            if clause.type is T.NOTICE or agree:
                return [Option(0.0, weight * value)]
        return []
