"""Renders the prompt templates: Jinja files with strict undefined variables, pictures in their places between the words."""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from spacevln.core import ImagePart, Part, TextPart

_PICTURE = re.compile(r"\x00([^\x00]*)\x00")  # no text that reaches a template holds control characters
_HEADING = re.compile(r"\n+(?=# )")  # one blank line before it, whatever the statements around it leave


def render(template: str, pictures: Mapping[str, bytes] | None = None, /, **variables: Any) -> tuple[Part, ...]:
    """Text and pictures of a prompt, in reading order.

    Args:
        template: name without its suffix.
        pictures: encoded, by the name that the template gives to ``picture(name)``.
        variables: everything else that the template names; a missing one is an error.
    """
    shown = pictures or {}
    text = _environment().get_template(f"{template}.jinja").render(picture=_marker, **variables)
    parts: list[Part] = []
    for index, piece in enumerate(_PICTURE.split(text)):
        if index % 2:
            parts.append(ImagePart(shown[piece], piece))
        elif piece.strip():
            parts.append(TextPart(_HEADING.sub("\n\n", piece).strip("\n")))
    return tuple(parts)


def _marker(name: str) -> str:
    return f"\x00{name}\x00"


@cache
def _environment() -> Environment:
    return Environment(  # noqa: S701 - prompts are plain text, nothing is HTML
        loader=PackageLoader("spacevln.reasoning.spatial_cot"),
        undefined=StrictUndefined,
        line_statement_prefix="%%",
        keep_trailing_newline=False,
    )
