"""Noun phrases: how people call items, rooms and openings, and what each phrase then means."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.episodes.clauses import Thing
from spacevln.environments.houses.episodes.topology import Portal
from spacevln.environments.houses.plan import Item

_TABLES = (
    "coffee table",
    "console table",
    "dining table",
    "pool table",
    "side table",
    "table",
    "table tennis table",
)
_CHAIRS = ("armchair", "chair", "dining chair", "office chair", "recliner", "rocking chair")
_SHELVES = ("bookshelf", "shelf")
_PICTURES = ("painting", "picture", "poster", "framed photo")

# category: (surface noun, weight, categories that the noun may mean)
_ALIASES: dict[str, tuple[tuple[str, float, tuple[str, ...]], ...]] = {
    "sofa": (("couch", 0.75, ("sofa",)), ("sofa", 0.25, ("sofa",))),
    "dining table": (
        ("dining table", 0.5, ("dining table",)),
        ("table", 0.35, _TABLES),
        ("dining room table", 0.15, ("dining table",)),
    ),
    "coffee table": (("coffee table", 0.7, ("coffee table",)), ("table", 0.3, _TABLES)),
    "side table": (("side table", 0.4, ("side table",)), ("end table", 0.4, ("side table",)), ("table", 0.2, _TABLES)),
    "console table": (("console table", 0.5, ("console table",)), ("table", 0.5, _TABLES)),
    "table tennis table": (("ping pong table", 1.0, ("table tennis table",)),),
    "armchair": (("armchair", 0.5, ("armchair",)), ("chair", 0.5, _CHAIRS)),
    "office chair": (("office chair", 0.4, ("office chair",)), ("desk chair", 0.3, ("office chair",)), ("chair", 0.3, _CHAIRS)),
    "dining chair": (("chair", 0.7, _CHAIRS), ("dining chair", 0.3, ("dining chair",))),
    "refrigerator": (("refrigerator", 0.6, ("refrigerator",)), ("fridge", 0.4, ("refrigerator",))),
    "television": (("tv", 0.6, ("television",)), ("television", 0.4, ("television",))),
    "tv": (("tv", 0.6, ("tv",)), ("television", 0.4, ("tv",))),
    "bathtub": (("bathtub", 0.5, ("bathtub",)), ("tub", 0.5, ("bathtub",))),
    "bookshelf": (("bookshelf", 0.7, ("bookshelf",)), ("bookcase", 0.3, ("bookshelf",))),
    "bookcase": (("bookshelf", 0.6, ("bookcase", "bookshelf")), ("bookcase", 0.4, ("bookcase",))),
    "shelf": (("shelf", 0.7, _SHELVES), ("shelves", 0.3, _SHELVES)),
    "painting": (("painting", 0.65, ("painting",)), ("picture", 0.35, _PICTURES)),
    "rug": (("rug", 0.65, ("rug",)), ("carpet", 0.35, ("rug",))),
    "kitchen island": (("kitchen island", 0.6, ("kitchen island",)), ("island", 0.4, ("kitchen island",))),
    "counter": (("counter", 0.7, ("counter", "kitchen counter")), ("countertop", 0.3, ("counter", "kitchen counter"))),
    "kitchen counter": (("counter", 0.6, ("counter", "kitchen counter")), ("kitchen counter", 0.4, ("kitchen counter",))),
    "plant": (("plant", 0.6, ("plant", "potted plant")), ("potted plant", 0.4, ("plant", "potted plant"))),
    "potted plant": (("potted plant", 0.5, ("plant", "potted plant")), ("plant", 0.5, ("plant", "potted plant"))),
    "stove": (("stove", 0.8, ("stove",)), ("range", 0.2, ("stove",))),
    "floor lamp": (("floor lamp", 0.5, ("floor lamp",)), ("lamp", 0.5, ("floor lamp", "lamp", "table lamp"))),
    "wardrobe": (("wardrobe", 0.7, ("wardrobe",)), ("armoire", 0.3, ("wardrobe",))),
    "dresser": (("dresser", 0.8, ("dresser",)), ("chest of drawers", 0.2, ("dresser",))),
    "nightstand": (("nightstand", 0.7, ("nightstand",)), ("bedside table", 0.3, ("nightstand",))),
    "washing machine": (("washing machine", 0.7, ("washing machine",)), ("washer", 0.3, ("washing machine",))),
}

NEVER_LANDMARKS = frozenset(
    ("ceiling lamp", "ceiling light", "ceiling fan", "curtain", "curtains", "light switch", "book", "pillow", "railing")
)
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


def thing_for(item: Item, rng: np.random.Generator, attributes: int) -> Thing:
    """A noun phrase for an item with up to that many of its attributes."""
    name = category_of(item)
    options = _ALIASES.get(name, ((name, 1.0, (name,)),))
    weights = np.array([o[1] for o in options])
    noun, _, categories = options[int(rng.choice(len(options), p=weights / weights.sum()))]
    raw = tuple(dict.fromkeys([*categories, *(c.replace(" ", "_") for c in categories)]))
    words = tuple(w for w in item.attributes if w not in noun.split() and " " not in w)
    kept = words[:1] if attributes == 1 and rng.random() < 0.7 else words[-1:] if attributes == 1 else words[:attributes]
    return Thing(noun, raw, kept)


def thing_words(thing: Thing) -> str:
    """The noun phrase without an article."""
    return " ".join([*thing.attributes, thing.noun])


def definite(words: str) -> str:
    """With the definite article."""
    return f"the {words}"


def indefinite(words: str) -> str:
    """With the indefinite article (none before plurals)."""
    if words.endswith("shelves") or (words.endswith("drawers") is False and words.endswith("s") and not words.endswith("ss")):
        return f"some {words}"
    return f"an {words}" if words[0] in "aeiou" else f"a {words}"


def room_words(room_type: str, rng: np.random.Generator) -> str:
    """A word for a room of the type."""
    name = room_type.replace("_", " ")
    options = _ROOM_WORDS.get(name, ((name, 1.0),))
    weights = np.array([o[1] for o in options])
    return options[int(rng.choice(len(options), p=weights / weights.sum()))][0]


def portal_words(portal: Portal, rng: np.random.Generator) -> tuple[str, str]:
    """(noun, kind that it means) for a doorway or an opening."""
    if portal.kind == "opening":
        if "arched" in portal.attributes:
            return ("archway", "opening") if rng.random() < 0.7 else ("opening", "opening")
        return ("opening", "opening") if rng.random() < 0.7 else ("wide opening", "opening")
    return ("door", "doorway") if rng.random() < (0.6 if portal.leaf else 0.45) else ("doorway", "doorway")


ORDINAL_WORDS = {1: "first", 2: "second", 3: "third", 4: "fourth", 5: "fifth", -1: "last"}
SIDE_WORDS = {1: "left", -1: "right"}
