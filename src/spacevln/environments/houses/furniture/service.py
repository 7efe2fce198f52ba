"""How rooms of each type are furnished: kitchens, bathrooms, service and sport."""

from __future__ import annotations

import math

from spacevln.environments.houses.furniture.kit import design
from spacevln.environments.houses.furniture.recipes import corner_things, dining_group, dress_windows, hang_paintings, light, some
from spacevln.environments.houses.furniture.space import RoomSpace, smallest_form
from spacevln.environments.houses.furniture.walls import Pose2, Side
from spacevln.environments.houses.plan import Item

_ROWS = (
    ("refrigerator", "kitchen counter", "stove", "kitchen counter", "kitchen sink", "dishwasher", "kitchen counter"),
    ("refrigerator", "kitchen counter", "stove", "kitchen counter", "kitchen sink", "dishwasher"),
    ("refrigerator", "kitchen counter", "stove", "kitchen sink", "dishwasher"),
    ("kitchen counter", "stove", "kitchen counter", "kitchen sink"),
    ("kitchen counter", "stove", "kitchen sink"),
    ("kitchen counter", "stove"),
)
_CABINETS = ("kitchen counter", "kitchen sink", "kitchen island", "wall cabinet")


def kitchen(s: RoomSpace) -> None:
    """Counters in a row with stove, sink and refrigerator; an island or a small table; things on the counters."""
    look = s.taste.look("kitchen counter")
    metal = s.taste.look("refrigerator")
    row = _kitchen_row(s, look, metal, _ROWS[:3])
    if not row:
        # the tall refrigerator needs the rare stretch of wall without a window
        cold = s.surely("refrigerator", "corner", metal)
        row = [*_kitchen_row(s, look, metal, _ROWS[3:]), *([cold] if cold is not None else [])]
    have = {item.category for item in row}
    for name in ("stove", "refrigerator", "kitchen sink", "kitchen counter"):
        if name not in have:
            chosen = look if name in _CABINETS else metal
            item = s.surely(name, "corner", chosen, 0.35)
            row += [item] if item is not None else []
    counters = [item for item in row if item.category in ("kitchen counter", "dishwasher")]
    if len(counters) < 2:
        extra = s.against_wall("kitchen counter", "corner", look=look, front_m=0.35)
        row += [extra] if extra is not None else []
        counters += [extra] if extra is not None else []
    for item in row:
        if item.category == "stove":
            s.on_wall("range hood", 1.52, above=item)
        elif item.category in ("kitchen counter", "dishwasher") and some(s, 0.8):
            s.on_wall("wall cabinet", 1.5, above=item, look=look)
    names = ("microwave", "kettle", "toaster", "coffee machine", "fruit bowl", "teapot", "flowers")
    order = [names[int(k)] for k in s.rng.permutation(len(names))]
    for name, counter in zip(order, counters * 2, strict=False):
        s.on_top(counter, name)
    _kitchen_middle(s, look)
    s.against_wall("trash can", "corner")
    corner_things(s, ("potted plant", "wine rack", "cabinet", "stool"), 1 if s.room.area < 12 else 2)
    s.on_wall("clock", 1.65)
    if some(s, 0.4):
        s.on_wall("calendar", 1.3)
    hang_paintings(s, 1 if some(s, 0.5) else 0)
    light(s)


def _kitchen_row(s: RoomSpace, look: int, metal: int, rows: tuple[tuple[str, ...], ...]) -> list[Item]:
    # wall without windows first: it takes the refrigerator and the wall cabinets
    sides = sorted(s.sides, key=lambda side: s.glazed_m(side) - side.length)
    for row, compact in ((row, compact) for row in rows for compact in (False, True)):
        made = [design(name, look if name in _CABINETS else metal, smallest_form(name) if compact else 0) for name in row]
        for order in (made, made[::-1]) if some(s, 0.5) else (made[::-1], made):
            total = sum(one.size[0] for one in order) + 0.002 * len(order)
            for side in sides:
                if side.length < total + 0.02:
                    continue
                for start in _starts(side, total):
                    group, places, t = [], [], start
                    for one in order:
                        middle = t + one.size[0] / 2
                        x, y = side.point(middle, 0.01 + one.size[1] / 2)
                        group.append((one, Pose2(x, y, side.yaw_rad)))
                        places.append(middle)
                        t += one.size[0] + 0.002
                    placed = s.stand(group)
                    if placed:
                        for item, middle in zip(placed, places, strict=True):
                            s.remember_side(item, side, middle)
                        return placed
    return []


