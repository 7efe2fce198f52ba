"""From landmark phrases to the text that a grounding model reads, and back: which tokens stand for which phrase.

A model such as GroundingDINO reads one caption, ``"white sofa . doorway ."``, and scores every token of it for every box. Reading
the label of a box off its high tokens gives mixtures ("sofa doorway") and fragments ("white"). Here each phrase owns a span of
the caption, so a box is given a phrase that was asked, or none.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from spacevln.core import UsageError
from spacevln.language import attributes_of, head_noun
from spacevln.language.vocabulary import words_of

SEPARATOR = " . "
"""Between phrases: the models forbid attention across a full stop."""

Offsets = Sequence[tuple[int, int]]
"""Of every token: where it begins and ends in the caption; special tokens are empty."""

Tokenize = Callable[[str], Offsets]


@dataclass(frozen=True, slots=True)
class Query:
    """One phrase as a model reads it.

    Args:
        phrase: as it was asked; the category of what is found.
        text: lower-case words without punctuation.
    """

    phrase: str
    text: str


Span = tuple[tuple[int, int], ...]
"""Half-open ranges of tokens, one for each word of a query."""


@dataclass(frozen=True, slots=True)
class Caption:
    """Queries that one forward pass grounds.

    Args:
        text: what the model reads.
        queries: indices into all queries.
        spans: of each of them, by token.
    """

    text: str
    queries: tuple[int, ...]
    spans: tuple[Span, ...]


def queries_of(phrases: Sequence[str]) -> tuple[Query, ...]:
    """What is asked, in order, each wording once; phrases without a word are left out."""
    found: dict[str, Query] = {}
    for phrase in phrases:
        text = " ".join(word for word in words_of(phrase) if word[0].isalnum())
        if text:
            found.setdefault(text, Query(" ".join(phrase.lower().split()), text))
    return tuple(found.values())


def captions_of(queries: Sequence[Query], tokenize: Tokenize, max_tokens: int) -> tuple[Caption, ...]:
    """As few captions as hold all queries, in order, none longer than the model reads.

    Args:
        queries: what is asked.
        tokenize: character range of every token of a text, special tokens included.
        max_tokens: that the model reads of a caption.

    Raises:
        UsageError: one phrase alone is too long.
    """
    captions: list[Caption] = []
    begin = 0
    while begin < len(queries):
        end = begin + 1
        while end < len(queries) and len(tokenize(_text(queries[begin : end + 1]))) <= max_tokens:
            end += 1
        if end == begin + 1 and len(tokenize(_text(queries[begin:end]))) > max_tokens:
            raise UsageError(f"The landmark {queries[begin].phrase!r} has more than {max_tokens} tokens: name it in fewer words.")
        captions.append(_caption(queries, begin, end, tokenize))
        begin = end
    return tuple(captions)


def score_phrases(token_scores: NDArray[np.float32], caption: Caption, count: int, text_threshold: float) -> NDArray[np.float32]:
    """Scores of phrases from scores of tokens.

    A phrase scores as its best token. It is named only when each of its words reaches the text threshold, as when the label that
    a model would print must equal the phrase: a white wall, which excites "white" alone, is no "white sofa", nor is a black sofa.

    Args:
        token_scores: (boxes, tokens), 0 to 1.
        caption: whose tokens they are.
        count: number of all queries.
        text_threshold: that every word must exceed.

    Returns:
        (boxes, count); 0 where a phrase is not named or not in this caption.
    """
    scores = np.zeros((len(token_scores), count), np.float32)
    for query, words in zip(caption.queries, caption.spans, strict=True):
        by_word = np.stack([token_scores[:, first:last].max(axis=1) for first, last in words], axis=1)
        scores[:, query] = np.where(by_word.min(axis=1) > text_threshold, by_word.max(axis=1), 0.0)
    return scores


def prefer_specific(scores: NDArray[np.float32], queries: Sequence[Query]) -> NDArray[np.float32]:
    """Give a box its most specific name, at the best of their scores: a "white sofa" is no longer a "sofa" or a "couch"."""
    preferred = scores.copy()
    for specific, general in _pairs(tuple(queries)):
        named = preferred[:, specific] > 0
        preferred[named, specific] = np.maximum(preferred[named, specific], preferred[named, general])
        preferred[named, general] = 0.0
    return preferred


@lru_cache(maxsize=64)
def _pairs(queries: tuple[Query, ...]) -> list[tuple[int, int]]:
    """Indices (specific, general), the most specific first."""
    words = [frozenset(query.text.split()) for query in queries]
    nouns = [head_noun(query.text) for query in queries]
    attributes = [frozenset(attributes_of(query.text)) for query in queries]
    pairs = [
        (a, b)
        for a in range(len(queries))
        for b in range(len(queries))
        if words[b] < words[a] or (nouns[a] == nouns[b] and attributes[b] < attributes[a])
    ]
    return sorted(pairs, key=lambda pair: (-len(words[pair[0]]), pair))


def _text(queries: Sequence[Query]) -> str:
    return SEPARATOR.join(query.text for query in queries) + SEPARATOR.rstrip()


def _caption(queries: Sequence[Query], begin: int, end: int, tokenize: Tokenize) -> Caption:
    text = _text(queries[begin:end])
    offsets = tokenize(text)
    spans, at = [], 0
    for query in queries[begin:end]:
        words = []
        for word in query.text.split():
            words.append(_tokens(offsets, at, at + len(word), query))
            at += len(word) + 1
        spans.append(tuple(words))
        at += len(SEPARATOR) - 1
    return Caption(text, tuple(range(begin, end)), tuple(spans))


def _tokens(offsets: Offsets, begin: int, end: int, query: Query) -> tuple[int, int]:
    """Half-open range of the tokens that lie in a range of characters."""
    inside = [index for index, (first, last) in enumerate(offsets) if first < last and begin <= first and last <= end]
    if not inside:
        raise UsageError(f"The landmark {query.phrase!r} has no token that the model knows: name it in other words.")
    return inside[0], inside[-1] + 1
