"""Every command of the pages about benchmarks is one that the command line takes."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import click
import pytest

from spacevln.cli.app import cli

DOCS = Path(__file__).parents[2] / "docs"
PAGES = (*sorted((DOCS / "benchmarks").glob("*.md")), DOCS / "habitat.md", DOCS / "benchmarks.md")
PLACES = re.compile(r"\.\.\.|\b(SUITE|DIR|HOST)\b")
"""Words that stand for something else."""


def commands(page: Path) -> list[str]:
    """Lines that are commands, without what is said beside them."""
    lines = [re.split(r"\s{2,}|\s#", line.strip())[0] for line in page.read_text().splitlines()]
    return [line for line in lines if line.startswith("spacevln ") and not PLACES.search(line)]


COMMANDS = [pytest.param(line, id=f"{page.stem}-{number}") for page in PAGES for number, line in enumerate(commands(page))]


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_parse(command: str) -> None:
    root = click.Context(cli, info_name="spacevln")
    name, found, words = cli.resolve_command(root, shlex.split(command)[1:])
    while isinstance(found, click.Group):
        root = click.Context(found, info_name=name, parent=root)
        name, found, words = found.resolve_command(root, words)
    assert found is not None
    found.make_context(name, words, parent=root)  # parses, and runs nothing


def test_there_are_commands() -> None:
    assert len(COMMANDS) > 20
