import re

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from spacevln.core import UsageError
from spacevln.language import grounding_terms
from spacevln.perception import Agreement, fit
from spacevln.perception.open_vocabulary.boxes import BoxRules, ScoredBoxes, select
from spacevln.perception.open_vocabulary.queries import captions_of, prefer_specific, queries_of, score_phrases

WORDS = st.text("abcdefgh", min_size=1, max_size=9)
PHRASES = st.lists(st.lists(WORDS, min_size=1, max_size=4).map(" ".join), min_size=1, max_size=30)


def tokenize(text: str) -> list[tuple[int, int]]:
    """Like a word-piece tokenizer: pieces of at most three letters, punctuation alone, special tokens at both ends."""
    return [(0, 0), *(match.span() for match in re.finditer(r"[a-z0-9]{1,3}|[^\sa-z0-9]", text)), (0, 0)]


@settings(deadline=None, max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(phrases=PHRASES, max_tokens=st.integers(16, 60))
def test_every_phrase_owns_exactly_its_own_tokens(phrases: list[str], max_tokens: int) -> None:
    queries = queries_of(phrases)
    captions = captions_of(queries, tokenize, max_tokens)
    assert [index for caption in captions for index in caption.queries] == list(range(len(queries)))
    for caption in captions:
        offsets = tokenize(caption.text)
        assert len(offsets) <= max_tokens
        for index, words in zip(caption.queries, caption.spans, strict=True):
            read = ["".join(caption.text[slice(*offsets[token])] for token in range(*word)) for word in words]
            assert read == queries[index].text.split()


def test_phrases_are_asked_in_plain_words_and_once() -> None:
    queries = queries_of(["White  Sofa", "white sofa.", "kid's room door?", "...", "sofa"])
    assert [query.text for query in queries] == ["white sofa", "kid's room door", "sofa"]
    assert queries[0].phrase == "white sofa"
    assert captions_of(queries, tokenize, 64)[0].text == "white sofa . kid's room door . sofa ."


def test_a_phrase_that_cannot_be_asked_is_refused_in_a_sentence() -> None:
    with pytest.raises(UsageError, match="'abcdefghijk lmnopq' has more than 6 tokens"):
        captions_of(queries_of(["sofa", "abcdefghijk lmnopq"]), tokenize, 6)


def named(scores_of_words: dict[str, float], phrases: list[str], text_threshold: float = 0.25) -> dict[str, float]:
    """Phrases that one box is given when the tokens of these words score so."""
    queries = queries_of(phrases)
    (caption,) = captions_of(queries, tokenize, 256)
    offsets = tokenize(caption.text)
    tokens = np.zeros((1, len(offsets)), np.float32)
    for words in caption.spans:
        for first, last in words:
            word = caption.text[offsets[first][0] : offsets[last - 1][1]]
            tokens[0, last - 1] = scores_of_words.get(word, 0.0)
    scores = prefer_specific(score_phrases(tokens, caption, len(queries), text_threshold), queries)
    return {query.phrase: round(float(score), 2) for query, score in zip(queries, scores[0], strict=True) if score > 0}


def test_a_box_is_given_phrases_never_fragments_or_mixtures() -> None:
    phrases = ["white sofa", "doorway"]
    assert named({"white": 0.9}, phrases) == {}  # a white wall
    assert named({"sofa": 0.9, "white": 0.1}, phrases) == {}  # a black sofa
    assert named({"white": 0.4, "sofa": 0.9}, phrases) == {"white sofa": 0.9}
    assert named({"white": 0.4, "doorway": 0.6}, phrases) == {"doorway": 0.6}
    assert named({"white": 0.4, "sofa": 0.9}, phrases, text_threshold=0.5) == {}


def test_a_landmark_tells_the_one_with_its_attributes_from_others() -> None:
    terms = list(grounding_terms("the white couch by the window"))
    (white,), (black,) = named({"white": 0.4, "couch": 0.9}, terms), named({"white": 0.1, "couch": 0.9}, terms)
    assert (white, black) == ("white couch", "couch")
    assert fit("the white couch by the window", white) is Agreement.AGREED
    assert fit("the white couch by the window", black) is Agreement.UNKNOWN


def test_the_most_specific_name_stands() -> None:
    phrases = ["white sofa", "sofa", "couch", "armchair"]
    assert named({"white": 0.4, "sofa": 0.6, "couch": 0.8}, phrases) == {"white sofa": 0.8}
    assert named({"sofa": 0.6, "couch": 0.8}, phrases) == {"sofa": 0.6, "couch": 0.8}
    assert named({"white": 0.4, "sofa": 0.6, "armchair": 0.7}, phrases) == {"white sofa": 0.6, "armchair": 0.7}
    assert named({"dining": 0.3, "table": 0.6}, ["table", "dining table"]) == {"dining table": 0.6}


def chosen(boxes: list[tuple[float, ...]], scores: list[list[float]], **rules: float) -> list[tuple[int, tuple[int, ...], float]]:
    found = ScoredBoxes(np.array(boxes, np.float32), np.array(scores, np.float32))
    return [(box.query, box.box_px, round(box.confidence, 2)) for box in select(found, 640, 480, BoxRules(**rules))]


def test_thresholds_whole_images_and_duplicates() -> None:
    sofa, chair = (10.2, 20.4, 110.0, 220.0), (300.0, 200.0, 400.0, 300.0)
    assert chosen([sofa, chair], [[0.3, 0.0], [0.0, 0.25]]) == [(0, (10, 20, 110, 220), 0.3)]
    assert chosen([sofa, chair], [[0.3, 0.0], [0.0, 0.6]], box_threshold=0.5) == [(1, (300, 200, 400, 300), 0.6)]
    assert chosen([(0, 0, 640, 470)], [[0.9]]) == []
    assert chosen([(0, 0, 640, 440)], [[0.9]]) == [(0, (0, 0, 640, 440), 0.9)]
    again = tuple(edge + 8 for edge in sofa)
    assert chosen([sofa, again], [[0.5, 0.1], [0.1, 0.6]]) == [(1, (18, 28, 118, 228), 0.6)]
    assert len(chosen([sofa, again], [[0.5, 0.1], [0.1, 0.6]], duplicate_iou=1.0)) == 2


def test_boxes_are_whole_pixels_inside_the_image_and_sound() -> None:
    assert chosen([(-50, -3, 30.6, 90)], [[0.5]]) == [(0, (0, 0, 31, 90), 0.5)]
    assert chosen([(700, 10, 800, 90), (5, 5, 5, 90), (50, 50, 20, 90)], [[0.5], [0.5], [0.5]]) == []
    assert chosen([(np.nan, 0, 10, 10), (1e30, 0, 1e31, 10)], [[0.9], [0.9]]) == []
    assert select(ScoredBoxes(np.zeros((0, 4), np.float32), np.zeros((0, 2), np.float32)), 640, 480, BoxRules()) == ()
    with pytest.raises(UsageError, match="box_threshold=2"):
        BoxRules(box_threshold=2)


@settings(deadline=None, max_examples=50, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.tuples(*[st.floats(-100, 800)] * 4, st.floats(0, 1), st.floats(0, 1)), max_size=20))
def test_what_is_chosen_keeps_the_rules(rows: list[tuple[float, ...]]) -> None:
    rules = BoxRules()
    boxes = np.array([row[:4] for row in rows], np.float32).reshape(-1, 4)
    scores = np.array([row[4:] for row in rows], np.float32).reshape(-1, 2)
    found = select(ScoredBoxes(boxes, scores), 640, 480, rules)
    assert [box.confidence for box in found] == sorted((box.confidence for box in found), reverse=True)
    for box in found:
        x0, y0, x1, y1 = box.box_px
        assert 0 <= x0 < x1 <= 640
        assert 0 <= y0 < y1 <= 480
        assert box.confidence > rules.box_threshold
        assert (x1 - x0) * (y1 - y0) < rules.whole_image_share * 640 * 480
