"""What was seen so far, as things and portals with places: the planner's reading of look-arounds and memory.

Sightings of one thing from several views and boundaries are merged by category and place. Doorways, openings and archways become
*portals* with a threshold line, because a route crosses them; everything else stays a thing.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from spacevln.core import LandmarkCue, Sighting
from spacevln.language import attributes_of, head_noun
from spacevln.language.nouns_lexicon import OPENINGS, STAIRS

XY = tuple[float, float]
SAME_THING_M = 0.6
SAME_PORTAL_M = 0.75
SAME_UNSURE_PORTAL_M = 1.0
PRECISE_WIDTH_M = (0.75, 1.3)  # of a doorway whose two jambs were seen
GUESSED_WIDTH_M = 0.9
PRECISE_QUALITY = 0.2  # portals under it are guesses
MAX_SURFACE = 32


@dataclass(slots=True)
class Thing:
    """A piece of furniture, an object or a flight of stairs that was seen.

    Args:
        id: number in the order of discovery.
        category: canonical name.
        attributes: of its best sighting.
        floor: storey.
        xy: centre of the seen surface.
        z_m: its height.
        extent_m: largest horizontal extent seen.
        surface: seen surface points.
        relief: of stairs: seen points and normals (x, y, z, nx, ny, nz).
        weight: pixels seen so far.
        seen_from: where the body stood at the first sight.
        names: what detections called it, the first first.
    """

    id: int
    category: str
    attributes: tuple[str, ...]
    floor: int
    xy: XY
    z_m: float
    extent_m: float
    surface: list[XY] = field(default_factory=list)
    relief: list[tuple[float, float, float, float, float, float]] = field(default_factory=list)
    weight: float = 1.0
    seen_from: XY = (0.0, 0.0)
    names: list[str] = field(default_factory=list)

    @property
    def front(self) -> XY:
        """A place just before its seen surface, on the side from which it was seen."""
        dx, dy = self.seen_from[0] - self.xy[0], self.seen_from[1] - self.xy[1]
        reach = math.hypot(dx, dy)
        x, y = min(self.surface or [self.xy], key=lambda p: math.hypot(p[0] - self.seen_from[0], p[1] - self.seen_from[1]))
        return (x + 0.3 * dx / reach, y + 0.3 * dy / reach) if reach > 0.3 else self.xy

    def distance_m(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Distance of points (N, 2) to the nearest seen surface point, (N,) [m]."""
        surface = np.asarray(self.surface or [self.xy])
        return np.asarray(np.hypot(*(points[:, None] - surface[None]).transpose(2, 0, 1)).min(axis=1))


@dataclass(slots=True)
class Portal:
    """A doorway, an opening or an archway that was seen.

    Args:
        id: number in the order of discovery.
        category: ``"doorway"``, ``"opening"`` or ``"archway"``.
        attributes: of its best sighting.
        floor: storey.
        xy: middle of the threshold.
        along_rad: direction of the threshold line.
        width_m: from jamb to jamb.
        quality: of the best sighting; its geometry is kept.
        passage: depth showed a way through.
    """

    id: int
    category: str
    attributes: tuple[str, ...]
    floor: int
    xy: XY
    along_rad: float
    width_m: float
    quality: float
    passage: bool = False

    def normal_rad(self, side: int) -> float:
        """Direction of walking out of side 0 (into side 1), or out of side 1."""
        return self.along_rad + (math.pi / 2 if side == 0 else -math.pi / 2)

    def beside(self, side: int, distance_m: float) -> XY:
        """The point ``distance_m`` from the threshold on a side."""
        angle = self.normal_rad(1 - side)
        return self.xy[0] + distance_m * math.cos(angle), self.xy[1] + distance_m * math.sin(angle)

    def side_of(self, xy: XY) -> int:
        """On which side a point lies."""
        return (
            0
            if math.cos(self.normal_rad(0)) * (xy[0] - self.xy[0]) + math.sin(self.normal_rad(0)) * (xy[1] - self.xy[1]) < 0
            else 1
        )


@dataclass(frozen=True, slots=True)
class Glimpse:
    """A slanting or partly hidden sight of an opening: where a jamb stands, but not where the threshold runs."""

    category: str
    attributes: tuple[str, ...]
    floor: int
    jamb: XY
    seen_from: XY


