"""From clauses to words: phrases are drawn from a split's table, then joined into sentences."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from spacevln.environments.houses.episodes.clauses import Clause
from spacevln.environments.houses.episodes.episode import Split
from spacevln.environments.houses.episodes.phrases import PHRASES

ONCE_WORDS = ("once", "when", "after", "as soon as")
_IDIOMS = (
    (r"\b(enter|into|inside) the balcony", lambda m: ("go out onto" if m.group(1) == "enter" else "onto") + " the balcony"),
    (r"\bgo out onto the balcony", "go out onto the balcony"),
    (r"\bin the balcony", "on the balcony"),
    (r"\bgo to the (bath|rest)room", r"walk to the \1room"),
)
_ONCE_P = (0.5, 0.3, 0.14, 0.06)


@dataclass(frozen=True, slots=True)
class Text:
    """An instruction's words and their counts."""

    text: str
    words: int
    sentences: int


def phrase(clause: Clause, form: str, split: Split, rng: np.random.Generator) -> str:
    """One wording of a clause."""
    options = PHRASES[split][form]
    words = options[int(rng.integers(len(options)))].format(**dict(clause.slots))
    for pattern, better in _IDIOMS:
        words = re.sub(pattern, better, words)
    return words


def realise(clauses: tuple[Clause, ...], split: Split, rng: np.random.Generator) -> Text:
    """The instruction: clauses worded and joined by full stops, "and", "then" and commas."""
    pieces: list[str] = []
    pending = ""
    for clause, before in zip(clauses, (None, *clauses), strict=False):
        if clause.wrap == "once":
            word = ONCE_WORDS[int(rng.choice(len(ONCE_WORDS), p=_ONCE_P))]
            pending = f"{word} {phrase(clause, f'once:{clause.form}', split, rng)}, "
            continue
        if clause.wrap == "until" and pieces:
            pieces[-1] += f" until {phrase(clause, f'until:{clause.form}', split, rng)}"
            continue
        pieces.append(pending + phrase(clause, _form(clause, before, split), split, rng))
        pending = ""
    breaks = _breaks(pieces, rng)
    text = _sentence_case(_joined(pieces, breaks, rng))
    return Text(text, len(text.split()), sum(breaks) + 1)


def _form(clause: Clause, before: Clause | None, split: Split) -> str:
    """The form of a clause, or the one that does not repeat the room just named."""
    if before is not None and before.nouns and clause.nouns and clause.nouns[-1] in before.nouns:
        if clause.form in ("through_space", "across_space"):
            return "through_it"
        if f"{clause.form}:same" in PHRASES[split]:
            return f"{clause.form}:same"
    return clause.form


def _breaks(pieces: list[str], rng: np.random.Generator) -> list[bool]:
    """Where sentences end: a sentence has one to three clauses, mostly two."""
    style = rng.choice(3, p=(0.38, 0.44, 0.18))
    p = (0.12, 0.5, 0.75)[int(style)]
    out: list[bool] = []
    run = 1
    for k in range(len(pieces) - 1):
        follows = pieces[k + 1]
        told = ("you ", "there ")
        forced = run >= 4 or "," in follows or follows.startswith(told) or pieces[k].startswith(told)
        stop = bool(forced or rng.random() < p)
        out.append(stop)
        run = 1 if stop else run + 1
    return out


def _joined(pieces: list[str], breaks: list[bool], rng: np.random.Generator) -> str:
    text = pieces[0]
    for k, stop in enumerate(breaks):
        following = pieces[k + 1]
        if stop:
            text += ". " + ("then " if rng.random() < 0.03 and not following.startswith(("you ", "there ")) else "") + following
            continue
        last = k + 1 == len(breaks) or breaks[k + 1]
        if last:
            text += (" and " if rng.random() < 0.87 else " and then " if rng.random() < 0.5 else ", then ") + following
        else:
            text += (", " if rng.random() < 0.6 else " and ") + following
    return text


def _sentence_case(text: str) -> str:
    text = re.sub(r"(^|\. )([a-z])", lambda m: m.group(1) + m.group(2).upper(), text)
    return text + "."
