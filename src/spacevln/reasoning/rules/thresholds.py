"""How well a doorway or opening fits a phrase that names it: kind, attributes, side, ordinal."""

from __future__ import annotations

import math

from spacevln.core import wrap_angle
from spacevln.language import NounKind, NounPhrase
from spacevln.perception.matching import fit
from spacevln.reasoning.rules.legs import Leg
from spacevln.reasoning.rules.sightings import Portal
from spacevln.reasoning.rules.world import World

SIDE_LOW_RAD, SIDE_HIGH_RAD = math.radians(20), math.radians(165)


def side_fits(side: str, angle: float) -> float:
    """1 when a bend is clearly to the side, 0.3 when slightly, -1 when to the other."""
    signed = angle if side == "left" else -angle
    if SIDE_LOW_RAD < signed < SIDE_HIGH_RAD:
        return 1.0
    return 0.3 if math.radians(8) < signed or abs(angle) >= SIDE_HIGH_RAD else (0.0 if abs(angle) < math.radians(20) else -1.0)


class Thresholds:
    """Judges the portals of one world, as they lie for someone who walks a leg."""

    def __init__(self, world: World) -> None:
        self.world = world

    def fits(self, phrase: NounPhrase, portal: Portal, leg: Leg) -> float:
        """Agreement of a portal with a phrase's kind, attributes, side and ordinal: 1 down to 0.1."""
        score = 1.0
        if phrase.kind is NounKind.OPENING:
            if (
                phrase.attributes
                and fit(f"{' '.join(phrase.attributes)} {portal.category}", portal.category, portal.attributes) is not None
            ):
                verdict = fit(f"{' '.join(phrase.attributes)} {portal.category}", portal.category, portal.attributes)
                score *= 1.0 if verdict is None or verdict.value > 0.5 else 0.3
            if phrase.head in ("opening", "archway") and portal.category == "doorway":
                score *= 0.7
            if phrase.head == "doorway" and portal.category == "opening":
                score *= 0.7
        if phrase.side in ("left", "right"):
            score *= 1.0 if self.lies(leg, portal, phrase.side) else 0.2
        if phrase.side == "ahead":
            bearing = self._bearing(leg, portal)
            score *= 1.0 if abs(bearing) < math.radians(50) else 0.4
        if phrase.ordinal and phrase.kind is not NounKind.OBJECT:
            _, number = self.ordinal(leg, portal)
            score *= (
                1.0 if number == phrase.ordinal or (phrase.ordinal == -1 and leg.length_m > 2.0) else 0.8 if number == 0 else 0.35
            )
        return score

    def _bearing(self, leg: Leg, portal: Portal) -> float:
        dx, dy = portal.xy[0] - leg.node.xy[0], portal.xy[1] - leg.node.xy[1]
        return wrap_angle(math.atan2(dy, dx) - leg.node.yaw_rad)

    def lies(self, leg: Leg, portal: Portal, side: str) -> bool:
        """Whether a portal lies on a side, seen from the leg's begin or from its main run."""
        angles = [self._bearing(leg, portal)]
        if leg.portal is not None and leg.portal.id == portal.id:
            angles.append(wrap_angle(portal.normal_rad(leg.side) - leg.travel_rad))
        return any(side_fits(side, angle) >= 1.0 for angle in angles)

    def ordinal(self, leg: Leg, portal: Portal) -> tuple[str, int]:
        """Side and number of a portal among those beside the leg's run; ("", 0) when it is not beside it."""
        travel = leg.travel_rad
        ux, uy = math.cos(travel), math.sin(travel)
        ranked = []
        for other, side in self.world.portals_of(leg.node.floor, leg.node.room):
            if other.id == leg.node.portal:
                continue
            turn = wrap_angle(other.normal_rad(side) - travel)
            if not math.radians(50) < abs(turn) < math.radians(130):
                continue
            along = (other.xy[0] - leg.node.xy[0]) * ux + (other.xy[1] - leg.node.xy[1]) * uy
            ranked.append((along, other.id, "left" if turn > 0 else "right"))
        mine = next((r for r in ranked if r[1] == portal.id), None)
        if mine is None:
            return "", 0
        same = sorted(r for r in ranked if r[2] == mine[2] and r[0] > -0.3)
        numbers = [r[1] for r in same]
        return (mine[2], numbers.index(portal.id) + 1) if portal.id in numbers else ("", 0)