def _starts(side: Side, total: float) -> list[float]:
    low, high = side.low + 0.01, side.high - total - 0.01
    steps = max(1, int((high - low) / 0.3))
    return [low + (high - low) * k / steps for k in (0, *range(steps, 0, -1))]


def _kitchen_middle(s: RoomSpace, look: int) -> None:
    if s.room.area > 11 and some(s, 0.65):
        island = s.free_standing("kitchen island", (0.0, math.pi / 2), look=look, spread=0.4)
        if island is not None:
            stool = s.taste.look("bar stool")
            for shift in (-0.4, 0.4):
                made, _ = s.make("bar stool", stool)
                s.stand([s.before(island, made, 0.03, True, shift)])
            s.on_top(island, "fruit bowl" if some(s, 0.5) else "flowers")
            return
    if s.room.area > 10.5:
        table = dining_group(s, "round table")
        s.on_top(table, "fruit bowl" if some(s, 0.4) else "teapot", at=0.0)


def bathroom(s: RoomSpace) -> None:
    """Toilet, sink under a mirror, tub or shower, towels."""
    toilet = s.surely("toilet", "corner", front_m=0.25)
    sink = s.surely("bathroom sink", "any", front_m=0.3)
    bath = s.against_wall("bathtub", "corner") if s.room.area > 4.6 and some(s, 0.7) else None
    if bath is None or (s.room.area > 7 and some(s, 0.5)):
        s.surely("shower", "corner", front_m=0.2)
    if sink is not None:
        s.on_wall("mirror", 1.2, above=sink, lift=0.04)
    anchor = bath or sink or toilet
    if anchor is not None:
        made, _ = s.make("bath mat")
        _, at = s.before(anchor, made, 0.08, False)
        s.lay("bath mat", at)
    for _ in range(2):
        s.on_wall("towel", 0.75)
    names = ("laundry basket", "trash can", "potted plant", "stool", "radiator")
    corner_things(s, names, 1 if s.room.area < 5 else 2)
    if s.room.area > 7:
        s.against_wall("cabinet", "any")
    s.under_ceiling("ceiling lamp", look=0)


def laundry_room(s: RoomSpace) -> None:
    """Washing machine and dryer side by side, a basket, an ironing board."""
    look = s.taste.look("washing machine")
    washer = s.surely("washing machine", "corner", look, 0.35)
    if washer is not None:
        dryer = s.beside(washer, "dryer", left=True, gap_m=0.02, look=look) or s.beside(
            washer, "dryer", left=False, gap_m=0.02, look=look
        )
        if dryer is None:
            s.against_wall("dryer", "any", look=look)
        s.on_wall("wall shelf", 1.4, above=washer)
    s.against_wall("laundry basket", "corner")
    s.against_wall("ironing board", "any")
    corner_things(s, ("vacuum cleaner", "storage rack", "cabinet", "trash can", "laundry basket", "ladder", "radiator"), 2)
    if some(s, 0.5):
        s.on_wall("towel", 0.8)
    s.under_ceiling("ceiling lamp", look=0)


def closet(s: RoomSpace) -> None:
    """Wardrobes, shoes, suitcases, boxes."""
    s.surely("clothes rack", "centre", front_m=0.2)
    s.against_wall("shoe rack", "any")
    s.against_wall("wardrobe", "corner")
    corner_things(s, ("suitcase", "cardboard box", "coat rack", "suitcase", "vacuum cleaner", "ironing board", "storage rack"), 3)
    if some(s, 0.5):
        s.on_wall("mirror", 0.7)
    s.under_ceiling("ceiling lamp", look=0)


