"""The documents stay true: named symbols exist, listed defaults are the code's."""

from __future__ import annotations

import dataclasses
import importlib
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parent.parent / "docs"
SYMBOL = re.compile(r"`([a-z_][a-z_.0-9]*):([A-Za-z_][A-Za-z_0-9.]*)`")
DEFAULT = re.compile(r"^\| `([a-z_.0-9]+):([A-Za-z_0-9.]+)` \| `([^`]+)` \|", re.MULTILINE)


def resolve(module: str, name: str) -> object:
    value: object = importlib.import_module(f"spacevln.{module}")
    for part in name.split("."):
        defaults = {field.name: field.default for field in dataclasses.fields(value)} if dataclasses.is_dataclass(value) else {}
        defaults |= {name: field.default for name, field in getattr(value, "model_fields", {}).items()}
        value = defaults[part] if part in defaults else getattr(value, part)
    return value


@pytest.mark.parametrize(("module", "name"), sorted(set(SYMBOL.findall((DOCS / "paper.md").read_text()))))
def test_every_symbol_named_beside_the_paper_exists(module: str, name: str) -> None:
    assert resolve(module, name) is not None


@pytest.mark.parametrize(("module", "name", "value"), DEFAULT.findall((DOCS / "defaults.md").read_text()))
def test_every_listed_default_is_the_codes(module: str, name: str, value: str) -> None:
    assert repr(resolve(module, name)) == value


def test_the_tables_are_not_empty() -> None:
    assert len(SYMBOL.findall((DOCS / "paper.md").read_text())) > 60
    assert len(DEFAULT.findall((DOCS / "defaults.md").read_text())) > 40
