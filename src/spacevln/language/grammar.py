"""The grammar of route clauses: spelling, filler words, and the patterns that a line of tokens is read by.

In the line every noun phrase is one token ``N3``, stairs are ``NS3``, an ordinal word is ``ORD2``, a stated distance is ``D0``.
"""

from __future__ import annotations

import re
from enum import StrEnum


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


T = ClauseType
SPELLING = {
    "thru": "through",
    "trough": "through",
    "though": "through",
    "dinning": "dining",
    "bannister": "banister",
    "hall-way": "hallway",
    "infront": "front",
    "rigth": "right",
    "stairs.": "stairs",
    "towards": "toward",
    "forwards": "forward",
    "till": "until",
    "passed": "past",
    "untill": "until",
    "exiting": "exit",
    "leaving": "leave",
    "entering": "enter",
    "passing": "pass",
    "turning": "turn",
    "walking": "walk",
    "going": "go",
    "reaching": "reach",
    "heading": "head",
    "continuing": "continue",
    "moving": "move",
    "crossing": "cross",
    "entered": "enter",
    "reached": "reach",
    "exited": "exit",
    "you've": "you",
    "you're": "you",
    "you'll": "you",
    "getting": "get",
    "climbing": "climb",
    "descending": "descend",
    "following": "follow",
    "upstairs": "upstairs",
    "beside": "beside",
    "looking": "facing",
    "walks": "walk",
}
FILLERS = frozenset(
    [
        "just",
        "now",
        "please",
        "slowly",
        "carefully",
        "simply",
        "then",
        "finally",
        "afterwards",
        "again",
        "directly",
        "all",
        "way",
        "almost",
        "about",
        "approximately",
        "will",
        "should",
        "have",
        "go-ahead",
        "also",
        "very",
        "first-floor",
        "being",
        "been",
        "your-self",
        "yourself",
        "so'that",
    ]
)
MARKS = {".": ".", "!": ".", "?": ".", ";": ".", ":": ",", ",": ","}
STEPS = {
    "step": 0.5,
    "steps": 0.5,
    "pace": 0.7,
    "paces": 0.7,
    "feet": 0.3,
    "foot": 0.3,
    "ft": 0.3,
    "meter": 1.0,
    "meters": 1.0,
    "metre": 1.0,
    "metres": 1.0,
    "yards": 0.9,
    "yard": 0.9,
}

_GO = (
    r"(?:walk|go|head|move|proceed|continue|come|travel|keep|get|run|make your|advance|take|step|start|begin|"
    r"follow|stay|carry|cut)"
)
_ADV = (
    r"(?:straight|forward|ahead|on|onward|along|back|inside|outside|over|up|down|upstairs|downstairs|slightly|"
    r"in|right|left|out|diagonally|further|farther)"
)
_LEAD = rf"(?:{_GO} )*(?:{_ADV} )*"
_N = r"(NS?\d+)"
_REL = (
    r"(just inside of|just inside|just outside of|just outside|inside of|inside|outside of|outside|in the|in "
    r"front of|in between|in|next to|"
    r"beside|besides|near to|near|close to|by|before you (?:reach|get to|enter|come to|hit|go|exit)|before "
    r"(?:reach|enter|exit|pass|go into|get to)|"
    r"before|once past|past|after you (?:pass|reach|enter)|after pass|after|behind|between|on top of|on|under|"
    r"below|at|across from|opposite of|opposite|"
    r"against|left of|right of|to the left of|to the right of|to|facing|beyond|under|alongside|along|with|"
    r"within|adjacent to|from|around|underneath|short of|toward|upon)"
)


def _rule(kind: ClauseType | None, pattern: str) -> tuple[ClauseType | None, re.Pattern[str]]:
    # bounded repetition keeps the lexer linear on any input
    return kind, re.compile(pattern.replace(")*", "){0,6}") + r"(?= |$)")


