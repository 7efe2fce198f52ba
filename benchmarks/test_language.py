"""Reading instructions: linear in their length, whatever they say."""

from __future__ import annotations

from typing import Any

import pytest

from spacevln.language import parse

LONG = {"walk": "walk " * 4000, "turns": "turn left and " * 1500, "doors": "second door to the " * 1000}
USUAL = "Walk out of the bedroom and turn left. Go down the hall past the bathroom and stop by the second door on the right."


def test_a_usual_instruction(benchmark: Any) -> None:
    assert len(benchmark(parse, USUAL)) >= 4


@pytest.mark.parametrize("name", sorted(LONG))
def test_twenty_thousand_characters(benchmark: Any, name: str) -> None:
    benchmark.pedantic(parse, (LONG[name][:20000],), rounds=3)