class Sightings:
    """Accumulates the sightings of an episode.

    ``square_rad`` is the direction of the walls, modulo a right angle.
    """

    def __init__(self) -> None:
        self.things: list[Thing] = []
        self._precise: list[Portal] = []
        self._glimpses: list[Glimpse] = []
        self.portals: list[Portal] = []
        self.square_rad = 0.0

    def add(self, sightings: Iterable[Sighting], floor: int, seen_from: XY, square_rad: float) -> None:
        """Take in lifted detections made on a floor from a place; walls run along ``square_rad`` and across it."""
        for sighting in sightings:
            category = head_noun(sighting.category)
            if category in OPENINGS:
                self._add_portal(sighting, category, floor, seen_from)
            else:
                self._add_thing(sighting, category, floor, seen_from)
        self.square_rad = self._square(square_rad)
        self.portals = self._resolved()

    def on(self, floor: int) -> tuple[list[Thing], list[Portal]]:
        """Things and portals of a floor."""
        return [t for t in self.things if t.floor == floor], [p for p in self.portals if p.floor == floor]

    def _add_thing(self, sighting: Sighting, category: str, floor: int, seen_from: XY) -> None:
        x, y, z = sighting.position_m
        surface = list(sighting.surface_m) or [(x, y)]
        weight = float(max(sighting.pixels, 1))
        attributes = tuple(dict.fromkeys((*attributes_of(sighting.category), *sighting.attributes)))
        for thing in self.things:
            if thing.floor != floor or thing.category != category or not _agree(thing.attributes, attributes):
                continue
            reach = SAME_THING_M if category not in STAIRS else 2.5
            near = min(math.hypot(ax - bx, ay - by) for ax, ay in thing.surface[:12] for bx, by in surface[:8])
            apart = math.hypot(thing.xy[0] - x, thing.xy[1] - y)
            if near > reach / 2 and apart > max(reach, 0.4 * thing.extent_m):
                continue
            if near > reach or apart > max(2 * reach, thing.extent_m + 0.3):
                continue
            share = weight / (weight + thing.weight)
            thing.xy = (thing.xy[0] + share * (x - thing.xy[0]), thing.xy[1] + share * (y - thing.xy[1]))
            thing.weight += weight
            thing.extent_m = max(thing.extent_m, sighting.extent_m)
            thing.surface = (thing.surface + surface)[-MAX_SURFACE:]
            thing.relief.extend(sighting.relief)
            if sighting.category not in thing.names:
                thing.names.append(sighting.category)
            thing.attributes = thing.attributes or attributes
            return
        self.things.append(
            Thing(
                len(self.things),
                category,
                attributes,
                floor,
                (x, y),
                z,
                sighting.extent_m,
                surface[:MAX_SURFACE],
                list(sighting.relief),
                weight,
                seen_from,
                [sighting.category],
            )
        )

    def _add_portal(self, sighting: Sighting, category: str, floor: int, seen_from: XY) -> None:
        x, y, _ = sighting.position_m
        along, width = _threshold(sighting.surface_m)
        precise = (
            width >= PRECISE_WIDTH_M[0]
            if sighting.is_passage
            else category == "doorway" and PRECISE_WIDTH_M[0] <= width <= PRECISE_WIDTH_M[1]
        )
        if not precise:
            jamb = min(sighting.surface_m or ((x, y),), key=lambda p: math.dist(p, seen_from))
            self._glimpses.append(Glimpse(category, sighting.attributes, floor, jamb, seen_from))
            return
        quality = (1.5 if sighting.is_passage else 1.0) / (1.0 + sighting.distance_m / 4.0)
        reach = max(SAME_PORTAL_M if sighting.is_passage else SAME_UNSURE_PORTAL_M, 0.35 * width)
        found = next(
            (p for p in self._precise if p.floor == floor and math.dist(p.xy, (x, y)) <= max(reach, 0.35 * p.width_m)), None
        )
        if found is None:
            self._precise.append(
                Portal(
                    len(self._precise), category, sighting.attributes, floor, (x, y), along, width, quality, sighting.is_passage
                )
            )
            return
        if quality > found.quality:
            found.xy, found.along_rad, found.width_m, found.quality = (x, y), along, width, quality
            found.category = category
            found.attributes = sighting.attributes or found.attributes
        found.passage = found.passage or sighting.is_passage

    def _square(self, square_rad: float) -> float:
        """Walls stand square, so precise thresholds tell their direction best."""
        if not self._precise:
            return square_rad
        sine = sum(math.sin(4 * p.along_rad) * p.quality for p in self._precise)
        return math.atan2(sine, sum(math.cos(4 * p.along_rad) * p.quality for p in self._precise)) / 4

    def _resolved(self) -> list[Portal]:
        """Precise portals, and guesses from glimpses that none of them explains.

        A glimpse is slanting: of the two directions of walls its threshold has the one nearer to the line of sight, and its
        middle lies half a door beyond the nearer jamb.
        """
        portals, square = list(self._precise), self.square_rad
        for glimpse in self._glimpses:
            sight = math.atan2(glimpse.jamb[1] - glimpse.seen_from[1], glimpse.jamb[0] - glimpse.seen_from[0])
            along = square + round((sight - square) / (math.pi / 2)) * math.pi / 2
            xy = (glimpse.jamb[0] + 0.5 * math.cos(along), glimpse.jamb[1] + 0.5 * math.sin(along))
            if any(p.floor == glimpse.floor and math.dist(p.xy, xy) < 0.9 + 0.5 * p.width_m for p in portals):
                continue
            portals.append(
                Portal(len(portals), glimpse.category, glimpse.attributes, glimpse.floor, xy, along, GUESSED_WIDTH_M, 0.1)
            )
        return portals


def remembered(cue: LandmarkCue) -> Sighting | None:
    """The sighting behind a waypoint's cue; None for one without a place, and for a way through, whose threshold is not kept."""
    if cue.position_m is None or head_noun(cue.category) in OPENINGS:
        return None
    return Sighting(
        category=cue.category,
        confidence=cue.confidence,
        box_px=(0, 0, 0, 0),
        position_m=cue.position_m,
        distance_m=cue.distance_m,
        bearing_rad=0.0,
        extent_m=cue.extent_m,
        attributes=cue.attributes,
    )


def _agree(a: tuple[str, ...], b: tuple[str, ...]) -> bool:
    return not a or not b or bool(set(a) & set(b))


def _threshold(surface: Sequence[XY]) -> tuple[float, float]:
    """Direction and length of the line from jamb to jamb."""
    if len(surface) < 2:
        return 0.0, 0.0
    (ax, ay), (bx, by) = surface[0], surface[-1]
    return math.atan2(by - ay, bx - ax), math.hypot(bx - ax, by - ay)
