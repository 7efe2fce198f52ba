"""The ``spacevln`` command: its verbs, and what every error becomes."""

from __future__ import annotations

import logging
import sys
from typing import TYPE_CHECKING, NoReturn

import click

from spacevln import __version__
from spacevln.cli.ablate import ablate
from spacevln.cli.bench import bench
from spacevln.cli.bench_perception import bench_perception
from spacevln.cli.compare import compare
from spacevln.cli.detect import detect
from spacevln.cli.doctor import doctor
from spacevln.cli.houses import houses
from spacevln.cli.map import memory_map
from spacevln.cli.models import models
from spacevln.cli.pictures import figure, rerun, video
from spacevln.cli.prompt import prompt
from spacevln.cli.replay import replay
from spacevln.cli.robot import robot
from spacevln.cli.run import run
from spacevln.cli.table import table
from spacevln.cli.view import view

if TYPE_CHECKING:
    from spacevln.core import SpaceVLNError

DONE, FAILED, USAGE, PREREQUISITE, INTERRUPTED = 0, 1, 2, 3, 130


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 110})
@click.version_option(__version__, prog_name="spacevln")
def cli() -> None:
    """Zero-shot vision-and-language navigation with online Spatial Cognitive Memory.

    \b
    spacevln run                         watch an agent follow an instruction through a furnished house
    spacevln bench houses-vln            measure it on many houses
    spacevln ablate houses-vln           the same with each of the paper's nine presets
    spacevln view RECORD                 pages that show every decision of a run or an episode
    spacevln figure RECORD               the paper's figure of an episode, as PNG and PDF
    spacevln video RECORD                an episode as an MP4
    spacevln rerun RECORD                an episode as a log for the Rerun viewer
    spacevln table DIR...                print runs in the shape of the paper's tables
    spacevln compare A B                 compare two runs episode by episode
    spacevln replay RECORD               rerun a recorded episode offline, from its stored replies
    spacevln prompt RECORD STAGE         show what a model was asked there, or would have been
    spacevln map RECORD                  draw the memory that an episode left: map, spaces, graph
    spacevln detect IMAGE PHRASE...      find things that are named in a picture
    spacevln bench-perception houses     how good a detector is, against a simulator's labels
    spacevln models list                 weights of detectors and segmenters: list, download, verify
    spacevln robot                       drive a ROS 2 robot: run, check, record, map, bench, demo
    spacevln doctor                      what is installed, what is missing, and the command that mends it
    """  # noqa: D301 - click reads the backspace as "keep these lines"


cli.add_command(run)
cli.add_command(bench)
cli.add_command(bench_perception)
cli.add_command(ablate)
cli.add_command(view)
cli.add_command(figure)
cli.add_command(video)
cli.add_command(rerun)
cli.add_command(table)
cli.add_command(compare)
cli.add_command(replay)
cli.add_command(prompt)
cli.add_command(memory_map)
cli.add_command(houses)
cli.add_command(detect)
cli.add_command(models)
cli.add_command(robot)
cli.add_command(doctor)


def main() -> NoReturn:
    """Run the command line and exit with DESIGN 5.10's codes."""
    logging.basicConfig(level=logging.WARNING, format="%(message)s")
    try:
        code = cli.main(standalone_mode=False)
    except click.UsageError as error:
        error.show()
        sys.exit(USAGE)
    except click.exceptions.Exit as error:
        sys.exit(error.exit_code)
    except (click.Abort, KeyboardInterrupt):
        sys.exit(INTERRUPTED)
    except _own_errors() as error:
        click.echo(f"spacevln: {error}", err=True)
        sys.exit(_exit_code(error))
    sys.exit(code if isinstance(code, int) else DONE)


def _own_errors() -> type[SpaceVLNError]:
    """Asked for only when something was raised: nobody waits for numpy to read a help text."""
    from spacevln.core import SpaceVLNError

    return SpaceVLNError


def _exit_code(error: SpaceVLNError) -> int:
    from spacevln.core import PrerequisiteError, SpendingLimit, UsageError

    match error:
        case UsageError():
            return USAGE
        case PrerequisiteError():
            return PREREQUISITE
        case SpendingLimit():
            return INTERRUPTED
        case _:
            return FAILED
