"""Landmark nouns with their alias groups, openings, stairs, parts of things, and attribute words.

Groups follow how people vary their words for one thing in route instructions (couch and sofa, fridge and refrigerator).
The first name of a group is its canonical name.
"""

from __future__ import annotations

from types import MappingProxyType

_OBJECT_GROUPS = """
sofa: couch, loveseat, love seat, settee, sectional, couches, sofas, sectional sofa, sofa bed
armchair: arm chair, easy chair, wingback chair, accent chair, lounge chair, club chair
recliner: recliner chair
rocking chair: rocker
chair: seat, seats, armchair, recliner, rocking chair
dining chair: kitchen chair, dining room chair
office chair: desk chair, swivel chair
stool: footstool, step stool
bar stool: barstool, counter stool
bench: pew, wooden bench
ottoman: pouf, pouffe, footrest
table
dining table: dining room table, dinner table, kitchen table, breakfast table
coffee table: cocktail table
side table: end table, accent table
nightstand: night stand, bedside table, night table, bedside cabinet
console table: hall table, entry table, hallway table, entryway table
desk: writing desk, computer desk, work desk, office desk
conference table: meeting table
pool table: billiard table, billiards table, snooker table
table tennis table: ping pong table
foosball table: table football
massage table
bed: double bed, single bed, queen bed, king bed, canopy bed, twin bed, cot
bunk bed: bunk beds
crib: baby bed
dresser: chest of drawers, drawers, bureau, chest
wardrobe: armoire
cabinet: cupboard, cabinets, cupboards
kitchen cabinet: kitchen cabinets, kitchen cupboard
filing cabinet: file cabinet
china cabinet: display cabinet, display case, glass cabinet, hutch, glass display case
sideboard: buffet, credenza
bookshelf: bookcase, book shelf, book case, bookshelves, bookcases, bookshelving
shelf: shelves, shelving, shelving unit, wall shelf, rack, bookshelf
pantry shelf: food shelf
shoe rack: shoe shelf
coat rack: coat stand, coat hanger, coat hooks
clothes rack: clothing rack, garment rack, hanging clothes
clothes: clothing
television: tv, tvs, televisions, flat screen, flatscreen, tv set, television set, screen
tv stand: television stand, tv cabinet, media console, entertainment center, tv unit
projector
projector screen: projection screen
refrigerator: fridge, freezer, fridge freezer
stove: cooker, range, stove top, stovetop, cooktop, hob
oven: wall oven, ovens
microwave: microwave oven
dishwasher
kettle: electric kettle
teapot: tea pot
toaster
coffee maker: coffee machine, espresso machine
range hood: extractor hood
blender
kitchen island: island, center island, centre island, kitchen bar island
counter: countertop, counter top, counters, kitchen counter, bar counter, breakfast bar, bar, bar area
sink: washbasin, basin, wash basin, sinks
kitchen sink
bathroom sink
bathroom cabinet: medicine cabinet
vanity: bathroom vanity, sink vanity, vanity unit
vanity table: dressing table, makeup table
toilet: commode, toilets
bidet
bathtub: tub, bath, bath tub, hot tub, jacuzzi
shower: shower stall, shower cabin, shower door, shower cubicle
towel rack: towel bar, towel rail
towel: towels, bath towel
toilet paper: toilet roll
soap dispenser
bath mat
laundry basket: hamper, laundry hamper, clothes basket
washing machine: washer, clothes washer, washers
dryer: tumble dryer, clothes dryer, driers, drier
ironing board
iron
drying rack: clothes horse
water heater: boiler
mirror: mirrors, looking glass
painting: picture, paintings, pictures, artwork, art, photo, photos, photograph, portrait, framed picture, wall art
poster: posters
clock: wall clock
grandfather clock
alarm clock
lamp: lamps, light fixture
table lamp: bedside lamp
floor lamp: standing lamp
desk lamp: reading lamp
chandelier: hanging light, pendant lamp, pendant light, ceiling lamp, ceiling light
ceiling fan
fan: standing fan, pedestal fan
light switch
plant: potted plant, house plant, houseplant, plants, tree, palm, potted tree, ficus, plant pot, planter
flowers: flower, bouquet, flower pot
vase: urn, vases
candle: candles, candlestick
book: books
basket: wicker basket
rug: carpet, area rug, rugs, carpets, mat
runner: runner rug, carpet runner, hall rug
doormat: door mat, welcome mat
yoga mat: exercise mat
curtain: curtains, drapes, drape, blinds
pillow: pillows, cushion, cushions
blanket: throw, bedspread, comforter, quilt
fireplace: fire place, hearth, mantel, mantle, mantelpiece, wood stove
piano: grand piano, upright piano
drum set: drums, drum kit
guitar: guitars
easel
globe
statue: sculpture, bust, figurine, statues, sculptures
fountain: water fountain
aquarium: fish tank
computer: pc, desktop computer
monitor: computer monitor, computer screen
laptop: notebook computer
keyboard
printer: copier
whiteboard: white board, blackboard, chalkboard
telephone: phone
speaker: loudspeaker, speakers
radio
stereo: stereo system, hi-fi
radiator: heater
water cooler: water dispenser
calendar: wall calendar
dartboard: dart board
game console
arcade machine: arcade game
treadmill: running machine, treadmills
exercise bike: stationary bike, exercise bicycle, elliptical, exercise machine, exercise equipment
rowing machine: rower
weight bench: workout bench, bench press
dumbbell: dumbbells, weights, barbell
dumbbell rack: weight rack
punching bag: boxing bag
exercise ball: gym ball
bicycle: bike
car: vehicle
motorcycle: motorbike
workbench: work bench
toolbox: tool box, tool chest
tool rack: pegboard, tool board
ladder: stepladder
tire: tyre, tires
lawn mower: mower
broom: mop
bucket
vacuum cleaner: vacuum, hoover
trash can: garbage can, bin, waste bin, trash bin, wastebasket, rubbish bin, dustbin
cardboard box: box, boxes, carton
crate: crates
storage rack: storage shelf, metal shelf
suitcase: luggage, suitcases
backpack: rucksack, bag
umbrella stand: umbrella
shoes: shoe, boots
hanger
toy: toys
toy box: toy chest
plush toy: teddy bear, stuffed animal, stuffed toy
dollhouse: doll house
rocking horse
building blocks: blocks
ball
wine rack: wine shelf
bottle: bottles
bowl: fruit bowl
jar: jars
cup: mug
plate: plates
pot: saucepan, pots
pan: frying pan
grill: barbecue, bbq
parasol: beach umbrella
sun lounger: lounger, chaise lounge, chaise, deck chair, chaise longue
outdoor chair: patio chair, garden chair
outdoor table: patio table, garden table
hammock
railing: banister, bannister, rail, handrail, hand rail, railings, balustrade
pillar: column, columns, pillars, post, beam, posts
window: windows, picture window
divider: room divider, partition, screen divider
elevator: lift
exit sign: sign, signs
locker: lockers
altar: podium
pool: swimming pool
rope: ropes, stanchions
wall: walls, half wall
floor: tile, tiles, flooring, hardwood floor, tile floor
ceiling: ceilings
furniture
people: person, man, woman
"""

