"""How often a room of a type holds a thing: what someone who looks for it may expect.

Counted on 200 development houses (seeds 0 to 199).
"""

from __future__ import annotations

from types import MappingProxyType

_TABLE = """
aquarium: living room 0.1
armchair: library 1.0, living room 0.8, bedroom 0.2, office 0.1
bar stool: kitchen 0.5
bath mat: bathroom 1.0
bathroom sink: bathroom 1.0
bathtub: bathroom 0.5
bed: bedroom 0.9
bench: hallway 0.7, gym 0.4, balcony 0.2
bicycle: garage 1.0, balcony 0.1
bookshelf: library 1.0, office 1.0, living room 0.5, playroom 0.2
cabinet: office 1.0, dining room 0.7, kitchen 0.4, bathroom 0.3, laundry room 0.2, living room 0.1
calendar: office 0.5, kitchen 0.4
candle: dining room 0.4, hallway 0.3, bedroom 0.2, living room 0.2
car: garage 0.9
cardboard box: garage 0.7, closet 0.2
ceiling fan: kitchen 0.3, bedroom 0.2, gym 0.2, library 0.2, office 0.2, living room 0.1
ceiling lamp: bathroom 1.0, closet 1.0, garage 1.0, hallway 1.0, laundry room 1.0, playroom 0.9
chandelier: dining room 1.0, library 0.5, living room 0.4
clock: kitchen 1.0, gym 0.6, hallway 0.5, living room 0.5, office 0.5
clothes rack: closet 1.0
coat rack: closet 0.3, office 0.3, hallway 0.1
coffee machine: kitchen 0.4
coffee table: living room 1.0, library 0.6
column: dining room 0.2, living room 0.2
computer monitor: office 0.6
console table: hallway 0.7, dining room 0.3
curtain: living room 0.7, dining room 0.6, bedroom 0.5, playroom 0.4, library 0.3
dartboard: playroom 0.6, garage 0.3
desk: office 1.0
desk lamp: office 0.6
dining chair: dining room 1.0, kitchen 0.4
dining table: dining room 1.0
dishwasher: kitchen 0.4
doormat: balcony 0.6
dresser: bedroom 0.8
drum set: playroom 0.4
dryer: laundry room 1.0
dumbbell rack: gym 1.0
end table: living room 0.9, library 0.5
exercise ball: gym 0.9, playroom 0.5
exercise bike: gym 1.0
exit sign: hallway 0.3, garage 0.2
fan: gym 0.3, office 0.3, bedroom 0.2, living room 0.2
filing cabinet: office 1.0
fireplace: living room 0.3
floor lamp: library 0.4, office 0.4, bedroom 0.2, dining room 0.2, living room 0.2
flowers: kitchen 0.5, balcony 0.4, dining room 0.4, living room 0.3, bedroom 0.2
foosball table: playroom 0.3
fruit bowl: kitchen 0.7, dining room 0.2, living room 0.2
globe: library 0.5, office 0.5, playroom 0.4, living room 0.3
grill: balcony 0.6, garage 0.4
guitar: living room 0.3, office 0.3, playroom 0.3, bedroom 0.2
ironing board: laundry room 0.8
kettle: kitchen 0.4
kitchen counter: kitchen 1.0
kitchen island: kitchen 0.6
kitchen sink: kitchen 1.0
ladder: garage 0.3, laundry room 0.2, library 0.2
laptop: office 0.4
laundry basket: laundry room 1.0, bathroom 0.4, bedroom 0.2
lawn mower: garage 0.4
microwave: kitchen 0.4
mirror: bathroom 0.7, gym 0.7, hallway 0.6, closet 0.5, bedroom 0.4, dining room 0.3
nightstand: bedroom 0.9
office chair: office 1.0
ottoman: playroom 0.4, bedroom 0.2, living room 0.2
painting: hallway 1.0, bedroom 0.9, dining room 0.9, office 0.9, living room 0.8, library 0.7
patio chair: balcony 1.0
patio table: balcony 0.8
ping pong table: playroom 0.2, garage 0.1
poster: gym 1.0, playroom 1.0, garage 0.7, bedroom 0.2
potted plant: living room 0.9, dining room 0.7, balcony 0.6, library 0.5, kitchen 0.4, bathroom 0.3
printer: office 0.5
radiator: hallway 0.7, bathroom 0.4, bedroom 0.2, dining room 0.2
range hood: kitchen 0.3
refrigerator: kitchen 1.0
rocking chair: bedroom 0.2
rocking horse: playroom 0.6
round rug: playroom 0.7, living room 0.2
round table: kitchen 0.4, library 0.4
rug: library 1.0, bedroom 0.9, living room 0.8, dining room 0.5, playroom 0.3
runner rug: hallway 1.0
shoe rack: closet 1.0, hallway 0.7
shower: bathroom 0.5
sofa: living room 1.0, playroom 0.1
speaker: playroom 0.5, gym 0.4, living room 0.3
statue: library 0.5, dining room 0.2, living room 0.2
stool: bathroom 0.4, kitchen 0.4, playroom 0.4
storage rack: garage 0.5, laundry room 0.1
stove: kitchen 1.0
suitcase: closet 0.6, garage 0.3, bedroom 0.2
table lamp: bedroom 0.9, living room 0.8, library 0.5, dining room 0.1
teapot: kitchen 0.5, balcony 0.4, dining room 0.4, library 0.4, living room 0.2
teddy bear: playroom 0.5, bedroom 0.2
telephone: office 0.6, hallway 0.3
toaster: kitchen 0.4
toilet: bathroom 1.0
towel: bathroom 1.0, laundry room 0.5, gym 0.3
toy box: playroom 1.0
trash can: kitchen 1.0, office 0.4, bathroom 0.3, laundry room 0.3, garage 0.2
treadmill: gym 1.0
tv: living room 0.8, bedroom 0.1
tv stand: living room 0.8
umbrella stand: balcony 0.4, hallway 0.4
vacuum cleaner: closet 0.4, laundry room 0.3
vanity table: bedroom 0.2
vase: library 0.6, dining room 0.4, hallway 0.3, bedroom 0.2, living room 0.2
wall cabinet: kitchen 0.2
wall shelf: office 0.4, playroom 0.4, bedroom 0.3
wardrobe: bedroom 0.6, closet 0.1
washing machine: laundry room 1.0
water cooler: office 0.5, gym 0.4
weight bench: gym 0.7
wine rack: dining room 0.6, kitchen 0.4
workbench: garage 1.0
yoga mat: gym 1.0
"""


def _row(line: str) -> tuple[str, dict[str, float]]:
    name, _, rooms = line.partition(":")
    pairs = (entry.strip().rpartition(" ") for entry in rooms.split(","))
    return name, {room: float(rate) for room, _, rate in pairs}


ROOMS_OF = MappingProxyType(dict(map(_row, _TABLE.strip().splitlines())))
