"""Noun phrases of a route instruction: head, attributes, ordinal, side, and the thing they are attached to."""

from __future__ import annotations

from dataclasses import dataclass, replace

from spacevln.language import nouns_lexicon as nouns
from spacevln.language.grounding import _GREY
from spacevln.language.regions_lexicon import REGION_ALIASES
from spacevln.language.vocabulary import ADJECTIVES, ATTRIBUTES, NounKind, Term, match

DETERMINERS = frozenset(
    {"the", "a", "an", "your", "this", "that", "these", "those", "another", "some", "its", "any", "each", "every"}
)
FUNCTION_WORDS = DETERMINERS | frozenset(
    [
        "and",
        "or",
        "then",
        "to",
        "into",
        "onto",
        "in",
        "on",
        "at",
        "by",
        "near",
        "of",
        "off",
        "out",
        "up",
        "down",
        "over",
        "under",
        "through",
        "past",
        "along",
        "across",
        "around",
        "between",
        "behind",
        "before",
        "after",
        "until",
        "till",
        "once",
        "when",
        "while",
        "as",
        "if",
        "so",
        "with",
        "without",
        "toward",
        "towards",
        "from",
        "for",
        "is",
        "are",
        "be",
        "will",
        "would",
        "you",
        "your",
        "it",
        "them",
        "there",
        "here",
        "turn",
        "walk",
        "go",
        "head",
        "move",
        "stop",
        "wait",
        "stand",
        "exit",
        "leave",
        "enter",
        "continue",
        "proceed",
        "keep",
        "take",
        "make",
        "pass",
        "follow",
        "cross",
        "climb",
        "ascend",
        "descend",
        "straight",
        "forward",
        "ahead",
        "left",
        "right",
        "back",
        "beside",
        "next",
        "inside",
        "outside",
        "reach",
        "get",
        "see",
        "face",
        "facing",
        "hang",
        "veer",
        "bear",
        "step",
        "come",
        "but",
        "not",
        "n't",
        "that",
        "which",
        "where",
        "directly",
        "slightly",
        "immediately",
        "just",
        "only",
        "slight",
        "sharp",
        "sharply",
        "hard",
        "quick",
        "gentle",
        "bit",
        "degree",
        "degrees",
        "all",
        "way",
        "beyond",
        "toward",
        "against",
        "opposite",
        "until",
    ]
)
# nouns that are verbs or adverbs as often: read as nouns only after a determiner or an adjective
_AMBIGUOUS = frozenset(
    [
        "exit",
        "entry",
        "step",
        "steps",
        "head",
        "face",
        "light",
        "top",
        "end",
        "back",
        "front",
        "left",
        "right",
        "post",
        "seat",
        "rack",
        "range",
        "throw",
        "iron",
        "bin",
        "phone",
        "pass",
        "landing",
        "start",
        "side",
        "screen",
        "rail",
        "bar",
        "foot",
        "base",
        "middle",
        "center",
        "edge",
        "flight",
        "lift",
        "sign",
        "floor",
        "tile",
        "inside",
        "outside",
        "outdoors",
        "living",
        "art",
        "bath",
        "fan",
        "photo",
    ]
)
_OPENING_LINKS = (
    ("that", "leads", "into"),
    ("that", "leads", "to"),
    ("which", "leads", "to"),
    ("leading", "into"),
    ("leading", "out", "to"),
    ("leading", "to"),
    ("that", "goes", "to"),
    ("that", "goes", "into"),
    ("that", "opens", "to"),
    ("that", "leads", "out", "to"),
    ("that", "opens", "into"),
    ("leading", "toward"),
    ("leading", "towards"),
    ("into",),
    ("to",),
    ("for",),
    ("of",),
)
_LINKS = (
    ("in", "front", "of"),
    ("across", "from"),
    ("to", "the", "left", "of"),
    ("to", "the", "right", "of"),
    ("next", "to"),
    ("on", "the", "left", "side", "of"),
    ("on", "the", "right", "side", "of"),
    ("on", "the", "left", "of"),
    ("on", "the", "right", "of"),
    ("at", "the", "end", "of"),
    ("close", "to"),
    ("left", "of"),
    ("right", "of"),
    ("of",),
    ("with",),
    ("beside",),
    ("near",),
    ("opposite",),
    ("behind",),
    ("against",),
    ("by",),
    ("under",),
    ("between",),
)
_SIDE_LEADS = (
    ("on", "the"),
    ("on", "your"),
    ("to", "the"),
    ("to", "your"),
    ("at", "your"),
    ("at", "the"),
    ("on", "its"),
    ("off", "to", "the"),
    ("over", "on", "the"),
    ("on", "the", "far"),
    ("on", "the", "immediate"),
    ("to", "the", "far"),
    ("on", "the", "opposite"),
    ("on",),
    ("that", "is", "on", "the"),
    ("that", "is", "on", "your"),
    ("is", "on", "the"),
    ("is", "on", "your"),
    ("will", "be", "on", "your"),
    ("will", "be", "on", "the"),
    ("that", "is", "to", "the"),
    ("that", "is", "to", "your"),
    ("located", "on", "the"),
    ("located", "on", "your"),
    ("that", "are", "on", "the"),
    ("that", "are", "on", "your"),
    ("immediately", "to", "the"),
    ("immediately", "to", "your"),
)
_AHEAD = (
    ("in", "front", "of", "you"),
    ("straight", "ahead", "of", "you"),
    ("ahead", "of", "you"),
    ("directly", "in", "front", "of", "you"),
    ("directly", "ahead"),
    ("straight", "ahead"),
    ("that", "is", "in", "front", "of", "you"),
)