_OPENING_GROUPS = """
doorway: door, doors, doorways, door way, doorframe, door frame, threshold, double doors, double door
doorway: french doors, french door, glass door, glass doors
doorway: sliding door, sliding doors, sliding glass door, sliding glass doors, front door
doorway: entrance door, entrance, entrances, entry, entry door, exit, door opening, door threshold, gate
opening: open passage, openings, gap, pass through, passthrough, wide opening, cased opening
archway: arch, arches, archways, arched doorway, arched opening, arch way
"""

_STAIRS_GROUPS = """
stairs: staircase, stairway, stair, stairwell, steps, step, flight of stairs, set of stairs, stair case
stairs: spiral staircase, staircases, stairways, flight, flights
"""

GENERIC_SPACES = (
    "room",
    "rooms",
    "area",
    "space",
    "areas",
    "next room",
    "main room",
    "section",
    "house",
    "home",
    "building",
    "place",
    "open area",
    "open space",
    "outside",
    "outdoors",
    "inside",
)

PARTS = (
    "end",
    "top",
    "bottom",
    "foot",
    "base",
    "middle",
    "center",
    "centre",
    "edge",
    "side",
    "corner",
    "head",
    "back",
    "front",
    "start",
    "beginning",
    "other side",
    "other end",
    "far end",
    "far side",
    "right side",
    "left side",
    "right",
    "left",
    "landing",
)