def garage(s: RoomSpace) -> None:
    """A car if it fits, a workbench, racks, a bicycle."""
    rect = max(s.room.rects, key=lambda r: r.area)
    long_way = math.pi / 2 if rect.width > rect.depth else 0.0
    game = s.room.area > 18 and some(s, 0.3)
    s.free_standing("ping pong table" if game else "car", (long_way, long_way + math.pi / 2), spread=0.5)
    bench = s.surely("workbench", "centre")
    if bench is None:
        s.against_wall("storage rack", "any")
    s.against_wall("bicycle", "any", gap_m=0.03)
    names = (
        "storage rack",
        "lawn mower",
        "ladder",
        "cardboard box",
        "trash can",
        "storage rack",
        "cardboard box",
        "grill",
        "suitcase",
    )
    corner_things(s, names, 5 if s.room.area > 20 else 3)
    if some(s, 0.4) and s.doors:
        s.over_opening("exit sign", s.doors[0], s.doors[0].head_m + 0.1)
    s.on_wall("dartboard", 1.4) if some(s, 0.4) else s.on_wall("poster", 1.1)
    s.under_ceiling("ceiling lamp", look=0)


def gym(s: RoomSpace) -> None:
    """Machines along the walls, a mat in the middle, a mirror."""
    machines = ("treadmill", "exercise bike", "weight bench", "dumbbell rack", "treadmill", "exercise bike")
    s.against_wall("treadmill", "any")
    for name in machines[1 : 4 if s.room.area < 14 else 6]:
        s.against_wall(name, "any")
    s.against_wall("exercise ball", "corner")
    rect = max(s.room.rects, key=lambda r: r.area)
    for dx in (0.0, 0.8, -0.8):
        s.lay("yoga mat", Pose2(rect.centre[0] + dx, rect.centre[1], 0.0)) if dx == 0.0 or some(s, 0.5) else None
    corner_things(s, ("fan", "water cooler", "bench", "speaker", "towel rack")[:4], 2)
    for _ in range(2):
        s.on_wall("mirror", 0.8, "centre", look=1)
    s.on_wall("poster", 1.2)
    s.on_wall("clock", 1.7) if some(s, 0.5) else s.on_wall("towel", 0.8)
    light(s)


def playroom(s: RoomSpace) -> None:
    """A game table or toys, music."""
    if s.room.area > 14 and some(s, 0.7):
        game = ("pool table", "ping pong table", "foosball table")[int(s.rng.integers(3))]
        if s.free_standing(game, (0.0, math.pi / 2), spread=0.3) is None:
            s.free_standing("foosball table", (0.0, math.pi / 2), spread=0.3)
    elif s.room.area > 10 and some(s, 0.5):
        s.free_standing("foosball table", (0.0, math.pi / 2), spread=0.4)
    s.against_wall("toy box", "any", front_m=0.2)
    if some(s, 0.5):
        s.against_wall("drum set", "corner")
    names = (
        "teddy bear",
        "rocking horse",
        "guitar",
        "bookshelf",
        "ottoman",
        "exercise ball",
        "globe",
        "potted plant",
        "speaker",
        "stool",
    )
    corner_things(s, names, 4)
    if some(s, 0.4):
        s.against_wall("sofa", "centre", front_m=0.2)
    x, y = s.room.centre
    s.lay("round rug" if some(s, 0.6) else "rug", Pose2(x, y, 0.0))
    s.on_wall("dartboard", 1.4) if some(s, 0.6) else s.on_wall("wall shelf", 1.4)
    s.on_wall("poster", 1.15)
    s.on_wall("poster", 1.15)
    dress_windows(s)
    light(s)


def balcony(s: RoomSpace) -> None:
    """Wicker chairs, a small table, plants, a grill."""
    look = s.taste.look("patio chair")
    chair = s.against_wall("patio chair", "far", look=look, gap_m=0.03)
    if chair is not None:
        table = s.beside(chair, "patio table", left=True, gap_m=0.05) or s.beside(chair, "patio table", left=False, gap_m=0.05)
        s.on_top(table, "flowers" if some(s, 0.5) else "teapot", at=0.0)
    s.against_wall("patio chair", "far", look=look, gap_m=0.03)
    if some(s, 0.6):
        s.against_wall("grill", "corner", gap_m=0.03)
    corner_things(s, ("potted plant", "potted plant", "bench", "umbrella stand", "bicycle"), 2)
    if s.doors and some(s, 0.6):
        door = s.doors[0]
        for side in s.sides:
            if side.along == door.along and abs(side.at - (door.y if door.along == "x" else door.x)) < 0.2:
                s.lay("doormat", Pose2(*side.point(door.x if door.along == "x" else door.y, 0.35), side.yaw_rad))
                break