@dataclass(frozen=True, slots=True)
class NounPhrase:
    """A thing or place that an instruction names.

    Args:
        text: as written, without its post-modifiers.
        head: canonical head noun; for a region its type.
        kind: what sort of noun.
        attributes: colour, material, size and shape words.
        ordinal: 1 for "first" ...; -1 for "last"; 0 for none.
        side: ``"left"``, ``"right"``, ``"ahead"``, ``"behind"`` or ``""`` ("the door on your left").
        part: ``"end"``, ``"top"`` ... when a part of it is meant.
        link, of: the thing it is attached to ("the door **to** the **bedroom**", "the table **next to** the **bed**").
        also: a second, coordinated thing ("between the sofa and the table").
    """

    text: str
    head: str
    kind: NounKind
    attributes: tuple[str, ...] = ()
    ordinal: int = 0
    side: str = ""
    part: str = ""
    link: str = ""
    of: NounPhrase | None = None
    also: NounPhrase | None = None
    other: bool = False

    @property
    def region(self) -> str:
        """The region type it names, also through "the bedroom door"; ``""`` for none."""
        if self.kind is NounKind.REGION:
            return self.head
        if self.kind is NounKind.OPENING and self.of is not None and self.of.kind is NounKind.REGION:
            return self.of.head
        return ""

    @property
    def phrase(self) -> str:
        """Attributes and head: what a detector should look for."""
        return " ".join((*self.attributes, self.head))


def _starts(words: list[str], at: int, options: tuple[tuple[str, ...], ...]) -> int:
    """Length of the longest option that begins at ``at``, 0 for none."""
    return max((len(option) for option in options if tuple(words[at : at + len(option)]) == option), default=0)


def _modifiers(words: list[str], i: int) -> tuple[int, list[str], int, str, bool]:
    """Adjectives and ordinals from ``i``: next index, attributes, ordinal, side, whether "other" or "another" was among them."""
    attributes: list[str] = []
    ordinal, side, other = 0, "", False
    while i < len(words):
        hit = match(words, i)
        # a longer name that begins with this adjective wins: "double doors", "front door", "open area"
        if hit is not None and (hit[1] > i + 1 or words[i] not in ADJECTIVES):
            break
        word = words[i]
        if word in nouns.ORDINALS:
            ordinal = nouns.ORDINALS[word]
        elif (
            word in ("left", "right")
            and i + 1 < len(words)
            and (words[i + 1] == "hand" or words[i + 1] in ADJECTIVES or match(words, i + 1))
        ):
            if words[i + 1] in ("side", "of"):
                break
            side = word
        elif word in ("other", "another", "opposite"):
            other = True
        elif word in ATTRIBUTES:
            attributes.append(_GREY.get(word, word))
        elif (word not in ADJECTIVES and word not in ("hand", "very", "most", "more", "of")) or (
            word == "of" and (i == 0 or words[i - 1] not in ("set", "pair", "row", "couple", "flight", "sets"))
        ):
            break
        i += 1
    return i, attributes, ordinal, side, other


def _is_unknown(words: list[str], j: int) -> bool:
    return words[j] not in FUNCTION_WORDS and words[j][0].isalnum() and match(words, j) is None