COLOURS = (
    "white",
    "black",
    "red",
    "blue",
    "green",
    "yellow",
    "brown",
    "grey",
    "gray",
    "beige",
    "cream",
    "tan",
    "orange",
    "purple",
    "pink",
    "gold",
    "golden",
    "silver",
    "dark",
    "light",
    "teal",
    "turquoise",
    "navy",
    "maroon",
    "ivory",
    "charcoal",
    "olive",
    "burgundy",
    "mint",
    "dark brown",
    "light brown",
    "dark blue",
    "light blue",
    "dark green",
    "colorful",
    "colored",
)
MATERIALS = (
    "wooden",
    "wood",
    "leather",
    "glass",
    "metal",
    "marble",
    "stone",
    "brick",
    "wicker",
    "brass",
    "steel",
    "stainless",
    "tiled",
    "tile",
    "fabric",
    "plastic",
    "velvet",
    "granite",
    "hardwood",
    "concrete",
    "oak",
    "walnut",
    "pine",
    "bamboo",
    "rattan",
    "ceramic",
    "iron",
    "cardboard",
    "linen",
    "chrome",
    "copper",
    "carpeted",
)
SIZES = (
    "large",
    "small",
    "big",
    "long",
    "short",
    "tall",
    "narrow",
    "little",
    "wide",
    "huge",
    "tiny",
    "low",
    "high",
    "thin",
    "single",
    "giant",
)
SHAPES = (
    "round",
    "square",
    "circular",
    "oval",
    "rectangular",
    "arched",
    "curved",
    "shaped",
    "l-shaped",
    "striped",
    "floral",
    "patterned",
    "checkered",
    "spiral",
    "geometric",
    "oriental",
    "cylindrical",
)
STATES = (
    "open",
    "opened",
    "closed",
    "double",
    "empty",
    "framed",
    "potted",
    "rocking",
    "sliding",
    "main",
    "hanging",
    "covered",
    "ornate",
    "fancy",
    "modern",
    "antique",
    "old",
    "new",
    "front",
    "nearest",
    "closest",
    "farthest",
    "furthest",
    "same",
    "other",
    "opposite",
    "far",
    "another",
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "last",
    "next",
    "final",
    "middle",
    "center",
    "left",
    "right",
    "two",
    "three",
    "four",
    "both",
    "several",
    "walk-in",
    "grand",
    "spare",
    "adjacent",
    "adjoining",
    "upholstered",
    "padded",
    "decorative",
    "immediate",
    "glazed",
    "lit",
    "pair",
    "set",
    "row",
    "few",
    "couple",
    "second-floor",
    "upper",
    "lower",
    "comfy",
    "master",
    "guest",
    "facing",
    "tufted",
    "free-standing",
)
ORDINALS = MappingProxyType(
    {
        "first": 1,
        "1st": 1,
        "second": 2,
        "2nd": 2,
        "third": 3,
        "3rd": 3,
        "fourth": 4,
        "4th": 4,
        "fifth": 5,
        "5th": 5,
        "sixth": 6,
        "last": -1,
        "final": -1,
    }
)
DIGIT_WORDS = MappingProxyType(
    {
        "one": 1,
        "two": 2,
        "three": 3,
        "four": 4,
        "five": 5,
        "six": 6,
        "seven": 7,
        "eight": 8,
        "nine": 9,
        "ten": 10,
        "couple": 2,
        "few": 3,
    }
)


def _groups(table: str) -> dict[str, tuple[str, ...]]:
    groups: dict[str, tuple[str, ...]] = {}
    for line in table.strip().splitlines():
        name, _, rest = line.partition(":")
        groups[name] = (*groups.get(name, ()), *(alias.strip() for alias in rest.split(",") if alias.strip()))
    return groups


OBJECTS = MappingProxyType(_groups(_OBJECT_GROUPS))
OPENINGS = MappingProxyType(_groups(_OPENING_GROUPS))
STAIRS = MappingProxyType(_groups(_STAIRS_GROUPS))
