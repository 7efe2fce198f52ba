"""The clause parser: a route instruction as a sequence of typed clauses with slots.

The words are first reduced to a line in which every noun phrase is one token (``walk past N0 and turn left at N1 .``); a lexer of
clause patterns then reads that line from left to right. Both passes are linear in the length of the text.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from enum import StrEnum

from spacevln.language.nouns_lexicon import DIGIT_WORDS, ORDINALS
from spacevln.language.phrases import NounPhrase, noun_phrase
from spacevln.language.vocabulary import NounKind, words_of


class ClauseType(StrEnum):
    """What a clause asks for."""

    TURN = "turn"
    TURN_AROUND = "turn around"
    STRAIGHT = "straight"
    LEAVE = "leave"
    ENTER = "enter"
    THROUGH = "through"
    PAST = "past"
    TO = "to"
    TOWARD = "toward"
    ALONG = "along"  # a hallway, a rug, a wall
    ACROSS = "across"
    AROUND = "around"
    BETWEEN = "between"
    STAIRS = "stairs"
    STOP = "stop"
    ORIENT = "orient"  # "with the bed on your left", "facing the sofa"
    NOTICE = "notice"  # "there is a lamp on the right"


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


_SPELLING = {
    "thru": "through", "though": "through", "dinning": "dining", "bannister": "banister", "hall-way": "hallway", "infront": "front",
    "rigth": "right", "stairs.": "stairs", "towards": "toward", "forwards": "forward", "till": "until", "passed": "past", "untill": "until",
    "exiting": "exit", "leaving": "leave", "entering": "enter", "passing": "pass", "turning": "turn", "walking": "walk", "going": "go",
    "reaching": "reach", "heading": "head", "continuing": "continue", "moving": "move", "crossing": "cross", "entered": "enter",
    "reached": "reach", "exited": "exit", "you've": "you", "you're": "you", "you'll": "you", "getting": "get", "climbing": "climb",
    "descending": "descend", "following": "follow", "upstairs": "upstairs", "beside": "beside", "looking": "facing", "walks": "walk",
}  # fmt: skip
_FILLERS = frozenset(
    """just now please slowly carefully simply then finally afterwards again directly all way almost about approximately will should
    have go-ahead also very first-floor being been your-self yourself so'that""".split()
)
_MARKS = {".": ".", "!": ".", "?": ".", ";": ".", ":": ",", ",": ","}
_STEPS = {"step": 0.5, "steps": 0.5, "pace": 0.7, "paces": 0.7, "feet": 0.3, "foot": 0.3, "ft": 0.3, "meter": 1.0, "meters": 1.0,
          "metre": 1.0, "metres": 1.0, "yards": 0.9, "yard": 0.9}  # fmt: skip

_GO = r"(?:walk|go|head|move|proceed|continue|come|travel|keep|get|run|make your|advance|take|step|start|begin|follow|stay|carry|cut)"
_ADV = r"(?:straight|forward|ahead|on|onward|along|back|inside|outside|over|up|down|upstairs|downstairs|slightly|in|right|left|out|diagonally|further|farther)"
_LEAD = rf"(?:{_GO} )*(?:{_ADV} )*"
_N = r"(NS?\d+)"
_REL = (
    r"(just inside of|just inside|just outside of|just outside|inside of|inside|outside of|outside|in the|in front of|in between|in|next to|"
    r"beside|besides|near to|near|close to|by|before you (?:reach|get to|enter|come to|hit|go|exit)|before (?:reach|enter|exit|pass|go into|get to)|"
    r"before|once past|past|after you (?:pass|reach|enter)|after pass|after|behind|between|on top of|on|under|below|at|across from|opposite of|opposite|"
    r"against|left of|right of|to the left of|to the right of|to|facing|beyond|under|alongside|along|with|within|adjacent to|from|around|underneath|short of|toward|upon)"
)
_T = ClauseType