def _head(words: list[str], i: int, determined: bool) -> tuple[Term, int, str] | None:
    """The head noun from ``i``: term, next index, and the region of a compound such as "bathroom door"."""
    hit = match(words, i)
    if hit is None and not determined:
        return None
    if hit is None:  # after an article: up to three unknown words, then perhaps a known noun
        j = i
        while j < len(words) and j < i + 3 and _is_unknown(words, j):
            j += 1
        hit = match(words, j) if i < j < len(words) and words[j] not in FUNCTION_WORDS else None
        if hit is None:
            return (Term(" ".join(words[i:j]), NounKind.OBJECT), j, "") if j > i else None
    region = ""
    term, j = hit
    if j == i + 1 and words[i] in _AMBIGUOUS and not determined:
        return None
    while j < len(words) and words[j] not in ("left", "right", "back", "inside", "outside", "exit", "face", "head"):
        following = match(words, j)
        if following is None or following[0].kind is NounKind.PART:
            break
        region = term.name if term.kind is NounKind.REGION else region
        term, j = following
    return term, j, region if term.kind is NounKind.OPENING else ""


def _side_after(words: list[str], i: int) -> tuple[str, int]:
    """A side after a noun: "on your left", "to the right", "straight ahead"; and the index after it."""
    length = _starts(words, i, _AHEAD)
    if length:
        return "ahead", i + length
    if words[i : i + 2] == ["behind", "you"]:
        return "behind", i + 2
    if i < len(words) and words[i] == "ahead":
        return "ahead", i + 1
    j = i + (1 if i < len(words) and words[i] in ("immediately", "directly", "just") else 0)
    length = _starts(words, j, _SIDE_LEADS)
    if length and j + length < len(words) and words[j + length] in ("left", "right"):
        side, k = words[j + length], j + length + 1
        if words[k : k + 1] == ["hand"]:
            k += 1
        if words[k : k + 1] == ["side"]:
            k += 1
        if words[k : k + 1] != ["of"]:
            return side, k
    return "", i


def _attach(words: list[str], i: int, phrase: NounPhrase, depth: int) -> tuple[NounPhrase, int]:
    """Post-modifiers of a noun phrase."""
    while i < len(words):
        side, j = _side_after(words, i)
        if side:
            phrase, i = replace(phrase, side=phrase.side or side), j
            continue
        if phrase.of is not None or depth >= 2:
            break
        links = _OPENING_LINKS + _LINKS if phrase.kind in (NounKind.OPENING, NounKind.STAIRS) else _LINKS
        length = _starts(words, i, links)
        if not length:
            break
        inner = noun_phrase(words, i + length, depth + 1)
        if inner is None or (words[i] in ("to", "into") and inner[0].kind is NounKind.PART):
            break
        phrase, i = replace(phrase, link=" ".join(words[i : i + length]), of=inner[0]), inner[1]
    return phrase, i


def _whole(phrase: NounPhrase) -> NounPhrase:
    """``the end of the hallway`` is the hallway, with a part."""
    if phrase.kind is NounKind.PART and phrase.of is not None and phrase.link in ("of", "left of", "right of"):
        return replace(phrase.of, part=phrase.head, side=phrase.side or phrase.of.side)
    return phrase


def noun_phrase(words: list[str], start: int, depth: int = 0) -> tuple[NounPhrase, int] | None:
    """The noun phrase that begins at ``start`` and the index after it; None when there is none."""
    i = start
    determined = i < len(words) and words[i] in DETERMINERS
    another = determined and words[i] == "another"
    while i < len(words) and (words[i] in DETERMINERS or words[i : i + 2] in (["all", "the"], ["both", "the"])):
        i += 1
    after_determiner = i
    i, attributes, ordinal, side, other = _modifiers(words, i)
    head = _head(words, i, determined or i > after_determiner)
    if head is None:
        return None
    term, end, region = head
    if term.kind is NounKind.PART and not determined:
        return None
    if term.kind is NounKind.PART and term.name in ("left", "right") and words[end : end + 1] != ["of"]:
        return None
    phrase = NounPhrase(
        text=" ".join(words[after_determiner:end]),
        head=term.name,
        kind=term.kind,
        attributes=tuple(attributes),
        ordinal=ordinal,
        side=side,
        other=other or another,
    )
    if region and region in REGION_ALIASES:
        phrase = replace(phrase, link="to", of=NounPhrase(region, region, NounKind.REGION))
    phrase, end = _attach(words, end, phrase, depth)
    if depth == 0 and words[end : end + 1] in (["and"], ["or"]) and words[end + 1 : end + 2] != ["exit"]:
        second = noun_phrase(words, end + 1, 2)
        if second is not None and words[end + 1] not in ("left", "right"):
            phrase, end = replace(phrase, also=_whole(second[0])), second[1]
    return _whole(phrase), end
