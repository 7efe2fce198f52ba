"""The paper's real-robot protocol: routes with instruction variants by setting, judged by where the robot stopped."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, ValidationError

from spacevln.core import EpisodeSpec, InstructionTask, PrerequisiteError, UsageError
from spacevln.core import Pose as CorePose
from spacevln.recording.record import Record

OVERALL = "Overall"


class _Settings(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Route(_Settings):
    """One route.

    Args:
        id: unique.
        setting: e.g. ``"Hall"``.
        instructions: its language variants.
        goal_m: (x, y) of the goal in the frame of the start (x forward, y left); for an embedded house in the scene's frame.
        scene, start: of an embedded house; ``start`` is x, y, z [m] and yaw [rad] in its frame.
    """

    id: str = Field(min_length=1)
    setting: str = Field(min_length=1)
    instructions: tuple[str, ...] = Field(min_length=1)
    goal_m: tuple[float, float]
    scene: str | None = None
    start: tuple[float, float, float, float] | None = None


class Routes(_Settings):
    """A routes file; success is a stop within ``radius_m`` of the goal (2 m, paper)."""

    name: str
    radius_m: PositiveFloat = 2.0
    routes: tuple[Route, ...] = Field(min_length=1)


@dataclass(frozen=True, slots=True)
class Trial:
    """One instruction of one route."""

    route: Route
    variant: int

    @property
    def spec(self) -> EpisodeSpec:
        """What the agent gets."""
        start = CorePose(*self.route.start) if self.route.start is not None else CorePose(0.0, 0.0)
        task = InstructionTask(self.route.instructions[self.variant])
        return EpisodeSpec(f"{self.route.id}-{self.variant + 1}", self.route.scene or "robot", start, task)


class Row(Record):
    """The outcome of a trial.

    ``NE_m`` is the horizontal distance from the stop to the goal, told by ``judged_by``; ``seconds`` are the robot's own.
    Null is what the judge cannot know: ``idle_share`` and ``held_s`` of the ideal simulator, contacts of a real robot.
    """

    episode_id: str
    setting: str
    status: str
    stopped: bool
    NE_m: float
    success: bool
    judged_by: str
    seconds: float
    first_motion_s: float | None = None
    idle_share: float | None = None
    held_s: float | None = None
    contacts: int | None = None
    hardest_contact_m_s: float | None = None


def load_routes(path: Path) -> Routes:
    """Read a YAML routes file.

    Raises:
        PrerequisiteError: the YAML reader of the extra ``robot`` is not installed.
        UsageError: the file is not one.
    """
    try:
        from ruamel.yaml import YAML, YAMLError
    except ImportError as error:
        raise PrerequisiteError("Routes are YAML files, whose reader is missing: run pip install 'spacevln[robot]'.") from error
    try:
        return Routes.model_validate(YAML(typ="safe").load(path.read_text(encoding="utf-8")))
    except (OSError, YAMLError) as error:
        raise UsageError(f"The routes {str(path)!r} cannot be read ({str(error).splitlines()[0]}): give a YAML file.") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "its top"
        raise UsageError(f"The routes {str(path)!r} are wrong at {where!r}: {first['msg']}; see docs/robot.md.") from error


def trials(routes: Routes) -> Iterator[Trial]:
    """Every variant of every route, in order."""
    for route in routes.routes:
        for variant in range(len(route.instructions)):
            yield Trial(route, variant)


def table(name: str, rows: Sequence[Row]) -> str:
    """The paper's table as Markdown: NE [m] and SR with counts, by setting and overall."""
    settings = list(dict.fromkeys(row.setting for row in rows))
    head, cells = ["Method"], [name]
    for setting in (*settings, OVERALL):
        chosen = [row for row in rows if setting in (row.setting, OVERALL)]
        reached = sum(row.success for row in chosen)
        head += [f"{setting} NE", f"{setting} SR"]
        cells += [
            f"{sum(row.NE_m for row in chosen) / len(chosen):.2f}",
            f"{100 * reached / len(chosen):.0f} ({reached}/{len(chosen)})",
        ]
    return "\n".join(f"| {' | '.join(line)} |" for line in (head, ["---"] * len(head), cells))
