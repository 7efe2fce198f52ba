"""Where a flight of stairs is entered and where it leads, from how its seen surface rises over the floor.

A flight is a wedge: going up it, every step lies on one slope. Of the four directions in which it can run (stairs stand square to
the walls) and a few usual slopes, the one is taken on which most of the treads and risers lie. A corner of the flight is enough.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from spacevln.core import Anchor, Pose, SpaceKind
from spacevln.core.geometry import Float
from spacevln.reasoning.rules.sightings import XY, Thing

BEFORE_M = 0.45  # one stands this far before the first step
BEYOND_M = 0.9  # and is off the flight this far behind the last one
STOREY_M = 2.8  # a usual storey, from floor to floor
SLOPES = (0.67, 0.6, 0.75, 0.55, 0.85, 0.95)  # rise over run, the usual one first: of equals it is taken
EDGE_M = 0.32  # the points of a slope begin within a step's run
FIRST_STEP = 0.9  # of them, in order along the flight: where the foot of the first riser is
ACROSS_M, ALONG_M = 0.3, 0.7  # this near to its entry one may step onto a flight
RUN_PER_RISE = 1.5  # of usual stairs
LAST_STEPS_M = 0.6
ON_STEPS_M = 0.25  # this much over or under the floor one stands on steps
ARRIVED_M = 0.6
STILL_M = 0.1
MOST_STAGES = 6  # planning boundaries on the steps
CLEAR_OF_FLOOR_M = 0.1
FACING = 0.85  # cosine of the angle between a surface's normal and that of a tread or a riser
RAILING_M = 1.15  # what is seen up to this height may be the railing of a flight that leads down
WIDTH_M = 1.0  # of a flight
RAIL_M = (0.15, 1.1)  # heights over the floor at which a railing is seen
RAIL_END_M = 0.15
LEAST_POINTS = 8
LEAST_SHARE = 0.5  # of the points that could be steps, that the slope must explain
LEAST_RISE_M = 0.15  # from the first to the last of them, up and along: two steps
STAIRS_SIGHT = Anchor("sight of the stairs", SpaceKind.CONNECTOR)
STAIRS_ENTRY = Anchor("entry of the stairs", SpaceKind.CONNECTOR)


@dataclass(frozen=True, slots=True)
class Flight:
    """A straight flight, as seen from one of its two floors.

    Args:
        entry: where one stands before its first step, on this floor.
        far: where one stands behind its last step, on the other floor.
        leads: ``"up"`` or ``"down"``, for someone on this floor.
    """

    entry: XY
    far: XY
    leads: str

    def is_before(self, xy: XY) -> bool:
        """Whether one who walks straight on from a place comes onto the flight."""
        dx, dy = xy[0] - self.entry[0], xy[1] - self.entry[1]
        yaw = math.atan2(self.far[1] - self.entry[1], self.far[0] - self.entry[0])
        along, across = math.cos(yaw) * dx + math.sin(yaw) * dy, math.cos(yaw) * dy - math.sin(yaw) * dx
        return abs(across) <= ACROSS_M and abs(along) <= ALONG_M


def flight_of(stairs: Thing, floor_m: float, square_rad: float) -> Flight | None:
    """The flight that was seen; None when too little of its steps was.

    Args:
        stairs: with its relief.
        floor_m: height of the floor on which one stands.
        square_rad: direction of the walls, modulo a right angle.
    """
    relief = np.asarray(stairs.relief, dtype=float).reshape(-1, 6)
    leads = leads_of(stairs, floor_m)
    rise = (relief[:, 2] - floor_m) * (1 if leads == "up" else -1)
    fits = list(_fits(relief, rise, leads, square_rad)) if leads else []
    if not fits:
        return None
    best = max(fits, key=lambda fit: fit.support)
    entry = best.begin - BEFORE_M * best.direction
    far = best.begin + (STOREY_M / best.slope + BEYOND_M) * best.direction
    return Flight((float(entry[0]), float(entry[1])), (float(far[0]), float(far[1])), leads)


def leads_of(stairs: Thing, floor_m: float) -> str:
    """Whether stairs lead ``"up"`` or ``"down"`` from a floor of that height; ``""`` when only a railing was seen."""
    height = np.asarray([point[2] for point in stairs.relief]) - floor_m
    if np.count_nonzero(height > RAILING_M) >= LEAST_POINTS:
        return "up"
    return "down" if np.count_nonzero(height < -CLEAR_OF_FLOOR_M) >= LEAST_POINTS else ""


@dataclass(slots=True)
class Crossing:
    """A flight of stairs that is being walked.

    Args:
        far: where it is expected to end.
        leads: ``"up"`` or ``"down"``.
        floor: storey where it began.
        began: pose before its first step.
        last: pose at the last planning boundary.
        stages: planning boundaries so far.
    """

    far: XY
    leads: str
    floor: int
    began: Pose
    last: Pose
    stages: int = 0

    @property
    def target_m(self) -> tuple[float, float, float]:
        """Its far end, on the other storey."""
        return (*self.far, self.began.z_m + (STOREY_M if self.leads == "up" else -STOREY_M))

    @property
    def anchor(self) -> Anchor:
        """What is reached at its far end."""
        return Anchor("top of the stairs" if self.leads == "up" else "bottom of the stairs", SpaceKind.CONNECTOR)

    def go_on(self, pose: Pose) -> bool:
        """Take in a boundary's pose; whether the flight is not yet behind one.

        What the feet have climbed tells more than what was seen: on the steps the flight leads where one has just gone.
        """
        climbed, rose = abs(pose.z_m - self.began.z_m), abs(pose.z_m - self.last.z_m)
        gone = math.hypot(pose.x_m - self.last.x_m, pose.y_m - self.last.y_m)
        self.stages += 1
        if ON_STEPS_M < climbed < STOREY_M - ON_STEPS_M and rose > ON_STEPS_M / 2 and gone > ON_STEPS_M:
            rest = (STOREY_M - climbed) * RUN_PER_RISE + BEYOND_M
            self.far = (
                pose.x_m + rest * (pose.x_m - self.last.x_m) / gone,
                pose.y_m + rest * (pose.y_m - self.last.y_m) / gone,
            )
        stands = self.stages > 1 and gone < STILL_M and rose < STILL_M
        self.last = pose
        if stands:
            return False  # it does not lead on here, whatever it looks like
        if climbed > STOREY_M - LAST_STEPS_M and rose < ON_STEPS_M / 2:
            return False  # at its end, where something stands in the way that was thought to go on
        if climbed > STOREY_M - ON_STEPS_M:
            return rose > ON_STEPS_M and pose.distance_m(*self.far) > ARRIVED_M
        return climbed > ON_STEPS_M and self.stages <= MOST_STAGES


@dataclass(frozen=True, slots=True, eq=False)
class _Fit:
    """A slope through seen steps: how many points support it, its direction, rise over run, and its first step's middle."""

    support: int
    direction: Float
    slope: float
    begin: Float


