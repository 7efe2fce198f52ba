"""One room while it is furnished: what is taken, its walls, and the ways to put things down."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from spacevln.environments.houses.furniture.kit import CATALOGUE, Design, design
from spacevln.environments.houses.furniture.leaf import CASING_M, face_of, leaf_place
from spacevln.environments.houses.furniture.mesh import Array
from spacevln.environments.houses.furniture.walls import (
    TOUCH_M,
    Block,
    Pose2,
    Side,
    footprint,
    footprint_of,
    overlap,
    room_sides,
    strip_before,
)
from spacevln.environments.houses.ground.placement import PlacementGuard
from spacevln.environments.houses.plan import House, Item, Opening, Rect, Room

_WALL_GAP_M = 0.01
Prefer = str
"""Where along the walls: ``"corner"``, ``"centre"``, ``"door"`` (beside one), ``"far"`` (from the doors) or ``"any"``."""


@dataclass(slots=True)
class Taste:
    """Which variant of a category comes next in a house: none is repeated before all were used."""

    rng: np.random.Generator
    order: dict[str, list[int]] = field(default_factory=dict)

    def look(self, category: str) -> int:
        """Index of the next look."""
        queue = self.order.setdefault(category, [])
        if not queue:
            queue.extend(int(k) for k in self.rng.permutation(len(CATALOGUE[category].looks)))
        return queue.pop(0)


class RoomSpace:
    """Puts things into one room; every method returns what it placed or None.

    Args:
        house: without furniture.
        room: that is furnished.
        guard: keeps the ways free.
        rng: of this house.
        taste: of this house.
        first_id: the next free instance id.
    """

    def __init__(
        self, house: House, room: Room, guard: PlacementGuard, rng: np.random.Generator, taste: Taste, first_id: int
    ) -> None:
        self.room, self.rng, self.taste = room, rng, taste
        self._guard = guard
        floor = house.floors[room.floor]
        self.floor_z, self.ceiling_m = floor.z_m, floor.ceiling_m
        self.items: list[Item] = []
        self._next = first_id
        self.sides = room_sides(room)
        self.openings = [o for o in house.openings if room.id in o.rooms]
        self.doors = [o for o in self.openings if o.kind != "window"]
        self.windows = [o for o in self.openings if o.kind == "window"]
        self._blocks: list[Block] = []
        self._reserved: list[Rect] = []
        self._mats: list[Rect] = []
        self._side_of: dict[int, tuple[Side, float]] = {}
        self._block_structure(house)

    def _block_structure(self, house: House) -> None:
        half = house.wall_thickness_m / 2
        for o in self.openings:
            face = face_of(o, self.room)
            wide, deep = o.width_m / 2 + CASING_M + 0.02, 0.06 if o.kind != "window" else 0.11
            head = o.head_m + CASING_M + 0.02
            # a headboard or a tap may reach a little over a window sill
            low = o.sill_m + 0.25 if o.kind == "window" else 0.0
            self._blocks.append(Block(strip_before(o, -wide, wide, face, half, deep), low, head, o.id, max(0.0, o.sill_m - 0.06)))
            leaf = leaf_place(house, o)
            if leaf is not None and leaf.room == self.room.id:
                near, far = leaf.side * o.width_m / 2, leaf.side * (1.5 * o.width_m + 0.03)
                self._blocks.append(Block(strip_before(o, min(near, far), max(near, far), face, half, 0.14), 0.0, o.head_m))
        for stairs in house.stairs:
            if self.room.floor in (stairs.lower_floor, stairs.lower_floor + 1):
                r = stairs.rect
                self._blocks.append(Block(Rect(r.x0 - 0.06, r.y0 - 0.06, r.x1 + 0.06, r.y1 + 0.06), 0.0, self.ceiling_m))

    # -- checks ---------------------------------------------------------------------------------------------------------------

    def inside(self, rect: Rect) -> bool:
        """Whether a rectangle lies in the room."""
        x0, y0, x1, y1 = rect.x0, rect.y0, rect.x1, rect.y1
        if any(own.x0 <= x0 and x1 <= own.x1 and own.y0 <= y0 and y1 <= own.y1 for own in self.room.rects):
            return True
        left = [rect]
        for own in self.room.rects:
            rest: list[Rect] = []
            for r in left:
                if not overlap(r, own, 0.0):
                    rest.append(r)
                    continue
                rest += [
                    Rect(r.x0, r.y0, r.x1, own.y0),
                    Rect(r.x0, own.y1, r.x1, r.y1),
                    Rect(r.x0, max(r.y0, own.y0), own.x0, min(r.y1, own.y1)),
                    Rect(own.x1, max(r.y0, own.y0), r.x1, min(r.y1, own.y1)),
                ]
            left = [r for r in rest if r.width > 1e-4 and r.depth > 1e-4]
        return not left

    def fits(self, rect: Rect, z0: float, z1: float, solid: bool, ignore_reserved: bool = False) -> bool:
        """Whether a volume is in the room and free; heights over the floor."""
        if not self.inside(rect) or z1 > self.ceiling_m - 0.005:
            return False
        for block in self._blocks:  # most are elsewhere
            if overlap(rect, block.rect) and z0 < block.z1_m - TOUCH_M and block.low_m(solid) < z1 - TOUCH_M:
                return False
        return not solid or ignore_reserved or not any(overlap(rect, zone) for zone in self._reserved)

    # -- putting down ---------------------------------------------------------------------------------------------------------

    def make(self, category: str, look: int | None = None, form: int | None = None) -> tuple[Design, int]:
        """A design with the next look of the house's taste, and that look."""
        chosen = self.taste.look(category) if look is None else look
        return design(category, chosen, int(self.rng.integers(3)) if form is None else form), chosen

    def commit(self, made: Design, at: Pose2, z: float, support: int | None = None) -> Item:
        """Register an item without any check; ``z`` is over the floor."""
        stand = CATALOGUE[made.category].stand
        item = Item(
            self._next, made.category, made.attributes, self.room.id, self.room.floor, round(at.x, 4), round(at.y, 4),
            round(self.floor_z + z, 4), at.yaw_rad, made.size, made.parts, stand == "floor", support,
        )  # fmt: skip
        self._next += 1
        self.items.append(item)
        if stand != "flat":
            self._blocks.append(Block(footprint(made, at), z, z + made.size[2]))
        return item

    def stand(self, group: Sequence[tuple[Design, Pose2]], front_m: float = 0.0, inner: bool = False) -> list[Item] | None:
        """Put solid things on the floor together; ``front_m`` is kept free of other solid things before the first."""
        rects = [footprint(made, at) for made, at in group]
        if any(overlap(a, b) for i, a in enumerate(rects) for b in rects[:i]):
            return None
        if not all(self.fits(r, 0.0, made.size[2], True, inner) for r, (made, _) in zip(rects, group, strict=True)):
            return None
        zone = self._front(group[0], front_m) if front_m else None
        if zone is not None and any(b.z0_m < 0.9 and overlap(zone, b.rect) for b in self._blocks if b.z1_m > 0.1):
            return None
        if not self._guard.try_add(rects, self.room.id):
            return None
        placed = [self.commit(made, at, 0.0) for made, at in group]
        if zone is not None:
            self._reserved.append(zone)
        return placed

    @staticmethod
    def _front(what: tuple[Design, Pose2], depth: float) -> Rect:
        made, at = what
        c, s = math.cos(at.yaw_rad + math.pi / 2), math.sin(at.yaw_rad + math.pi / 2)
        r = footprint(made, at)
        return Rect(
            r.x1 if c > 0.5 else r.x0 - depth if c < -0.5 else r.x0, r.y1 if s > 0.5 else r.y0 - depth if s < -0.5 else r.y0,
            r.x1 + depth if c > 0.5 else r.x0 if c < -0.5 else r.x1, r.y1 + depth if s > 0.5 else r.y0 if s < -0.5 else r.y1,
        )  # fmt: skip

    def spots(self, width: float, prefer: Prefer, sides: Iterable[Side] | None = None) -> list[tuple[Side, float]]:
        """Places for something of this width along the walls, the best first."""
        found: list[tuple[float, Side, float]] = []
        for side in self.sides if sides is None else sides:
            low, high = side.low + width / 2 + _WALL_GAP_M, side.high - width / 2 - _WALL_GAP_M
            if high < low:
                continue
            count = max(2, int((high - low) / 0.18) + 1)
            t = np.asarray(np.arange(count) * ((high - low) / (count - 1)) + low)  # np.linspace, a good deal faster
            t[-1] = high
            ranks = self._ranks(side, t, low, high, prefer) + self.rng.uniform(0, 0.3, len(t))
            found += [(rank, side, place) for rank, place in zip(ranks.tolist(), t.tolist(), strict=True)]
        found.sort(key=lambda spot: spot[0])
        return [(side, t) for _, side, t in found]

    def _ranks(self, side: Side, t: Array, low: float, high: float, prefer: Prefer) -> Array:
        if prefer == "corner":
            return np.minimum(t - low, high - t)
        if prefer == "centre":
            return np.asarray(np.abs(t - (low + high) / 2) - 0.35 * side.length)
        if prefer in ("door", "far") and self.doors:
            across = side.at + side.inward * 0.3
            x, y = (t, across) if side.along == "x" else (across, t)
            away = np.min([np.hypot(x - o.x, y - o.y) for o in self.doors], axis=0)
            return np.asarray(away if prefer == "door" else -away)
        return self.rng.uniform(0, 3, len(t))

    def against_wall(
        self, category: str, prefer: Prefer = "any", look: int | None = None, front_m: float = 0.0, gap_m: float = _WALL_GAP_M,
        tries: int = 40, form: int | None = None,
    ) -> Item | None:  # fmt: skip
        """Back to a wall."""
        made, _ = self.make(category, look, form)
        for side, t in self.spots(made.size[0], prefer)[:tries]:
            x, y = side.point(t, gap_m + made.size[1] / 2)
            placed = self.stand([(made, Pose2(x, y, side.yaw_rad))], front_m)
            if placed:
                self._side_of[placed[0].id] = (side, t)
                return placed[0]
        return None

    def surely(self, category: str, prefer: Prefer = "any", look: int | None = None, front_m: float = 0.3) -> Item | None:
        """Back to a wall: as wished, else anywhere, at last in its smallest form."""
        chosen = self.taste.look(category) if look is None else look
        return (
            self.against_wall(category, prefer, chosen, front_m)
            or self.against_wall(category, "any", chosen, tries=200)
            or self.against_wall(category, "any", chosen, tries=200, form=smallest_form(category))
        )

    def remember_side(self, item: Item, side: Side, t: float) -> None:
        """Note against which wall an item stands."""
        self._side_of[item.id] = (side, t)

    def side_of(self, item: Item) -> tuple[Side, float] | None:
        """The wall behind an item, and where along it."""
        return self._side_of.get(item.id)

    def beside(self, anchor: Item, category: str, left: bool, gap_m: float = 0.04, look: int | None = None) -> Item | None:
        """Next to an item, their backs in line."""
        made, _ = self.make(category, look)
        shift = (-1 if left else 1) * ((anchor.size[0] + made.size[0]) / 2 + gap_m)
        back = (made.size[1] - anchor.size[1]) / 2
        c, s = math.cos(anchor.yaw_rad), math.sin(anchor.yaw_rad)
        at = Pose2(anchor.x + c * shift - s * back, anchor.y + s * shift + c * back, anchor.yaw_rad)
        placed = self.stand([(made, at)])
        if placed is None:
            return None
        behind = self._side_of.get(anchor.id)
        if behind is not None:
            side = behind[0]
            self._side_of[placed[0].id] = (side, at.x if side.along == "x" else at.y)
        return placed[0]

    def before(self, anchor: Item, made: Design, gap_m: float, face_it: bool, shift_m: float = 0.0) -> tuple[Design, Pose2]:
        """Where something in front of an anchor would stand."""
        forward = anchor.front_yaw_rad
        reach = anchor.size[1] / 2 + gap_m + made.size[1] / 2
        x = anchor.x + math.cos(forward) * reach + math.cos(anchor.yaw_rad) * shift_m
        y = anchor.y + math.sin(forward) * reach + math.sin(anchor.yaw_rad) * shift_m
        return made, Pose2(x, y, _wrap(anchor.yaw_rad + (math.pi if face_it else 0.0)))

    def wall_behind(self, what: tuple[Design, Pose2]) -> tuple[tuple[Design, Pose2], tuple[Side, float]] | None:
        """The same thing pushed back to the wall behind it, and where along which, when that is nearer than 0.7 m."""
        made, at = what
        for side in self.sides:
            if abs(math.sin((side.yaw_rad - at.yaw_rad) / 2)) > 0.01:
                continue
            t, across = (at.x, at.y) if side.along == "x" else (at.y, at.x)
            back = (across - side.at) * side.inward - made.size[1] / 2
            if side.low <= t <= side.high and 0.0 <= back < 0.7:
                x, y = side.point(t, _WALL_GAP_M + made.size[1] / 2)
                return (made, Pose2(x, y, at.yaw_rad)), (side, t)
        return None

    def free_standing(
        self, category: str, yaws: Sequence[float] = (0.0,), look: int | None = None, spread: float = 0.6
    ) -> Item | None:
        """Somewhere in the room, the middle first."""
        made, _ = self.make(category, look)
        for x, y in self.middle_out(spread):
            for yaw in yaws:
                placed = self.stand([(made, Pose2(x, y, yaw))])
                if placed:
                    return placed[0]
        return None

    def middle_out(self, spread: float, step: float = 0.3) -> list[tuple[float, float]]:
        """Points of the room, the middle first."""
        rect = max(self.room.rects, key=lambda r: r.area)
        cx, cy = rect.centre
        n = int(max(rect.width, rect.depth) * spread / step)
        grid = [(cx + i * step, cy + j * step) for i in range(-n, n + 1) for j in range(-n, n + 1)]
        near = sorted(grid, key=lambda p: (math.hypot(p[0] - cx, p[1] - cy), p))
        return [p for p in near if rect.contains(*p, 0.2)][:60]

    def glazed_m(self, side: Side) -> float:
        """Width of the windows in a wall [m]."""
        return sum(
            o.width_m for o in self.windows if o.along == side.along and abs(side.at - (o.y if side.along == "x" else o.x)) < 0.2
        )

    def on_top(
        self, support: Item | None, category: str, at: float | None = None, back: bool = False, look: int | None = None
    ) -> Item | None:
        """On a support; ``at`` from -1 (left end) to 1 (right end), by default the first free place."""
        if support is None:
            return None
        top = CATALOGUE[support.category].top_m
        if top is None:
            return None
        made, _ = self.make(category, look)
        room_x, room_y = (support.size[0] - made.size[0]) / 2 - 0.02, (support.size[1] - made.size[1]) / 2 - 0.02
        if room_x < 0 or room_y < 0:
            return None
        shares = [at] if at is not None else [float(v) for v in self.rng.permutation(np.linspace(-0.95, 0.95, 7))]
        for share in shares:
            depth = -1.0 if back else 0.0 if at is not None else float(self.rng.uniform(-0.4, 0.4))
            dx, dy = share * room_x, depth * room_y
            c, s = math.cos(support.yaw_rad), math.sin(support.yaw_rad)
            pose = Pose2(support.x + c * dx - s * dy, support.y + s * dx + c * dy, support.yaw_rad)
            z = support.z - self.floor_z + top + 0.001
            own = Block(footprint_of(support), support.z - self.floor_z, support.z - self.floor_z + support.size[2])
            others = [b for b in self._blocks if b != own]
            rect = footprint(made, pose)
            if all(not (z < b.z1_m and b.z0_m < z + made.size[2] and overlap(rect, b.rect)) for b in others):
                return self.commit(made, pose, z, support.id)
        return None

    def on_wall(
        self,
        category: str,
        z: float,
        prefer: Prefer = "any",
        above: Item | None = None,
        look: int | None = None,
        lift: float = 0.0,
    ) -> Item | None:
        """Hung on a wall, its lower edge ``z`` over the floor; ``above`` hangs it over an item against a wall."""
        made, _ = self.make(category, look)
        if above is not None:
            behind = self._side_of.get(above.id)
            if behind is None:
                return None
            spots = [behind]
            z = max(z, above.z - self.floor_z + above.size[2] + lift)
        else:
            spots = self.spots(made.size[0] + 0.1, prefer)
        for side, t in spots[:30]:
            x, y = side.point(t, made.size[1] / 2 + 0.003)
            pose = Pose2(x, y, side.yaw_rad)
            if self.fits(footprint(made, pose), z, z + made.size[2], False):
                item = self.commit(made, pose, z)
                self._side_of[item.id] = (side, t)
                return item
        return None

    def over_opening(self, category: str, opening: Opening, z: float, look: int | None = None) -> Item | None:
        """Hung on the wall over or around an opening, centred on it."""
        made, _ = self.make(category, look)
        for side in self.sides:
            across = opening.y if side.along == "x" else opening.x
            t = opening.x if side.along == "x" else opening.y
            if side.along == opening.along and abs(side.at - across) < 0.2 and side.low < t < side.high:
                x, y = side.point(t, made.size[1] / 2 + (0.035 if category == "curtain" else 0.003))
                pose = Pose2(x, y, side.yaw_rad)
                rect = footprint(made, pose)
                if not self.inside(rect) or z + made.size[2] > self.ceiling_m - 0.01:
                    return None
                if category == "curtain":
                    clash = [b for b in self._blocks if overlap(rect, b.rect) and b.opening != opening.id]
                    if clash:
                        return None
                elif not self.fits(rect, z, z + made.size[2], False):
                    return None
                return self.commit(made, pose, z)
        return None

    def under_ceiling(self, category: str, at: tuple[float, float] | None = None, look: int | None = None) -> Item | None:
        """Hung from the ceiling, by default in the middle of the room."""
        made, _ = self.make(category, look)
        x, y = at or self.room.centre
        pose = Pose2(x, y, 0.0)
        z = self.ceiling_m - made.size[2] - 0.006
        if z < 1.9 or not self.fits(footprint(made, pose), z, z + made.size[2], False):
            return None
        return self.commit(made, pose, z)

    def lay(self, category: str, at: Pose2, look: int | None = None) -> Item | None:
        """Flat on the floor; may lie under furniture but not over another rug."""
        made, _ = self.make(category, look)
        rect = footprint(made, at)
        clash = any(overlap(rect, other) for other in self._mats)
        stairs = any(b.z1_m >= self.ceiling_m and overlap(rect, b.rect) for b in self._blocks)
        if clash or stairs or not self.inside(rect):
            return None
        self._mats.append(rect)
        return self.commit(made, at, 0.001)

    @property
    def next_id(self) -> int:
        """The next free instance id."""
        return self._next


@lru_cache(maxsize=256)
def smallest_form(category: str) -> int:
    """The form of a category that takes the least floor."""
    return min(range(6), key=lambda form: design(category, 0, form).size[0] * design(category, 0, form).size[1])


def _wrap(angle: float) -> float:
    return (angle + math.pi) % (2 * math.pi) - math.pi