def _rule(kind: ClauseType | None, pattern: str) -> tuple[ClauseType | None, re.Pattern[str]]:
    # bounded repetition keeps the lexer linear on any input
    return kind, re.compile(pattern.replace(")*", "){0,6}") + r"(?= |$)")


# first match wins at a position; None marks connectives that carry no clause
_RULES = (
    _rule(_T.PAST, rf"{_LEAD}(?:to|on|along|down|past|keep to|stay to|pass to) (?:the |your )?(?:left|right)(?: hand)?(?: side)? of {_N}"),
    _rule(_T.TURN_AROUND, r"(?:do|make|take|turn|pull|rotate|spin|face|go|walk)(?: (?:a|an|full|complete|quick|to|and|completely))* (?:around|180|u-turn|u turn|about face|behind you|180-degrees|one hundred eighty|to face back)(?: degree| degrees| turn)*(?! N)"),
    _rule(_T.TURN, rf"(?:(?:turn|make|take|hang|veer|bear|keep|stay|face|rotate|pivot|curve|swing|angle|you|walk|go|head|move|continue|proceed|immediate|step|bend|bank|cut|exit|get) )*(?:(?:a|an|the|your|to|on|at|towards?|off|bit|little|quick|90|45|degree|degrees|turn|slowly|sort|of|kind|again|another|straight|forward|immediately|next|available|possible|ninety|over|down|up|back) )*(slight |slightly |sharp |hard |sharply |immediate |gentle |soft )?(?:ORD(-?\d+) )?(?:possible |available )?(left|right)(?: (?:turn|hand|side|corner|way|hand side|direction|again|immediately|slightly|sharply|90 degrees|45 degrees|completely|degrees|90))*(?: (at|before|after|by|near|in front of|past|when you (?:reach|get to|see|come to|enter)|once you (?:reach|pass|enter|are past|get to|see)|after you pass|after pass|before you reach|upon|just before|just after|at or near|next to|behind) {_N})?"),
    _rule(_T.STOP, rf"(?:and )?(?:you (?:are|be)? ?(?:arrived?|there|done|at)|stop|stopping|wait|stand|stand still|pause|halt|stay|finish|your destination is|end|rest|remain|park)(?: (?:and|stop|wait|stand|there|here|for|me|once|when|you|are|get|right|still|moving|a|moment|walk|as|soon|it|to|be|you've|reached|until|done|turn))*?(?: {_REL} {_N}(?: (?:and|or) {_N})?)?"),
    _rule(_T.ORIENT, rf"(?:start|begin|standing|stand|starting|turn)?(?: ?(?:to|so|that|and|by|you|are|until|is|be|out|off))* ?(?:with|facing|face|looking at|look at|look|look toward) {_N}(?: (?:in front of you|to your back|at your back|behind you|is on your (?:left|right)|are on your (?:left|right)))?"),
    _rule(_T.NOTICE, rf"(?:there (?:is|are|be)|you (?:see|find|notice|be able to see)|see|notice|find|locate|look for|spot) {_N}"),
    _rule(_T.STAIRS, rf"{_LEAD}(?:climb|ascend|descend|up|down|take|use|through|go|onto|off|on|along|over|follow)(?: (?:up|down|to|on|of|the))* (NS\d+)(?: (up|down|upward|downward|upstairs|downstairs|on the left|on the right))?"),
    _rule(_T.STAIRS, r"(?:walk|go|head|move|proceed|continue|climb|turn|and|run|come|get)*(?: ?all)*(?: ?back)* ?(upstairs|downstairs|up a level|down a level|up ORD\d+ floor|down ORD\d+ floor)"),
    _rule(_T.LEAVE, rf"{_LEAD}(?:exit out of|exit from|exit|leave|out of|outside of|off of|away from|from|get out of|out from) (?:the )?{_N}"),
    _rule(_T.ENTER, rf"{_LEAD}(?:enter into|enter|into|in to|inside of|inside|in through|go in|step in|in) {_N}"),
    _rule(_T.THROUGH, rf"{_LEAD}(?:exit |enter )?(?:through|via|using|use|out|out through|out by|take|between the two|under|underneath|beneath) {_N}"),
    _rule(_T.PAST, rf"{_LEAD}(?:past|pass by|pass on|pass|by|beyond|bypass|behind|in front of|beside|alongside of|next to|near) {_N}"),
    _rule(_T.BETWEEN, rf"{_LEAD}(?:in )?between {_N}(?: and {_N})?"),
    _rule(_T.ACROSS, rf"{_LEAD}(?:cross|across|over|cross over) {_N}"),
    _rule(_T.AROUND, rf"{_LEAD}(?:turn )?(?:around|round|circle) {_N}"),
    _rule(_T.ALONG, rf"{_LEAD}(?:along|alongside|follow|down|up|parallel to|through the length of|down to the end of) {_N}"),
    _rule(_T.TOWARD, rf"{_LEAD}(?:toward|for|in the direction of|facing) {_N}"),
    _rule(_T.TO, rf"{_LEAD}(?:(?:until|once|when|as|soon|after) )*(?:you (?:are|get|reach|come|hit|be|arrive|see|find|make it|walk|go) ?)?(?:reach|approach|arrive at|arrive in|get to|come to|come upon|hit|to|onto|at|up to|on|upon|find|over to|on to|at or near|see) {_N}"),
    _rule(_T.LEAVE, r"(?:exit|leave|go outside|walk outside|head outside|walk out|go out|head out|step out|step outside)"),
    _rule(_T.ENTER, r"(?:enter|go inside|walk inside|head inside|step inside|walk in|go in|go indoors|head indoors|step in|walk indoors)"),
    _rule(_T.STRAIGHT, rf"(?:(?:{_GO}|and) )*(?:straight|forward|ahead|onward|on your path|on)(?: (?:straight|forward|ahead|a bit|bit|a little|little|slightly|across|through|over|on|D\d+))*"),
    _rule(_T.STRAIGHT, r"(?:walk|go|head|move|proceed|continue|take|run|come|travel|keep|step)(?: (?:a|walk|go|more|down|up|another|for|about|straight|forward|ahead|in|the))* D\d+(?: (?:straight|forward|ahead|in|inside|away|more))*"),
    _rule(_T.STRAIGHT, r"(?:continue|keep|proceed|move|travel|walk) ?(?:walk|go|move|on)?(?= [.,]| and|$| until| once)"),
    _rule(None, r"(?:and|,|\.|then|as soon as|once|when|after|before|until|while|as|you|to|so|that|the|a|it|if|is|are)"),
    _rule(_T.NOTICE, rf"{_N}"),
    _rule(_T.STOP, r"(?:at|in|on|by) (?:the )?(?:end|destination)"),
)  # fmt: skip
MAX_WORDS = 4000


