"""Noun phrases: how people call items, rooms and openings, and what each phrase then means."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.episodes.clauses import Thing
from spacevln.environments.houses.episodes.topology import Portal
from spacevln.environments.houses.episodes.unnamed import NEVER_LANDMARKS
from spacevln.environments.houses.plan import Item

_TABLES = (
    "coffee table",
    "console table",
    "dining table",
    "end table",
    "patio table",
    "ping pong table",
    "pool table",
    "round table",
    "foosball table",
)
_CHAIRS = ("armchair", "dining chair", "office chair", "patio chair", "rocking chair")
_RUGS = ("rug", "runner rug", "round rug")
_LAMPS = ("desk lamp", "floor lamp", "table lamp")
_SINKS = ("bathroom sink", "kitchen sink")
_PICTURES = ("painting", "poster")
_SHELVES = ("bookshelf", "storage rack", "wall shelf")

_Names = tuple[tuple[str, float, tuple[str, ...]], ...]
# category: (surface noun, weight, categories that the noun may mean)
_ALIASES: dict[str, _Names] = {
    "armchair": (("armchair", 0.45, ("armchair",)), ("chair", 0.55, _CHAIRS)),
    "bath mat": (("bath mat", 0.5, ("bath mat",)), ("mat", 0.5, ("bath mat", "doormat", "yoga mat"))),
    "bathroom sink": (("sink", 0.9, _SINKS), ("bathroom sink", 0.1, ("bathroom sink",))),
    "bathtub": (("bathtub", 0.5, ("bathtub",)), ("tub", 0.5, ("bathtub",))),
    "bookshelf": (("bookshelf", 0.6, ("bookshelf",)), ("bookcase", 0.3, ("bookshelf",)), ("shelf", 0.1, _SHELVES)),
    "coffee table": (("coffee table", 0.6, ("coffee table",)), ("table", 0.4, _TABLES)),
    "column": (("pillar", 0.6, ("column",)), ("column", 0.4, ("column",))),
    "console table": (("console table", 0.35, ("console table",)), ("table", 0.65, _TABLES)),
    "dining chair": (("chair", 0.8, _CHAIRS), ("dining chair", 0.2, ("dining chair",))),
    "dining table": (
        ("dining table", 0.4, ("dining table",)),
        ("dining room table", 0.2, ("dining table",)),
        ("table", 0.4, _TABLES),
    ),
    "dresser": (("dresser", 0.85, ("dresser",)), ("chest of drawers", 0.15, ("dresser",))),
    "end table": (("end table", 0.7, ("end table",)), ("table", 0.3, _TABLES)),
    "floor lamp": (("floor lamp", 0.4, ("floor lamp",)), ("lamp", 0.6, _LAMPS)),
    "kitchen counter": (("counter", 0.6, ("kitchen counter",)), ("kitchen counter", 0.4, ("kitchen counter",))),
    "kitchen island": (("kitchen island", 0.6, ("kitchen island",)), ("island", 0.4, ("kitchen island",))),
    "kitchen sink": (("sink", 0.8, _SINKS), ("kitchen sink", 0.2, ("kitchen sink",))),
    "nightstand": (("nightstand", 0.7, ("nightstand",)), ("bedside table", 0.3, ("nightstand",))),
    "office chair": (("office chair", 0.3, ("office chair",)), ("desk chair", 0.3, ("office chair",)), ("chair", 0.4, _CHAIRS)),
    "painting": (("painting", 0.6, ("painting",)), ("picture", 0.4, _PICTURES)),
    "patio chair": (("patio chair", 0.4, ("patio chair",)), ("chair", 0.6, _CHAIRS)),
    "patio table": (("patio table", 0.5, ("patio table",)), ("table", 0.5, _TABLES)),
    "potted plant": (("potted plant", 0.45, ("potted plant",)), ("plant", 0.55, ("potted plant",))),
    "refrigerator": (("refrigerator", 0.6, ("refrigerator",)), ("fridge", 0.4, ("refrigerator",))),
    "round rug": (("round rug", 0.6, ("round rug",)), ("rug", 0.4, _RUGS)),
    "round table": (("round table", 0.6, ("round table",)), ("table", 0.4, _TABLES)),
    "rug": (("rug", 0.65, _RUGS), ("carpet", 0.35, _RUGS)),
    "runner rug": (("rug", 0.6, _RUGS), ("runner", 0.2, ("runner rug",)), ("carpet", 0.2, _RUGS)),
    "sofa": (("couch", 0.78, ("sofa",)), ("sofa", 0.22, ("sofa",))),
    "statue": (("statue", 0.6, ("statue",)), ("sculpture", 0.4, ("statue",))),
    "table lamp": (("lamp", 0.8, _LAMPS), ("table lamp", 0.2, ("table lamp",))),
    "tv": (("tv", 0.6, ("tv",)), ("television", 0.4, ("tv",))),
    "wall shelf": (("shelf", 0.7, _SHELVES), ("wall shelf", 0.3, ("wall shelf",))),
    "wardrobe": (("wardrobe", 0.7, ("wardrobe",)), ("armoire", 0.3, ("wardrobe",))),
    "washing machine": (("washing machine", 0.7, ("washing machine",)), ("washer", 0.3, ("washing machine",))),
}
# how readily people mention a category that they pass, 1 where not listed
_SALIENCE = {
    "armchair": 1.5, "bath mat": 0.4, "bathroom sink": 1.6, "bed": 3.0, "bookshelf": 1.6, "bunk bed": 2.0, "cabinet": 0.8,
    "calendar": 0.2,
    "clock": 0.4, "coffee table": 1.5, "desk": 2.0, "desk lamp": 0.2, "dining chair": 0.8, "dining table": 3.0, "fireplace": 3.0,
    "flowers": 0.4, "kitchen counter": 1.5, "kitchen island": 2.5, "laundry basket": 0.4, "mirror": 0.8, "nightstand": 0.5,
    "painting": 0.45, "piano": 3.0, "pool table": 3.0, "poster": 0.3, "potted plant": 0.8, "radiator": 0.4, "refrigerator": 2.0,
    "sofa": 3.0, "statue": 1.5, "stove": 1.6, "table lamp": 0.3, "toilet": 1.3, "towel": 0.25, "trash can": 0.4,
    "wall cabinet": 0.3, "wall shelf": 0.3,
}  # fmt: skip
_PLURALS = {
    "chair": "chairs",
    "dining chair": "dining chairs",
    "patio chair": "patio chairs",
    "bar stool": "bar stools",
    "stool": "stools",
}
FLAT = frozenset(("bath mat", "doormat", "round rug", "rug", "runner rug", "yoga mat"))

MIN_SIZE_M = 0.35
MAX_BASE_M = 1.6

_ROOM_WORDS: dict[str, tuple[tuple[str, float], ...]] = {
    "hallway": (("hallway", 0.66), ("hall", 0.3), ("corridor", 0.04)),
    "living room": (("living room", 0.85), ("living area", 0.15)),
    "dining room": (("dining room", 0.85), ("dining area", 0.15)),
    "kitchen": (("kitchen", 0.93), ("kitchen area", 0.07)),
    "bathroom": (("bathroom", 0.96), ("restroom", 0.04)),
    "office": (("office", 0.8), ("study", 0.2)),
    "closet": (("closet", 0.85), ("walk-in closet", 0.15)),
    "laundry room": (("laundry room", 0.9), ("laundry area", 0.1)),
    "gym": (("gym", 0.5), ("exercise room", 0.5)),
    "playroom": (("playroom", 0.8), ("play room", 0.2)),
}


def category_of(item: Item) -> str:
    """The category in words."""
    return item.category.replace("_", " ")


def is_landmark(item: Item, floor_z_m: float) -> bool:
    """Whether an item is large and low enough to be mentioned."""
    if category_of(item) in NEVER_LANDMARKS or item.z - floor_z_m > MAX_BASE_M:
        return False
    return max(item.size) >= MIN_SIZE_M and (item.support is None or max(item.size) >= 0.45)


def salience(item: Item) -> float:
    """How readily people mention an item that they pass."""
    return _SALIENCE.get(category_of(item), 1.0)


def thing_for(item: Item, rng: np.random.Generator, attributes: int, crowded: bool = False) -> Thing:
    """A noun phrase for an item with up to that many of its attributes; plural for one of several seats."""
    name = category_of(item)
    options = _ALIASES.get(name, ((name, 1.0, (name,)),))
    weights = np.array([o[1] for o in options])
    noun, _, categories = options[int(rng.choice(len(options), p=weights / weights.sum()))]
    if crowded:
        noun = _PLURALS.get(noun, noun)
    words = tuple(w for w in item.attributes if w not in noun.split() and " " not in w)
    kept = words[:1] if attributes == 1 and rng.random() < 0.7 else words[-1:] if attributes == 1 else words[:attributes]
    return Thing(noun, categories, kept)


def thing_words(thing: Thing) -> str:
    """The noun phrase without an article."""
    return " ".join([*thing.attributes, thing.noun])


def definite(words: str) -> str:
    """With the definite article."""
    return f"the {words}"


def is_plural(words: str) -> bool:
    """Whether a noun phrase is plural."""
    return words.endswith("s") and not words.endswith(("ss", "drawers"))


def indefinite(words: str) -> str:
    """With the indefinite article."""
    if is_plural(words):
        return f"some {words}"
    return f"an {words}" if words[0] in "aeiou" else f"a {words}"


def room_words(room_type: str, rng: np.random.Generator) -> str:
    """A word for a room of the type."""
    name = room_type.replace("_", " ")
    options = _ROOM_WORDS.get(name, ((name, 1.0),))
    weights = np.array([o[1] for o in options])
    return options[int(rng.choice(len(options), p=weights / weights.sum()))][0]


def room_type_of(words: str) -> str:
    """The type that a word for a room means."""
    return next((name for name, options in _ROOM_WORDS.items() if any(word == words for word, _ in options)), words)


def portal_words(portal: Portal, rng: np.random.Generator) -> tuple[str, str]:
    """(noun, kind that it means) for a doorway or an opening."""
    if portal.kind == "opening":
        if "arched" in portal.attributes:
            return ("archway", "opening") if rng.random() < 0.7 else ("opening", "opening")
        return ("opening", "opening") if rng.random() < 0.7 else ("wide opening", "opening")
    return ("door", "doorway") if rng.random() < (0.6 if portal.leaf else 0.45) else ("doorway", "doorway")


ORDINAL_WORDS = {1: "first", 2: "second", 3: "third", 4: "fourth", 5: "fifth", -1: "last"}
SIDE_WORDS = {1: "left", -1: "right"}
