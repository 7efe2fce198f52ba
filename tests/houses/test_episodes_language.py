"""The instruction language: phrases, names, clauses and their counts."""

from __future__ import annotations

import re
import string

import numpy as np
import pytest

from spacevln.environments.houses.episodes import making as make
from spacevln.environments.houses.episodes.clauses import Clause, Cross, Stop, Thing, Turn, anchors, mentions
from spacevln.environments.houses.episodes.nouns import indefinite, thing_words
from spacevln.environments.houses.episodes.phrases import PHRASES
from spacevln.environments.houses.episodes.realise import realise

SOFA = Thing("couch", ("sofa",), ("white",))


def slots(phrase: str) -> set[str]:
    return {name for _, name, _, _ in string.Formatter().parse(phrase) if name}


def test_splits_share_no_phrase() -> None:
    dev, test = PHRASES["dev"], PHRASES["test"]
    assert set(dev) == set(test)
    for form in dev:
        assert not set(dev[form]) & set(test[form]), form
    assert not {p for form in dev for p in dev[form]} & {p for form in test for p in test[form]}


@pytest.mark.parametrize("split", ["dev", "test"])
def test_phrases_are_distinct_and_use_known_slots(split: str) -> None:
    known = {"side", "lm", "a_lm", "lm2", "space", "space_bare", "space2", "door", "a_door", "ord", "stairs"}
    for form, phrases in PHRASES[split].items():  # type: ignore[index]
        assert len(set(phrases)) == len(phrases), form
        for phrase in phrases:
            assert slots(phrase) <= known, phrase
            assert phrase == phrase.strip()
            assert phrase[0].islower()


def test_several_phrasings_for_every_movement() -> None:
    for split in ("dev", "test"):
        for form in ("take_turn", "turn_at", "past", "enter", "exit", "hall", "straight", "through_door", "toward", "stop_near"):
            assert len(PHRASES[split][form]) >= 3, (split, form)


def test_two_splits_word_the_same_meaning_differently() -> None:
    clauses = (make.past(SOFA), make.stop(("Z7",), "stop_here", Stop("here"), (), ()))
    words = {split: {realise(clauses, split, np.random.default_rng(k)).text for k in range(40)} for split in ("dev", "test")}
    assert len(words["dev"]) > 5
    assert not words["dev"] & words["test"]


def test_sentences_are_written_as_sentences() -> None:
    clauses = (make.turn(1.0), make.past(SOFA), make.turn(-1.0), make.stop(("Z7",), "stop_here", Stop("here"), (), ()))
    for seed in range(60):
        text = realise(clauses, "dev", np.random.default_rng(seed))
        assert re.fullmatch(r"[A-Z][^.]*(\. [A-Z][^.]*)*\.", text.text), text.text
        assert text.sentences == text.text.count(".")
        assert text.words == len(text.text.split())
        assert text.text.index("left") < text.text.index("couch") < text.text.index("right")


def test_an_attribute_comes_before_its_noun() -> None:
    assert thing_words(SOFA) == "white couch"
    assert indefinite("armchair") == "an armchair"
    assert indefinite("chairs") == "some chairs"


def test_anchors_merge_a_stop_at_the_noun_just_named() -> None:
    leave = Clause(("X1",), "exit", (Cross(source="bedroom"),), (("space", "the bedroom"),), ("bedroom",))
    turn = Clause(("T1",), "turn", (Turn(1),), (("side", "left"),))
    toward = Clause(("G1",), "toward", (), (("lm", "the couch"),), ("couch",))
    stop = Clause(("Z3",), "stop_near", (Stop("near", SOFA),), (("lm", "the couch"),), ("couch",))
    assert anchors((leave, turn, stop)) == 2
    assert anchors((leave, turn, toward, stop)) == 2
    assert mentions((leave, stop)) == (1, 1)
