"""How rooms of each type are furnished: the living quarters."""

from __future__ import annotations

import math

from spacevln.environments.houses.furniture.space import RoomSpace, smallest_form
from spacevln.environments.houses.furniture.walls import Pose2
from spacevln.environments.houses.plan import Item


def some(s: RoomSpace, share: float) -> bool:
    """True in this share of the cases."""
    return bool(s.rng.random() < share)


def dress_windows(s: RoomSpace, share: float = 0.7) -> None:
    """Curtains around large windows, a radiator below one of them."""
    look = s.taste.look("curtain")
    for window in s.windows:
        if window.width_m >= 1.0 and some(s, share):
            s.over_opening("curtain", window, 0.04, look)


def hang_paintings(s: RoomSpace, count: int, z: float = 1.25) -> None:
    """Paintings over low furniture first, then on free wall."""
    low = [item for item in s.items if item.solid and item.size[2] < 1.25 and item.size[0] > 0.8 and s.side_of(item)]
    for item in low[:count]:
        if s.on_wall("painting", z, above=item, lift=0.25):
            count -= 1
    for _ in range(max(0, count)):
        s.on_wall("painting", z, "centre")


def light(s: RoomSpace, grand: bool = False) -> None:
    """Something under the ceiling."""
    s.under_ceiling("chandelier" if grand else "ceiling fan" if some(s, 0.25) and s.room.area > 11 else "ceiling lamp")


def corner_things(s: RoomSpace, names: tuple[str, ...], count: int) -> None:
    """A few things of a list into corners."""
    for k in s.rng.permutation(len(names))[:count]:
        s.against_wall(names[int(k)], "corner")


def television(s: RoomSpace) -> Item | None:
    """A stand against a wall with a TV on it."""
    stand = s.against_wall("tv stand", "centre", front_m=0.3)
    s.on_top(stand, "tv", at=0.0)
    return stand


def living_room(s: RoomSpace) -> None:
    """A sofa that faces the TV or the fireplace over a coffee table on a rug."""
    hearth = s.against_wall("fireplace", "centre", front_m=0.5) if s.room.area > 17 and some(s, 0.55) else None
    focus = hearth or television(s)
    sofa = _sofa_group(s, focus) if focus else None
    if sofa is None:
        sofa = s.surely("sofa", "centre", front_m=0.4)
    if focus is None:
        focus = s.on_top(s.against_wall("tv stand", "any", tries=200, form=smallest_form("tv stand")), "tv", at=0.0)
    dress_windows(s)
    if hearth is not None and some(s, 0.8):
        television(s)
    if hearth is not None:
        s.on_wall("mirror" if some(s, 0.4) else "clock", 1.3, above=None)
    if sofa is not None:
        table = s.beside(sofa, "end table", left=True)
        s.on_top(table, "table lamp", at=0.0)
        if some(s, 0.5):
            s.beside(sofa, "end table", left=False)
    if s.room.area > 16 and some(s, 0.5):
        s.against_wall("piano", "centre", front_m=0.1)
    if some(s, 0.6):
        s.against_wall("bookshelf", "any")
    if s.room.area > 22 and some(s, 0.35):
        s.free_standing("pool table", (0.0, math.pi / 2), spread=0.8)
    if s.room.area > 18 and some(s, 0.3):
        s.against_wall("aquarium", "any")
    extras = ("potted plant", "floor lamp", "potted plant", "ottoman", "statue", "speaker", "guitar", "fan", "globe", "column")
    s.against_wall("potted plant", "door")
    corner_things(s, extras, 3 if s.room.area > 20 else 2)
    if s.room.area > 24:
        s.against_wall("armchair", "any", front_m=0.2)
        s.against_wall("cabinet", "any")
    for item in [i for i in s.items if i.category in ("coffee table", "cabinet", "end table")]:
        if some(s, 0.8):
            s.on_top(item, ("flowers", "vase", "candle", "teapot", "fruit bowl")[int(s.rng.integers(5))])
    hang_paintings(s, 3)
    if some(s, 0.4):
        s.on_wall("clock", 1.6)
    light(s, grand=some(s, 0.4))