def _words(text: str) -> list[str]:
    words: list[str] = []
    for word in words_of(text):
        word = _SPELLING.get(word, word)
        if word in _FILLERS:
            continue
        if word == "right" and words and words[-1] in ("is", "stop", "wait"):
            continue
        if word in ("before", "past", "there", "outside", "inside", "next", "where") and words and words[-1] == "right":
            if len(words) < 2 or words[-2] not in (
                "turn",
                "a",
                "the",
                "your",
                "go",
                "take",
                "bear",
                "veer",
                "immediate",
                "hang",
                "first",
                "second",
            ):
                words.pop()
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
        if word in _MARKS:
            line.append(_MARKS[word])
            i += 1
            continue
        number = DIGIT_WORDS.get(word) or (int(word) if word.isdigit() and len(word) < 4 else 0)
        j = i + 1
        while number and words[j : j + 1] in (["of"], ["more"], ["or"], ["three"], ["four"], ["small"], ["few"]):
            j += 1
        before = line[-1] if line else ""
        if number and words[j : j + 1] and words[j] in _STEPS and before not in ("at", "on", "the"):
            vertical = words[j] in ("steps", "step") and (
                before in ("up", "down", "climb", "descend") or words[j + 1 : j + 2] in (["up"], ["down"])
            )
            if not vertical:
                line.append(f"D{len(distances)}")
                distances.append(number * _STEPS[words[j]])
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
_RELATIONS = {"near to": "near", "close to": "near", "by": "next to", "beside": "next to", "besides": "next to", "alongside": "next to",
              "adjacent to": "next to", "inside": "in", "inside of": "in", "within": "in", "just inside": "in", "just inside of": "in",
              "outside of": "outside", "just outside": "outside", "just outside of": "outside", "in between": "between",
              "on top of": "on", "across from": "opposite", "opposite of": "opposite", "to the left of": "left of",
              "to the right of": "right of", "short of": "before", "once past": "past", "beyond": "past", "just before": "before",
              "just after": "after", "upon": "at", "against": "next to", "with": "near", "to": "at", "toward": "at"}  # fmt: skip


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
    if kind in (_T.THROUGH, _T.ENTER, _T.PAST, _T.ALONG, _T.TO, _T.TOWARD, _T.LEAVE) and re.search(r"\b(straight|ahead)\b", text):
        return replace(clause, degree="straight")
    if kind is _T.TURN:
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
    if kind is _T.STOP:
        relation = found[1] if found.lastindex else ""
        return replace(clause, relation=_relation(relation or ""))
    if kind is _T.STAIRS:
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
    if clause.type is _T.ENTER and opening or clause.type is _T.LEAVE and opening:
        return replace(clause, type=_T.THROUGH)
    if clause.type is _T.THROUGH and place.kind is NounKind.OBJECT and place.head not in ("window", "curtain"):
        return replace(clause, type=_T.TO if clause.text.startswith("take") else _T.PAST)
    if clause.type is _T.LEAVE and place.kind is NounKind.OBJECT and clause.text.startswith(("from", "away", "off")):
        return replace(clause, type=_T.NOTICE)
    if clause.type is _T.ENTER and place.kind is NounKind.OBJECT and place.head not in ("elevator", "shower", "pool"):
        return replace(clause, type=_T.TO)
    if clause.type in (_T.TO, _T.TOWARD) and stairs and place.part == "" and clause.vertical:
        return replace(clause, type=_T.STAIRS)
    return clause


