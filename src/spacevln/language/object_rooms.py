"""General knowledge about homes: how common each room is, what it opens on, and in which rooms an object is met."""

from __future__ import annotations

from types import MappingProxyType

from spacevln.language.grounding import head_noun
from spacevln.language.regions_lexicon import REGION_CUES

# how many of a home's rooms are of a type, before anything is seen
ROOM_SHARES = MappingProxyType(
    {
        "bedroom": 0.2,
        "bathroom": 0.16,
        "hallway": 0.14,
        "living room": 0.1,
        "kitchen": 0.09,
        "dining room": 0.08,
        "closet": 0.06,
        "office": 0.05,
        "laundry room": 0.04,
        "library": 0.02,
        "garage": 0.02,
        "gym": 0.02,
        "playroom": 0.02,
        "balcony": 0.02,
    }
)

# floor of a room that is not under furniture [m^2], typically
FREE_FLOOR_M2 = MappingProxyType(
    {
        "bedroom": 9.0,
        "bathroom": 4.0,
        "hallway": 7.0,
        "living room": 14.0,
        "kitchen": 8.0,
        "dining room": 9.0,
        "closet": 3.0,
        "office": 8.0,
        "laundry room": 5.0,
        "library": 8.0,
        "garage": 14.0,
        "gym": 9.0,
        "playroom": 9.0,
        "balcony": 4.0,
    }
)

# share of a type's rooms that lie on the lower storey of a home with two: one lives and cooks below and sleeps above
LOWER_STOREY = MappingProxyType(
    {
        "bedroom": 0.15,
        "bathroom": 0.35,
        "hallway": 0.5,
        "living room": 0.93,
        "kitchen": 0.97,
        "dining room": 0.95,
        "closet": 0.35,
        "office": 0.5,
        "laundry room": 0.65,
        "library": 0.5,
        "garage": 0.98,
        "gym": 0.5,
        "playroom": 0.4,
        "balcony": 0.5,
    }
)

# types that a home seldom has twice on one storey
SINGLE_ROOMS = frozenset(
    ("kitchen", "living room", "dining room", "laundry room", "office", "library", "garage", "gym", "playroom", "balcony")
)

# type: room number, ... ; how many rooms of a type a room of another type opens on, in tenths
_OPENS_ON = """
hallway: bedroom 15, bathroom 10, living 5, dining 5, kitchen 3, laundry 3, closet 3, office 4, library 2, gym 2, playroom 2
living: dining 5, hallway 7, kitchen 3, balcony 2, library 2, office 2, playroom 2
dining: kitchen 7, living 6, hallway 6
kitchen: dining 7, living 3, laundry 2, garage 2, hallway 4
bedroom: hallway 8, bathroom 4, closet 4, balcony 1
bathroom: hallway 7, bedroom 4
closet: bedroom 5, hallway 5
office: hallway 8, living 3, library 1
library: hallway 7, living 3
laundry: hallway 7, kitchen 3, garage 2
garage: hallway 5, kitchen 3, laundry 3
gym: hallway 9
playroom: hallway 8, living 2
balcony: living 5, bedroom 5
"""