def _sofa_group(s: RoomSpace, focus: Item) -> Item | None:
    """Sofa opposite the focus, coffee table between, armchairs at the sides, a rug below."""
    sofa_made, _ = s.make("sofa")
    table_made, _ = s.make("coffee table")
    for distance in (2.5, 2.2, 2.8, 1.9, 3.1, 1.6):
        for shift in (0.0, 0.4, -0.4):
            sofa_at = s.before(focus, sofa_made, distance, True, shift)
            against = s.wall_behind(sofa_at)
            placed = s.stand([sofa_at if against is None else against[0]])
            if placed is None:
                continue
            sofa = placed[0]
            if against is not None:
                s.remember_side(sofa, *against[1])
            table = s.stand([s.before(sofa, table_made, 0.4, False)])
            centre = table[0] if table else sofa
            s.lay(("rug", "round rug")[int(some(s, 0.2))], Pose2(centre.x, centre.y, sofa.yaw_rad))
            look = s.taste.look("armchair")
            for sign in (-1, 1):
                made, _ = s.make("armchair", look)
                reach = centre.size[0] / 2 + made.size[1] / 2 + 0.45
                at = Pose2(
                    centre.x + sign * reach * math.cos(sofa.yaw_rad), centre.y + sign * reach * math.sin(sofa.yaw_rad),
                    _quarter(sofa.yaw_rad + sign * math.pi / 2),
                )  # fmt: skip
                if some(s, 0.75):
                    s.stand([(made, at)])
            return sofa
    return None


def _quarter(angle: float) -> float:
    return (angle + math.pi) % (2 * math.pi) - math.pi


def bedroom(s: RoomSpace) -> None:
    """A bed with its head to a wall, nightstands with lamps, a wardrobe or dresser."""
    children = s.room.area < 13 and some(s, 0.3)
    bed = s.against_wall("bunk bed", "corner") if children else None
    bed = bed or s.surely("bed", "centre", front_m=0.0)
    if bed is not None and bed.category == "bed":
        look, lamp = s.taste.look("nightstand"), s.taste.look("table lamp")
        for left in (True, False):
            stand = s.beside(bed, "nightstand", left, look=look)
            s.on_top(stand, "table lamp", at=0.0, look=lamp)
        forward = bed.front_yaw_rad
        s.lay("rug", Pose2(bed.x + math.cos(forward) * 0.75, bed.y + math.sin(forward) * 0.75, bed.yaw_rad))
        s.on_wall("painting", 1.3, above=bed, lift=0.15)
    dress_windows(s, 0.6)
    if some(s, 0.75):
        s.against_wall("wardrobe", "corner", front_m=0.35)
    dresser = s.against_wall("dresser", "centre", front_m=0.35)
    if dresser is not None:
        if some(s, 0.7):
            s.on_wall("mirror", 1.05, above=dresser, lift=0.06)
        elif some(s, 0.5):
            s.on_top(dresser, "tv", at=0.0)
        s.on_top(dresser, ("flowers", "vase", "candle", "table lamp")[int(s.rng.integers(4))])
    if s.room.area > 15 and some(s, 0.6):
        s.against_wall("armchair", "corner", front_m=0.2)
    elif some(s, 0.3):
        s.against_wall("vanity table", "any", front_m=0.35)
    if children or some(s, 0.12):
        s.against_wall("teddy bear", "corner")
    if s.room.area > 12 and some(s, 0.18):
        s.against_wall("crib", "corner")
        s.against_wall("rocking chair", "any", front_m=0.2)
    names = ("potted plant", "floor lamp", "ottoman", "guitar", "laundry basket", "fan", "suitcase", "rocking chair", "radiator")
    corner_things(s, names, 2)
    hang_paintings(s, 1 if some(s, 0.7) else 2)
    if some(s, 0.25):
        s.on_wall("poster", 1.15)
    if some(s, 0.3):
        s.on_wall("wall shelf", 1.5)
    light(s)