def _lex(line: str, phrases: list[NounPhrase], distances: list[float]) -> list[Clause | str]:
    """Clauses in the order of the text, with the connectives between them as strings."""
    items: list[Clause | str] = []
    at = 0
    while at < len(line):
        for kind, rule in _RULES:
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
    """Order of action: in "turn left once you pass the sofa" the sofa comes first; "before you reach X" qualifies what precedes it."""
    ordered: list[Clause] = []
    pending: Clause | None = None  # an action whose condition follows
    previous = ""
    for item in items:
        if isinstance(item, str):
            if (
                item in _POSTPOSED
                and previous not in (".", ",", "", "and")
                and ordered
                and ordered[-1].type in (_T.TURN, _T.STOP, _T.LEAVE, _T.ENTER)
            ):
                pending = ordered.pop()
            elif item in (".", ",") and pending is not None:
                ordered.append(pending)
                pending = None
            previous = item
            continue
        end = item.place is not None and item.place.kind is NounKind.PART and item.place.head in ("end", "far end", "other end")
        if end and item.type is _T.TO and ordered and ordered[-1].type is _T.ALONG and ordered[-1].place is not None:
            ordered[-1] = replace(ordered[-1], place=replace(ordered[-1].place, part="end"))  # "down the hall to the end"
            previous = item.text
            continue
        if previous == "before" and ordered and ordered[-1].type in (_T.TURN, _T.STOP) and item.place is not None:
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