# object: room share, ... ; the share of such rooms that hold one, in percent
_WHERE = """
aquarium: living 15, library 5, office 5
armchair: living 75, library 70, bedroom 35, office 25, hallway 10
bar stool: kitchen 45
bath mat: bathroom 85
bathroom sink: bathroom 97
bathtub: bathroom 65
bed: bedroom 95
bench: hallway 35, balcony 30, gym 30, bedroom 5
bicycle: garage 75, balcony 20
bookshelf: library 97, office 75, living 50, hallway 10, bedroom 10
bunk bed: bedroom 15
cabinet: dining 75, office 50, living 40, bathroom 30, laundry 25, hallway 15, kitchen 25
calendar: kitchen 30, office 40
candle: living 30, dining 45, bedroom 20, hallway 15
car: garage 65
cardboard box: garage 60, closet 40, storage 80
clock: kitchen 75, hallway 40, living 45, office 50, gym 45
clothes rack: closet 97
coat rack: hallway 45, closet 35, office 25
coffee maker: kitchen 55
coffee table: living 85, library 50
pillar: living 15, hallway 15, dining 15
monitor: office 60
console table: hallway 55, dining 30
crib: bedroom 15, playroom 15
dartboard: playroom 60, garage 35
desk: office 97, bedroom 10
desk lamp: office 85
dining chair: dining 95, kitchen 35
dining table: dining 85, kitchen 15
dishwasher: kitchen 75
doormat: hallway 25, balcony 50, garage 5
dresser: bedroom 85
drum set: playroom 40
dryer: laundry 80
dumbbell rack: gym 90
side table: living 80, library 60, bedroom 5
exercise ball: gym 85
exercise bike: gym 85
exit sign: hallway 35, garage 35
fan: bedroom 20, living 15, office 25, gym 45
filing cabinet: office 85
fireplace: living 40
floor lamp: living 35, bedroom 25, office 30, library 50, dining 20, hallway 12
flowers: living 30, dining 35, kitchen 35, bedroom 20, hallway 25, balcony 25
foosball table: playroom 40
bowl: kitchen 60, dining 20, living 15
globe: library 60, office 30, living 15
grill: balcony 50, garage 30
guitar: bedroom 18, living 18, office 20, playroom 40
ironing board: laundry 75, closet 30
kettle: kitchen 65
counter: kitchen 95
kitchen island: kitchen 40
kitchen sink: kitchen 95
ladder: garage 55, laundry 20, library 40
laptop: office 40
laundry basket: laundry 90, bathroom 30, bedroom 20
lawn mower: garage 50
microwave: kitchen 70
mirror: bathroom 95, gym 90, bedroom 45, hallway 35, closet 50, dining 25, living 20
nightstand: bedroom 85
office chair: office 95
ottoman: living 25, bedroom 22
painting: living 90, dining 90, hallway 90, bedroom 85, office 65, library 60
outdoor chair: balcony 95
outdoor table: balcony 70
piano: living 35, library 25, playroom 15
table tennis table: playroom 25, garage 20
pool table: playroom 30, living 12
poster: gym 80, playroom 90, garage 50, bedroom 25
plant: living 90, dining 80, hallway 60, balcony 70, office 35, bedroom 22, bathroom 30, library 35, kitchen 40
printer: office 70
radiator: bedroom 25, living 15, bathroom 35, laundry 25, hallway 25, dining 20
range hood: kitchen 85
refrigerator: kitchen 97
rocking chair: bedroom 25, playroom 10
rocking horse: playroom 45
rug: bedroom 85, living 85, dining 45, library 60, playroom 50
round rug: living 20, playroom 55
round table: kitchen 40, dining 25, library 35
runner: hallway 90
shoe rack: closet 85, hallway 35
shower: bathroom 65
sofa: living 95, playroom 35
speaker: living 18, gym 40, playroom 30
statue: living 18, hallway 15, dining 20, library 45
stool: bathroom 30, kitchen 25, playroom 20
storage rack: garage 85, laundry 25, closet 30
stove: kitchen 95
suitcase: closet 60, bedroom 20, garage 20
table lamp: bedroom 85, living 75, hallway 30, dining 25, library 60
teapot: kitchen 50, dining 35, living 15, balcony 25, library 25
plush toy: playroom 60, bedroom 15
telephone: office 55, hallway 30
toaster: kitchen 65
toilet: bathroom 97
towel: bathroom 85, gym 35, laundry 40
toy box: playroom 85
trash can: kitchen 85, bathroom 35, office 30, laundry 25, garage 30
treadmill: gym 90
television: living 90, bedroom 25, playroom 10
tv stand: living 90
umbrella stand: hallway 40, balcony 20
vacuum cleaner: laundry 35, closet 30, garage 15
vanity table: bedroom 25, closet 10
vase: living 30, dining 45, hallway 30, bedroom 20, library 30
wall cabinet: kitchen 85
wall shelf: laundry 70, bedroom 30, office 40, playroom 40
wardrobe: bedroom 75, closet 75
washing machine: laundry 95
water cooler: gym 45, office 30
weight bench: gym 80
wine rack: dining 50, kitchen 25
workbench: garage 90
yoga mat: gym 95
"""

_SHORT = {"living": "living room", "dining": "dining room", "laundry": "laundry room"}


def _parsed(table: str, unit: float) -> dict[str, dict[str, float]]:
    out = {}
    for line in table.strip().splitlines():
        name, _, places = line.partition(": ")
        pairs = (place.rsplit(" ", 1) for place in places.split(", "))
        out[_SHORT.get(name, name)] = {_SHORT.get(room, room): int(share) / unit for room, share in pairs}
    return out


OPENS_ON = MappingProxyType(_parsed(_OPENS_ON, 10))
OBJECT_ROOMS = MappingProxyType(_parsed(_WHERE, 100))
ELSEWHERE = 0.02
"""Chance that a room holds an object that is not usual there."""


def chance_in_room(phrase: str, region: str) -> float:
    """Chance that a room of a type holds an object, 0 to 1; for objects not listed, from the region cues.

    Args:
        phrase: the object in words.
        region: canonical region type.
    """
    head = head_noun(phrase)
    listed = OBJECT_ROOMS.get(" ".join(phrase.lower().split())) or OBJECT_ROOMS.get(head)
    if listed is not None:
        return max(listed.get(region, 0.0), ELSEWHERE)
    weights = {name: cues[head] for name, cues in REGION_CUES.items() if head in cues}
    if not weights:
        return 0.15
    return max(0.6 * weights.get(region, 0.0) / max(weights.values()), ELSEWHERE)
