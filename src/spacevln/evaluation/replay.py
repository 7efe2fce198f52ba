"""Reruns an episode offline: the chat models answer from the record, everything else happens again and is compared."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from spacevln.assembly import Configuration, HousesSettings, RegisteredEnvironment, build_agent, build_environment
from spacevln.core import ChatModel, EpisodeSpec, InstructionTask, ObjectGoalTask, RecordError, Role, UsageError
from spacevln.models import RecordedCall, RecordedModel
from spacevln.models.reported import ReportedModel
from spacevln.recording import EpisodeRecorder, EventLine, RecordLevel, RunFile, read_events, read_file
from spacevln.recording.calls import CallRetriedLine, ModelCalledLine
from spacevln.recording.schema import EpisodeStartedLine, StepTakenLine

_VOLATILE = frozenset({"time_s", "seconds"})
_WEATHER = ("latency_s", "usd", "attempts", "source")
"""What a reply tells of the network that day."""


@dataclass(frozen=True, slots=True)
class ReplayReport:
    """What a replay found.

    Args:
        actions: steps whose action, and the motion that followed, are the same to the byte, up to the first that is not.
        recorded_actions, replayed_actions: steps in each.
        calls: model calls that were answered from the record.
        difference: the first line that differs, both versions as JSON; None when there is none.
        directory: record of the replay.
    """

    actions: int
    recorded_actions: int
    replayed_actions: int
    calls: int
    difference: tuple[str, str] | None
    directory: Path

    @property
    def same_actions(self) -> bool:
        """Whether the body did the same from beginning to end."""
        return self.actions == self.recorded_actions == self.replayed_actions


def replay(episode: Path, out: Path, *, strict: bool = True) -> ReplayReport:
    """Rerun a recorded episode from its stored replies.

    Args:
        episode: directory of its record, inside that of a run.
        out: where the replay's own record goes.
        strict: whether a request that differs from the recorded one ends the replay; otherwise it gets the recorded reply.

    Raises:
        RecordError: a record is missing or damaged.
        UsageError: it is no record of an agent in an embedded house.
    """
    configuration = _configuration(episode)
    lines = list(read_events(episode))
    spec = _spec(lines, episode)
    calls = [_call(line) for line in lines if isinstance(line, ModelCalledLine)]
    environment = build_environment(configuration)
    known = None if configuration.memory is None else configuration.memory.load()
    recorder = EpisodeRecorder(out, RecordLevel.LIGHT)
    try:
        names = {line.role: line.model for line in lines if isinstance(line, ModelCalledLine)}
        models: dict[Role, ChatModel] = {
            role: ReportedModel(RecordedModel(role, calls, names.get(role, "recorded"), strict=strict), recorder.emit)
            for role in Role
        }
        world = environment if known is None else RegisteredEnvironment(environment, known)
        agent = build_agent(configuration, world, [recorder], models)
        agent.run(spec, None if known is None else known.building)
    finally:
        recorder.close()
        environment.close()
    return _compare(lines, list(read_events(out)), len(calls), out)


def find_episode(record: Path, episode_id: str | None = None) -> Path:
    """The episode's directory in a record.

    Args:
        record: of an episode, or of a run.
        episode_id: which episode of a run; not needed when it has one.

    Raises:
        UsageError: there is none, or it is not clear which.
    """
    if (record / "events.jsonl").exists():
        return record
    found = sorted(path.parent for path in (record / "episodes").glob("*/events.jsonl"))
    if episode_id is not None:
        found = [path for path in found if path.name == episode_id]
    if len(found) == 1:
        return found[0]
    if not found:
        raise UsageError(f"{str(record)!r} holds no such episode: give the directory of a run or of one of its episodes.")
    raise UsageError(f"{str(record)!r} holds {len(found)} episodes: add --episode, e.g. --episode {found[0].name}.")


def _configuration(episode: Path) -> Configuration:
    run = read_file(episode.parent.parent / "run.json", RunFile)
    try:
        configuration = Configuration.model_validate(run.configuration)
    except ValidationError as error:
        raise _elsewhere(episode) from error
    if not isinstance(configuration.environment, HousesSettings):
        raise _elsewhere(episode)
    if configuration.driver != "agent":
        raise UsageError(f"{str(episode)!r} was driven by {configuration.driver!r}: give a record of the agent.")
    return configuration


def _elsewhere(episode: Path) -> UsageError:
    return UsageError(
        f"{str(episode)!r} was not recorded in an embedded house, and nothing else can be rebuilt for a replay: "
        "look at it with `spacevln view`."
    )


def _spec(lines: Sequence[EventLine], episode: Path) -> EpisodeSpec:
    start = next((line for line in lines if isinstance(line, EpisodeStartedLine)), None)
    if start is None:
        raise RecordError(f"{str(episode)!r} has no episode_started line: its episode never began.")
    task = InstructionTask(start.task_text) if start.task_kind == "vln" else ObjectGoalTask(start.task_text)
    return EpisodeSpec(start.episode_id, start.scene, start.start, task)


def _call(line: ModelCalledLine) -> RecordedCall:
    return RecordedCall(line.role, line.digest, line.reply, line.problem, line.detail)


def _compare(recorded: Sequence[EventLine], replayed: Sequence[EventLine], calls: int, out: Path) -> ReplayReport:
    before, after = list(_steps(recorded)), list(_steps(replayed))
    same = 0
    while same < min(len(before), len(after)) and before[same] == after[same]:
        same += 1
    pairs = zip_longest(_canonical(recorded), _canonical(replayed), fillvalue="nothing")
    difference = next(((first, second) for first, second in pairs if first != second), None)
    return ReplayReport(same, len(before), len(after), calls, difference, out)


def _steps(lines: Sequence[EventLine]) -> Iterator[str]:
    for line in lines:
        if isinstance(line, StepTakenLine):
            yield json.dumps([line.action, line.phase, line.motion.moved_m, line.motion.turned_rad, line.motion.collided])


def _canonical(lines: Sequence[EventLine]) -> Iterator[str]:
    """The lines without times, names of pictures, and what only tells of the network."""
    for line in lines:
        if not isinstance(line, CallRetriedLine):
            yield json.dumps(_lasting(line.model_dump(mode="json")), ensure_ascii=False)


def _lasting(data: dict[str, Any]) -> dict[str, Any]:
    kept = {name: value for name, value in data.items() if name not in _VOLATILE}
    if data["event"] == "episode_started":
        kept |= {"camera": None, "T_body_camera": None}  # records before 1.2 have none
    if data["event"] == "step_taken":
        kept |= {"rgb": None, "depth": None, "external": None}
    if data["event"] == "model_called":
        kept["messages"] = None  # the digest tells
        kept["schema_file"] = None
        kept["reply"] = {name: value for name, value in (data["reply"] or {}).items() if name not in _WEATHER}
    return kept