# first match wins at a position; None marks connectives that carry no clause
RULES = (
    _rule(
        T.ORIENT,
        r"(?:stand|standing|start|begin|starting)(?: (?:by|so|that|you|are))* (?:with|facing) "
        rf"{_N}(?: (?:to|at|behind) (?:your back|you))?",
    ),
    _rule(T.AROUND, rf"(?:turn|round|go around|walk around) {_N}"),
    _rule(
        T.PAST,
        rf"{_LEAD}(?:to|on|along|down|past|keep to|stay to|pass to) (?:the |your )?(?:left|right)(?: hand)?(?: "
        rf"side)? of {_N}",
    ),
    _rule(
        T.TURN_AROUND,
        r"(?:do|make|take|turn|pull|rotate|spin|face|go|walk)(?: (?:a|an|full|complete|quick|to|and|completely))* "
        r"(?:around|180|u-turn|u turn|about face|behind you|180-degrees|one hundred eighty|to face back)(?: degree|"
        r" degrees| turn)*(?! N)",
    ),
    _rule(
        T.TURN,
        rf"(?:(?:turn|make|take|hang|veer|bear|keep|stay|face|rotate|pivot|curve|swing|angle|you|walk|go|head|move|"
        rf"continue|proceed|immediate|step|bend|bank|cut|exit|get) )*(?:(?:a|an|the|your|to|on|at|towards?|off|bit|"
        rf"little|quick|90|45|degree|degrees|turn|slowly|sort|of|kind|again|another|straight|forward|immediately|"
        rf"next|available|possible|ninety|over|down|up|back) )*(slight |slightly |sharp |hard |sharply |immediate |"
        rf"gentle |soft )?(?:ORD(-?\d+) )?(?:possible |available )?(left|right)(?: (?:turn|hand|side|corner|way|"
        rf"hand side|direction|again|immediately|slightly|sharply|90 degrees|45 degrees|completely|degrees|90))*(?: "
        rf"(at|before|after|by|near|in front of|past|when you (?:reach|get to|see|come to|enter)|once you (?:reach|"
        rf"pass|enter|are past|get to|see)|after you pass|after pass|before you reach|upon|just before|just after|"
        rf"at or near|next to|behind) {_N})?",
    ),
    _rule(
        T.STOP,
        rf"(?:and )?(?:you (?:are|be)? ?(?:arrived?|there|done|at)|stop|stopping|wait|stand|stand still|pause|halt|"
        rf"stay|finish|your destination is|end|rest|remain|park)(?: (?:and|stop|wait|stand|there|here|for|me|once|"
        rf"when|you|are|get|right|still|moving|a|moment|walk|as|soon|it|to|be|you've|reached|until|done|turn))*?(?: "
        rf"{_REL} {_N}(?: (?:and|or) {_N})?)?",
    ),
    _rule(
        T.ORIENT,
        rf"(?:start|begin|standing|stand|starting|turn)?(?: ?(?:to|so|that|and|by|you|are|until|is|be|out|off))* "
        rf"?(?:with|facing|face|looking at|look at|look|look toward) {_N}(?: (?:in front of you|to your back|at "
        rf"your back|behind you|is on your (?:left|right)|are on your (?:left|right)))?",
    ),
    _rule(
        T.NOTICE,
        rf"(?:there (?:is|are|be)|you (?:see|find|notice|be able to see)|see|notice|find|locate|look for|spot) {_N}",
    ),
    _rule(
        T.STAIRS,
        rf"{_LEAD}(?:climb|ascend|descend|up|down|take|use|through|go|onto|off|on|along|over|follow)(?: (?:up|down|"
        rf"to|on|of|the))* (NS\d+)(?: (up|down|upward|downward|upstairs|downstairs|on the left|on the right))?",
    ),
    _rule(
        T.STAIRS,
        r"(?:walk|go|head|move|proceed|continue|climb|turn|and|run|come|get)*(?: ?all)*(?: ?back)* ?(upstairs|"
        r"downstairs|up a level|down a level|up ORD\d+ floor|down ORD\d+ floor)",
    ),
    _rule(
        T.LEAVE,
        rf"{_LEAD}(?:exit out of|exit from|exit|leave|out of|outside of|off of|away from|from|get out of|out from) "
        rf"(?:the )?{_N}",
    ),
    _rule(T.ENTER, rf"{_LEAD}(?:enter into|enter|into|in to|inside of|inside|in through|go in|step in|in) {_N}"),
    _rule(
        T.THROUGH,
        rf"{_LEAD}(?:exit |enter )?(?:through|via|using|use|out|out through|out by|take|between the two|under|"
        rf"underneath|beneath) {_N}",
    ),
    _rule(
        T.PAST,
        rf"{_LEAD}(?:past|pass by|pass on|pass|by|beyond|bypass|behind|in front of|beside|alongside of|next to|"
        rf"near) {_N}",
    ),
    _rule(T.BETWEEN, rf"{_LEAD}(?:in )?between {_N}(?: and {_N})?"),
    _rule(T.ACROSS, rf"{_LEAD}(?:cross|across|over|cross over) {_N}"),
    _rule(T.AROUND, rf"{_LEAD}(?:turn )?(?:around|round|circle) {_N}"),
    _rule(T.ALONG, rf"{_LEAD}(?:along|alongside|follow|down|up|parallel to|through the length of|down to the end of) {_N}"),
    _rule(T.TOWARD, rf"{_LEAD}(?:toward|for|in the direction of|facing) {_N}"),
    _rule(
        T.TO,
        rf"{_LEAD}(?:(?:until|once|when|as|soon|after) )*(?:you (?:are|get|reach|come|hit|be|arrive|see|find|make "
        rf"it|walk|go) ?)?(?:reach|approach|arrive at|arrive in|get to|come to|come upon|hit|to|onto|at|up to|on|"
        rf"upon|find|over to|on to|at or near|see) {_N}",
    ),
    _rule(T.LEAVE, r"(?:exit|leave|go outside|walk outside|head outside|walk out|go out|head out|step out|step outside)"),
    _rule(
        T.ENTER,
        r"(?:enter|go inside|walk inside|head inside|step inside|walk in|go in|go indoors|head indoors|step in|"
        r"walk indoors)",
    ),
    _rule(
        T.STRAIGHT,
        rf"(?:(?:{_GO}|and) )*(?:straight|forward|ahead|onward|on your path|keep on|continue on|go on|"
        rf"walk on|move on)(?: (?:straight|forward|ahead|a bit|"
        rf"bit|a little|little|slightly|across|through|over|on|D\d+))*",
    ),
    _rule(
        T.STRAIGHT,
        r"(?:walk|go|head|move|proceed|continue|take|run|come|travel|keep|step)(?: (?:a|walk|go|more|down|up|"
        r"another|for|about|straight|forward|ahead|in|the))* D\d+(?: (?:straight|forward|ahead|in|inside|away|"
        r"more))*",
    ),
    _rule(T.STRAIGHT, r"(?:continue|keep|proceed|move|travel|walk) ?(?:walk|go|move|on)?(?= [.,]| and|$| until| once)"),
    _rule(None, r"(?:and|,|\.|then|as soon as|once|when|after|before|until|while|as|you|to|so|that|the|a|it|if|is|are)"),
    _rule(T.NOTICE, rf"{_N}"),
    _rule(T.STOP, r"(?:at|in|on|by) (?:the )?(?:end|destination)"),
)