def dining_room(s: RoomSpace) -> None:
    """A table with chairs around it, a cabinet, a chandelier."""
    table = dining_group(s, "dining table")
    if table is None:
        table = dining_group(s, "round table")
    if table is not None:
        s.on_top(table, ("flowers", "fruit bowl", "candle", "teapot", "vase")[int(s.rng.integers(5))], at=0.0)
        s.under_ceiling("chandelier", (table.x, table.y))
        if some(s, 0.5):
            s.lay("rug", Pose2(table.x, table.y, table.yaw_rad))
    dress_windows(s)
    cabinet = s.against_wall("cabinet", "centre", front_m=0.3)
    for _ in range(2):
        s.on_top(cabinet, ("vase", "teapot", "candle", "flowers", "table lamp")[int(s.rng.integers(5))])
    if some(s, 0.5):
        s.against_wall("wine rack", "any")
    if some(s, 0.35):
        s.against_wall("console table", "any")
    s.against_wall("potted plant", "door")
    corner_things(s, ("potted plant", "floor lamp", "statue", "column", "radiator"), 1)
    hang_paintings(s, 3)
    if some(s, 0.3):
        s.on_wall("mirror", 1.1)


def dining_group(s: RoomSpace, category: str) -> Item | None:
    """A table in the middle of the room with its chairs."""
    look = s.taste.look("dining chair")
    chair, _ = s.make("dining chair", look)
    made, _ = s.make(category)
    w, d = made.size[0], made.size[1]
    reach_y, reach_x = d / 2 + chair.size[1] / 2 + 0.02, w / 2 + chair.size[1] / 2 + 0.02
    sides = [(-w / 4, -reach_y, 0.0), (w / 4, -reach_y, 0.0), (-w / 4, reach_y, math.pi), (w / 4, reach_y, math.pi)]
    ends = [(-reach_x, 0.0, -math.pi / 2), (reach_x, 0.0, math.pi / 2)]
    if category == "round table":
        options = [[*ends, (0.0, -reach_y, 0.0), (0.0, reach_y, math.pi)], ends]
    else:
        options = [[*sides, *ends], sides, sides[:2]]
    rect = max(s.room.rects, key=lambda r: r.area)
    main = 0.0 if rect.width >= rect.depth else math.pi / 2
    for offsets in options:
        for x, y in s.middle_out(0.35, 0.25)[:25]:
            for yaw in (main, main + math.pi / 2):
                c, sn = math.cos(yaw), math.sin(yaw)
                group = [(made, Pose2(x, y, yaw))]
                group += [(chair, Pose2(x + c * a - sn * b, y + sn * a + c * b, _quarter(yaw + turn))) for a, b, turn in offsets]
                placed = s.stand(group)
                if placed:
                    return placed[0]
    return None


def hallway(s: RoomSpace) -> None:
    """Narrow things along the walls, landmarks near doors, a runner, pictures."""
    wide = min(min(r.width, r.depth) for r in s.room.rects) > 1.7
    things = ["console table", "potted plant", "coat rack", "bench", "shoe rack", "umbrella stand", "potted plant", "radiator"]
    if wide:
        things += ["statue", "cabinet", "bookshelf", "floor lamp", "armchair", "column"]
    count = min(7, max(2, round(s.room.area / 2.6)))
    for k in s.rng.permutation(len(things))[:count]:
        name = things[int(k)]
        item = s.against_wall(name, "door" if name in ("potted plant", "umbrella stand", "coat rack", "statue") else "any")
        if item is not None and name in ("console table", "cabinet", "bench", "shoe rack"):
            if name in ("console table", "cabinet"):
                small = ("table lamp", "vase", "flowers", "telephone", "candle")
                for pick in s.rng.permutation(len(small))[:2]:
                    s.on_top(item, small[int(pick)])
            s.on_wall("mirror" if some(s, 0.4) else "painting", 1.25, above=item, lift=0.3)
    for rect in s.room.rects:
        if min(rect.width, rect.depth) > 1.0:
            yaw = 0.0 if rect.width > rect.depth else math.pi / 2
            s.lay("runner rug", Pose2(*rect.centre, yaw))
    for _ in range(max(2, round(s.room.area / 4))):
        s.on_wall("painting", 1.3)
    if some(s, 0.4):
        s.on_wall("clock", 1.65)
    if some(s, 0.35) and s.doors:
        door = s.doors[int(s.rng.integers(len(s.doors)))]
        s.over_opening("exit sign", door, door.head_m + 0.1)
    for rect in s.room.rects:
        s.under_ceiling("ceiling lamp", rect.centre, look=0)


