"""``spacevln prompt``: what a model was asked, or would have been asked, at a point of a recorded episode."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.prompt_options import prompt_options, prompts_from

if TYPE_CHECKING:
    from spacevln.core import ChatRequest


@click.command()
@click.argument("record", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.argument("stage", type=click.IntRange(min=0))
@click.option("--decision", type=click.IntRange(min=1), default=None, help="The executor's question of this number, instead.")
@click.option("--episode", "episode_id", default=None, help="Which episode, where RECORD is a run of many.")
@click.option("--to", type=click.Path(path_type=Path, file_okay=False), default=None, help="Write request.md and pictures here.")
@prompt_options
def prompt(record: Path, stage: int, decision: int | None, episode_id: str | None, to: Path | None, **options: Any) -> int:
    """Print the prompt of STAGE (from 0) in RECORD, with the names of its pictures.

    It is made anew from what the record says that planner and executor saw, with the run's settings where no other are given: so
    a record of the rules shows what a model would have been asked. Whole records only (level full).
    """
    request = _request(record, stage, decision, episode_id, options)
    if to is not None:
        from spacevln.models.relay import write_request

        to.mkdir(parents=True, exist_ok=True)
        write_request(to, request)
    click.echo(_told(request))
    if to is not None:
        click.echo(f"pictures {to}")
    return 0


def _request(record: Path, stage: int, decision: int | None, episode_id: str | None, options: dict[str, Any]) -> ChatRequest:
    from spacevln.assembly import Configuration, RecordedSituations, build_environment, prompt_settings
    from spacevln.evaluation.replay import find_episode
    from spacevln.reasoning.spatial_cot import ExecutorPrompt, PlannerPrompt
    from spacevln.recording import RunFile, read_file

    episode = find_episode(record, episode_id)
    configuration = Configuration.model_validate(read_file(episode.parent.parent / "run.json", RunFile).configuration)
    given = prompts_from(options).model_dump(exclude_unset=True)
    configuration = configuration.model_copy(update={"prompts": configuration.prompts.model_copy(update=given)})
    spec = build_environment(configuration).spec
    situations = RecordedSituations(episode, configuration, spec.camera)
    settings = prompt_settings(configuration)
    if decision is None:
        return PlannerPrompt(settings, spec).request(situations.planner(stage))
    return ExecutorPrompt(settings, spec).request(situations.executor(stage, decision))


def _told(request: ChatRequest) -> str:
    from spacevln.core import TextPart
    from spacevln.models.relay import picture_name

    lines, number = [], 0
    for message in request.messages:
        lines.append(click.style(f"--- {message.speaker}{', the same in every call' if message.static else ''}", bold=True))
        for part in message.parts:
            if isinstance(part, TextPart):
                lines.append(part.text)
            else:
                number += 1
                lines.append(f"[{picture_name(number, part)}: {len(part.data) // 1024} KiB]")
    words = sum(len(message.text) for message in request.messages)
    return "\n".join([*lines, "", f"size     {words:,} characters, {number} pictures"])