def _fits(relief: Float, rise: Float, leads: str, square_rad: float) -> Iterator[_Fit]:
    """The slopes that explain most of the points that could be steps of them."""
    above = (rise > CLEAR_OF_FLOOR_M) & (rise < STOREY_M)
    treads = relief[:, 5] > FACING
    for quarter in range(4):
        angle = square_rad + quarter * math.pi / 2
        direction = np.array([math.cos(angle), math.sin(angle)])
        side = np.array([-direction[1], direction[0]])
        risers = (leads == "up") & (relief[:, 3:5] @ direction < -FACING)  # from above they are not seen
        steps = above & (treads | risers)
        if np.count_nonzero(steps) < LEAST_POINTS:
            continue
        along, up = relief[steps, :2] @ direction, rise[steps]
        for slope in SLOPES:
            begins = along - up / slope
            ordered = np.sort(begins)
            within = np.searchsorted(ordered, ordered + EDGE_M, side="right") - np.arange(len(ordered))
            k = int(np.argmax(within))
            on = (begins >= ordered[k]) & (begins <= ordered[k] + EDGE_M)
            if (
                within[k] < LEAST_SHARE * len(ordered)
                or within[k] < LEAST_POINTS
                or min(np.ptp(up[on]), np.ptp(along[on])) < LEAST_RISE_M
            ):
                continue
            across = relief[steps, :2][on] @ side
            begin = float(np.quantile(begins[on], FIRST_STEP)) * direction + float(across.min() + across.max()) / 2 * side
            yield _Fit(int(within[k]), direction, slope, begin)


def open_end(stairs: Thing, floor_m: float, square_rad: float) -> XY | None:
    """Where the railing around a well is open, hence where its flight begins; None when that was not seen.

    A railing runs along the well and across its far end: the flight begins at the other end.
    """
    relief = np.asarray(stairs.relief, dtype=float).reshape(-1, 6)
    height = relief[:, 2] - floor_m
    rail = relief[(height > RAIL_M[0]) & (height < RAIL_M[1]), :2]
    if len(rail) < LEAST_POINTS:
        return None
    c, s = math.cos(square_rad), math.sin(square_rad)
    axes = np.array([[c, s], [-s, c]])
    ends = np.array([rail @ axis for axis in axes])
    long = int(np.argmax(np.ptp(ends, axis=1)))
    low, high = ends[long].min(), ends[long].max()
    widths = [float(np.ptp(ends[1 - long][np.abs(ends[long] - end) < RAIL_END_M])) for end in (low, high)]
    if high - low < 2 * WIDTH_M or max(widths) < WIDTH_M / 2 or min(widths) > WIDTH_M / 2:
        return None
    begin = low - BEFORE_M if widths[0] < widths[1] else high + BEFORE_M
    middle = (ends[1 - long].min() + ends[1 - long].max()) / 2
    x, y = begin * axes[long] + middle * axes[1 - long]
    return float(x), float(y)