def library(s: RoomSpace) -> None:
    """Walls of books, a reading chair, a globe."""
    look = s.taste.look("bookshelf")
    for _ in range(max(3, int(s.room.area / 3))):
        s.against_wall("bookshelf", "any", look=look if some(s, 0.7) else None, front_m=0.3)
    chair = s.against_wall("armchair", "corner", front_m=0.2) or s.free_standing("armchair", (0.0, math.pi))
    if chair is not None:
        s.on_top(s.beside(chair, "end table", left=some(s, 0.5)), "table lamp", at=0.0)
    table = s.free_standing("coffee table" if some(s, 0.6) else "round table", (0.0, math.pi / 2))
    if table is not None:
        s.lay("rug", Pose2(table.x, table.y, table.yaw_rad))
        s.on_top(table, "vase" if some(s, 0.5) else "teapot")
    corner_things(s, ("globe", "floor lamp", "statue", "potted plant", "ladder"), 3)
    if s.room.area > 13 and some(s, 0.3):
        s.against_wall("piano", "any", front_m=0.1)
    dress_windows(s)
    hang_paintings(s, 1)
    light(s, grand=some(s, 0.5))


def office(s: RoomSpace) -> None:
    """A desk with a chair and a computer, shelves, a filing cabinet."""
    desk = desk_group(s)
    if desk is not None:
        s.on_top(desk, "computer monitor" if some(s, 0.6) else "laptop", at=-0.2)
        s.on_top(desk, "desk lamp", at=0.95, back=True)
        if some(s, 0.6):
            s.on_top(desk, "telephone", at=-0.95)
    s.against_wall("bookshelf", "any", front_m=0.2)
    filing = s.against_wall("filing cabinet", "corner", front_m=0.2)
    cabinet = s.against_wall("cabinet", "any", front_m=0.2)
    s.on_top(cabinet or filing, "printer", at=0.0)
    corner_things(s, ("potted plant", "floor lamp", "globe", "water cooler", "trash can", "coat rack", "guitar", "fan"), 3)
    if s.room.area > 12 and some(s, 0.4):
        s.against_wall("armchair", "corner", front_m=0.2)
    dress_windows(s)
    hang_paintings(s, 1)
    s.on_wall("clock", 1.6) if some(s, 0.5) else s.on_wall("calendar", 1.3)
    if some(s, 0.4):
        s.on_wall("wall shelf", 1.45)
    light(s)


def desk_group(s: RoomSpace) -> Item | None:
    """A desk against a wall with its chair."""
    made, _ = s.make("desk")
    chair, _ = s.make("office chair")
    for side, t in s.spots(made.size[0], "centre")[:40]:
        x, y = side.point(t, 0.01 + made.size[1] / 2)
        cx, cy = side.point(t, 0.03 + made.size[1] + chair.size[1] / 2)
        turn = _quarter(side.yaw_rad + math.pi)
        placed = s.stand([(made, Pose2(x, y, side.yaw_rad)), (chair, Pose2(cx, cy, turn))])
        if placed:
            s.remember_side(placed[0], side, t)
            return placed[0]
    return s.against_wall("desk", "any")
