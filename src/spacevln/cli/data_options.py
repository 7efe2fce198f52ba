"""Options about episodes: which suite, which of its episodes, and where its data lies."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.option_groups import option_group

if TYPE_CHECKING:
    from spacevln.evaluation.datasets import Selection

FILTERS = ("language", "role", "available_in", "scene", "ids", "slice", "sample")


def seed_range(_context: click.Context, _parameter: click.Parameter, value: str | None) -> tuple[int, int] | None:
    """Parse ``A:B``, half open."""
    if value is None:
        return None
    first, colon, last = value.partition(":")
    if not (colon and first.isdigit() and last.isdigit() and int(first) < int(last)):
        raise click.BadParameter(f"{value!r} is no range of seeds: give A:B with 0 <= A < B, e.g. 0:100.")
    return int(first), int(last)


def _shard(_context: click.Context, _parameter: click.Parameter, value: str | None) -> tuple[int, int] | None:
    """Parse ``i/n``, from 1."""
    if value is None:
        return None
    number, slash, count = value.partition("/")
    if not (slash and number.isdigit() and count.isdigit() and 1 <= int(number) <= int(count)):
        raise click.BadParameter(f"{value!r} is no shard: give i/n with 1 <= i <= n, e.g. 2/4.")
    return int(number), int(count)


def _names(_context: click.Context, _parameter: click.Parameter, values: tuple[str, ...]) -> tuple[str, ...]:
    """Names, and the lines of files that are named by ``@FILE``."""
    found: list[str] = []
    for value in values:
        if not value.startswith("@"):
            found.append(value)
            continue
        try:
            lines = Path(value[1:]).read_text(encoding="utf-8").splitlines()
        except (OSError, UnicodeDecodeError) as error:
            raise click.BadParameter(f"{value[1:]!r} cannot be read as text: give a file with one id a line.") from error
        found += [line.strip() for line in lines if line.strip()]
    return tuple(found)


_FOLDER = click.Path(path_type=Path)
data_options = option_group(
    click.option(
        "--split",
        default=None,
        help="Of the suite; by default test, for R2R-CE and the like val_unseen; paper: the paper's.",
    ),
    click.option("--data", type=_FOLDER, default=None, help="Folder or file of a benchmark's episodes, or a suite's file."),
    click.option(
        "--seeds",
        callback=seed_range,
        metavar="A:B",
        default=None,
        help="One fresh episode of each house seed A..B-1 instead of the split.",
    ),
    click.option("--language", multiple=True, help="RxR-CE: en-US, en-IN, hi-IN, te-IN; may be given several times."),
    click.option("--role", multiple=True, help="RxR-CE: guide or follower; may be given several times."),
    click.option("--scene", multiple=True, help="Only episodes in this building; may be given several times."),
    click.option(
        "--ids",
        multiple=True,
        callback=_names,
        metavar="ID|@FILE",
        help="Only this episode, or those of a file, one a line; may be given several times.",
    ),
    click.option("--slice", default=None, metavar="A:B", help="Only the A-th up to before the B-th of what is left."),
    click.option("--sample", type=click.IntRange(min=1), default=None, help="Only so many of what is left, drawn."),
    click.option("--sample-seed", type=click.IntRange(min=0), default=0, help="Of the draw."),
    click.option(
        "--available-in", type=_FOLDER, default=None, help="Only episodes whose building lies in this folder of scenes."
    ),
    click.option("--episodes", type=click.IntRange(min=1), default=None, help="Only the first so many."),
    click.option("--shard", callback=_shard, metavar="I/N", default=None, help="Only every N-th, from the I-th on."),
    click.option(
        "--probe",
        type=click.Choice(["none", "swapped", "elsewhere", "last-noun"]),
        default="none",
        help="Another instruction: does it matter?",
    ),
)
"""Which episodes."""


def selection_from(suite: str, options: dict[str, Any]) -> Selection:
    """The selection that these options say; they are taken out of ``options``.

    Raises:
        UsageError: a filter is not allowed.
    """
    from spacevln.evaluation.datasets import Filters, Selection

    given = {name: value for name in FILTERS if (value := options.pop(name)) not in (None, ())}
    seed = options.pop("sample_seed")
    return Selection(
        suite=suite,
        split=options.pop("split"),
        path=options.pop("data"),
        seeds=options.pop("seeds"),
        filters=Filters.of({**given, "seed": seed} if "sample" in given else given),
        episodes=options.pop("episodes"),
        shard=options.pop("shard"),
        probe=options.pop("probe"),
    )
