"""The clause parser: a route instruction as a sequence of typed clauses with slots.

The words are first reduced to a line in which every noun phrase is one token (``walk past N0 and turn left at N1 .``); a lexer of
clause patterns then reads that line from left to right. Both passes are linear in the length of the text.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from spacevln.language.grammar import FILLERS, MARKS, RULES, SPELLING, STEPS, ClauseType
from spacevln.language.grammar import ClauseType as T
from spacevln.language.nouns_lexicon import DIGIT_WORDS, ORDINALS
from spacevln.language.phrases import NounPhrase, noun_phrase
from spacevln.language.vocabulary import NounKind, words_of


@dataclass(frozen=True, slots=True)
class Clause:
    """One typed clause.

    Args:
        type: what it asks for.
        text: the words it was read from.
        place: the thing or space it names.
        side: of a turn: ``"left"``, ``"right"`` or ``""``.
        relation: how the end of the move or the turn relates to the place: ``"next to"``, ``"in front of"``, ``"before"`` ...
        degree: of a turn ``"slight"`` or ``"sharp"``, of a move ``"straight"``; or ``""``.
        vertical: ``"up"``, ``"down"`` or ``""``.
        ordinal: of a turn ("the second left"), or of a step.
        distance_m: a stated distance.
    """

    type: ClauseType
    text: str
    place: NounPhrase | None = None
    side: str = ""
    relation: str = ""
    degree: str = ""
    vertical: str = ""
    ordinal: int = 0
    distance_m: float | None = None


MAX_WORDS = 4000
AFTER_RIGHT = ("around", "before", "past", "there", "outside", "inside", "next", "where")
BEFORE_A_SIDE = ("turn", "a", "the", "your", "go", "take", "bear", "veer", "immediate", "hang", "first", "second")


def _words(text: str) -> list[str]:
    words: list[str] = []
    for word in words_of(text):
        word = SPELLING.get(word, word)
        if word in FILLERS:
            continue
        if word == "right" and words and words[-1] in ("is", "stop", "wait"):
            continue
        if word == "of" and words and words[-1] in ("past", "pass", "through", "by", "along"):
            continue  # "past all of the chairs"
        adverb = len(words) < 2 or words[-2] not in BEFORE_A_SIDE
        if word in AFTER_RIGHT and words and words[-1] == "right" and adverb:
            words.pop()  # "right past the sofa": no side
        words.append(word)
        if len(words) >= MAX_WORDS:
            break
    return words


def _reduce(words: list[str]) -> tuple[str, list[NounPhrase], list[float]]:
    """The line of tokens, the noun phrases N0 .. (S0 .. for stairs), and the stated distances D0 .."""
    line: list[str] = []
    phrases: list[NounPhrase] = []
    distances: list[float] = []
    i = 0
    while i < len(words):
        word = words[i]
        if word in MARKS:
            line.append(MARKS[word])
            i += 1
            continue
        number = DIGIT_WORDS.get(word) or (int(word) if word.isdigit() and len(word) < 4 else 0)
        j = i + 1
        while number and words[j : j + 1] in (["of"], ["more"], ["or"], ["three"], ["four"], ["small"], ["few"]):
            j += 1
        before = line[-1] if line else ""
        if number and words[j : j + 1] and words[j] in STEPS and before not in ("at", "on", "the"):
            vertical = words[j] in ("steps", "step") and (
                before in ("up", "down", "climb", "descend") or words[j + 1 : j + 2] in (["up"], ["down"])
            )
            if not vertical:
                line.append(f"D{len(distances)}")
                distances.append(number * STEPS[words[j]])
                i = j + 1
                continue
        found = noun_phrase(words, i)
        if found is not None and not (word in ("left", "right") and before in ("turn", "a", "to", "go")):
            phrase, i = found
            line.append(f"{'NS' if phrase.kind is NounKind.STAIRS else 'N'}{len(phrases)}")
            phrases.append(phrase)
            continue
        line.append(f"ORD{ORDINALS[word]}" if word in ORDINALS else word)
        i += 1
    return " ".join(line), phrases, distances


_NUMBER = re.compile(r"NS?(\d+)$")
_RELATIONS = {
    "near to": "near",
    "close to": "near",
    "by": "next to",
    "beside": "next to",
    "besides": "next to",
    "alongside": "next to",
    "adjacent to": "next to",
    "inside": "in",
    "inside of": "in",
    "within": "in",
    "just inside": "in",
    "just inside of": "in",
    "outside of": "outside",
    "just outside": "outside",
    "just outside of": "outside",
    "in between": "between",
    "on top of": "on",
    "across from": "opposite",
    "opposite of": "opposite",
    "to the left of": "left of",
    "to the right of": "right of",
    "short of": "before",
    "once past": "past",
    "beyond": "past",
    "just before": "before",
    "just after": "after",
    "upon": "at",
    "against": "next to",
    "with": "near",
    "to": "at",
    "toward": "at",
}


def _relation(words: str) -> str:
    if words.startswith("before"):
        return "before"
    if words.startswith(("after", "once you pass", "once you are past")):
        return "after"
    if words.startswith(("when", "once")):
        return "at"
    return _RELATIONS.get(words, words)


def _fill(kind: ClauseType, found: re.Match[str], phrases: list[NounPhrase], distances: list[float]) -> Clause:
    """The slots of a matched clause."""
    text = found.group(0)
    places = [phrases[int(_NUMBER.match(group)[1])] for group in found.groups() if group and _NUMBER.match(group)]  # type: ignore[index]
    place = places[0] if places else None
    if place is not None and len(places) > 1:
        place = replace(place, also=places[1])
    clause = Clause(kind, text, place)
    stated = re.search(r"\bD(\d+)", text)
    if stated:
        clause = replace(clause, distance_m=distances[int(stated[1])])
    if kind in (T.THROUGH, T.ENTER, T.PAST, T.ALONG, T.TO, T.TOWARD, T.LEAVE) and re.search(r"\b(straight|ahead)\b", text):
        return replace(clause, degree="straight")
    if kind is T.TURN:
        degree = (found[1] or "").strip()
        degree = (
            "slight"
            if degree.startswith(("slight", "gentle", "soft")) or "bit " in text or "veer" in text or "bear" in text
            else "sharp"
            if degree
            else ""
        )
        return replace(
            clause,
            side=found[3],
            degree=degree,
            ordinal=int(found[2] or 0) or (1 if "next" in text else 0),
            relation=_relation(found[4] or ""),
        )
    if kind is T.STOP:
        relation = found[1] if found.lastindex else ""
        return replace(clause, relation=_relation(relation or ""))
    if kind is T.STAIRS:
        down = re.search(r"\b(down|descend|downstairs|downward)\b", text)
        up = re.search(r"\b(up|climb|ascend|upstairs|upward)\b", text)
        return replace(clause, vertical="down" if down else "up" if up else "")
    return clause


def _retype(clause: Clause) -> Clause:
    """Lets the sort of noun decide where the preposition does not."""
    place = clause.place
    if place is None:
        return clause
    opening = place.kind is NounKind.OPENING
    stairs = place.kind is NounKind.STAIRS
    if (clause.type is T.ENTER and opening) or (clause.type is T.LEAVE and opening):
        return replace(clause, type=T.THROUGH)
    if clause.type is T.THROUGH and place.kind is NounKind.OBJECT and place.head not in ("window", "curtain"):
        return replace(clause, type=T.TO if clause.text.startswith("take") else T.PAST)
    if clause.type is T.LEAVE and place.kind is NounKind.OBJECT and clause.text.startswith(("from", "away", "off")):
        return replace(clause, type=T.NOTICE)
    if clause.type is T.ENTER and place.kind is NounKind.OBJECT and place.head not in ("elevator", "shower", "pool"):
        return replace(clause, type=T.TO)
    if clause.type in (T.TO, T.TOWARD) and stairs and place.part == "" and clause.vertical:
        return replace(clause, type=T.STAIRS)
    return clause


def _lex(line: str, phrases: list[NounPhrase], distances: list[float]) -> list[Clause | str]:
    """Clauses in the order of the text, with the connectives between them as strings."""
    items: list[Clause | str] = []
    at = 0
    while at < len(line):
        for kind, rule in RULES:
            found = rule.match(line, at)
            if found is None or found.end() == at:
                continue
            items.append(found.group(0) if kind is None else _retype(_fill(kind, found, phrases, distances)))
            at = found.end()
            break
        else:
            space = line.find(" ", at)
            at = len(line) if space < 0 else space
        while at < len(line) and line[at] == " ":
            at += 1
    return items


_POSTPOSED = ("once", "when", "as soon as", "after")


def _in_order(items: list[Clause | str]) -> list[Clause]:
    """Order of action: in "turn left once you pass X", X comes first; "before you reach X" qualifies what precedes it."""
    ordered: list[Clause] = []
    pending: Clause | None = None  # an action whose condition follows
    previous = ""
    for item in items:
        if isinstance(item, str):
            if (
                item in _POSTPOSED
                and previous not in (".", ",", "", "and")
                and ordered
                and ordered[-1].type in (T.TURN, T.STOP, T.LEAVE, T.ENTER)
            ):
                pending = ordered.pop()
            elif item in (".", ",") and pending is not None:
                ordered.append(pending)
                pending = None
            previous = item
            continue
        end = item.place is not None and item.place.kind is NounKind.PART and item.place.head in ("end", "far end", "other end")
        if end and item.type is T.TO and ordered and ordered[-1].type is T.ALONG and ordered[-1].place is not None:
            ordered[-1] = replace(ordered[-1], place=replace(ordered[-1].place, part="end"))  # "down the hall to the end"
            previous = item.text
            continue
        if previous == "before" and ordered and ordered[-1].type in (T.TURN, T.STOP) and item.place is not None:
            if ordered[-1].place is None:
                ordered[-1] = replace(ordered[-1], place=item.place, relation="before")
        else:
            ordered.append(item)
        previous = item.text
    if pending is not None:
        ordered.append(pending)
    return ordered


def _with_text(clause: Clause, phrases: list[NounPhrase]) -> Clause:
    """The clause's words with its noun phrases written out."""
    text = re.sub(r"NS?(\d+)", lambda found: "the " + phrases[int(found[1])].text, clause.text)
    return replace(clause, text=re.sub(r" ?\bD\d+", "", re.sub(r"ORD-?\d+ ?", "", text)).strip(" ,"))


def parse(instruction: str) -> tuple[Clause, ...]:
    """Typed clauses in the order of action. Never fails: a text that asks for nothing gives ``()``.

    At most the first 4,000 words are read. Conditions that follow their action ("stop once you pass the sofa") are put before it.
    """
    line, phrases, distances = _reduce(_words(instruction))
    return tuple(_with_text(clause, phrases) for clause in _in_order(_lex(line, phrases, distances)))
