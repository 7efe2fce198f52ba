"""What a planner and an executor saw, read back from an episode's record: prompts can be looked at without a model.

The record holds all that a prompt shows. Two things are not in it and stay empty: the sightings of a stage's very first image,
where no turn preceded it, and the metric map behind the pictures, which no prompt reads.
"""

from __future__ import annotations

from pathlib import Path
from typing import TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.assembly.configuration import Configuration
from spacevln.control import ControlSettings, default_step_limit
from spacevln.core import (
    Action,
    Camera,
    EgocentricMemory,
    ExecutedDecision,
    ExecutorContext,
    Feedback,
    InstructionTask,
    MoveForward,
    ObjectGoalTask,
    Observation,
    PlannerContext,
    RecordError,
    StageEnd,
    StageRecord,
    Stop,
    Subtask,
    Task,
    TurnLeft,
    TurnRight,
    View,
)
from spacevln.mapping import MetricMap
from spacevln.recording import read_events
from spacevln.recording.schema import (
    DecisionMadeLine,
    EpisodeStartedLine,
    ExecutedLine,
    LookedAroundLine,
    MemoryLine,
    StageEndedLine,
    StepTakenLine,
    SubtaskIssuedLine,
    ViewLine,
)

L = TypeVar("L", LookedAroundLine, DecisionMadeLine, SubtaskIssuedLine, StageEndedLine)


class RecordedSituations:
    """The planning boundaries and executor queries of a recorded episode.

    Args:
        directory: of the episode, recorded at level full.
        configuration: of its run.
        camera: of its body; the size of the pictures is the record's.

    Raises:
        RecordError: the record cannot be read.
    """

    def __init__(self, directory: Path, configuration: Configuration, camera: Camera) -> None:
        self._directory, self._configuration = directory, configuration
        self._hfov_deg, self._height_m = camera.hfov_deg, camera.height_m
        self._lines = tuple(read_events(directory))

    def planner(self, stage: int) -> PlannerContext:
        """What the planner saw at the beginning of a stage.

        Raises:
            RecordError: there is no such stage, or its pictures were not kept.
        """
        place, looked = self._only(LookedAroundLine, stage, f"no stage {stage}")
        steps = [line for line in self._lines[:place] if isinstance(line, StepTakenLine)]
        verified = stage > 0 and self._configuration.components.stagewise
        task = self._task
        return PlannerContext(
            task=task,
            stage=stage,
            views=tuple(map(self._view, looked.views)),
            memory=self._memory(looked.memory),
            feedback=self._feedback(stage - 1) if verified else None,
            last_subtask=self._subtask(stage - 1) if verified else None,
            pose=steps[-1].pose,
            space=MetricMap(),
            steps_left=(self._configuration.step_budget or default_step_limit(task)) - len(steps),
        )

    def executor(self, stage: int, decision: int) -> ExecutorContext:
        """What the executor saw before a decision of a stage, counted from 1.

        Raises:
            RecordError: there is no such decision, or its picture was not kept.
        """
        place, made = self._only(DecisionMadeLine, stage, f"no decision {decision} in stage {stage}", decision)
        image = next(line for line in reversed(self._lines[:place]) if isinstance(line, StepTakenLine))
        rgb = self._picture(image.rgb)
        ended = [line for line in self._lines if isinstance(line, StageEndedLine) and line.stage == stage]
        done = tuple(map(_executed, ended[0].decisions[: decision - 1])) if ended else ()
        height, width = rgb.shape[:2]
        camera = Camera(width, height, self._hfov_deg, self._height_m)
        return ExecutorContext(
            observation=Observation(rgb, np.zeros((height, width), np.float32), image.pose, camera),
            obstacles=made.obstacles,
            pool=made.pool,
            subtask=self._subtask(stage),
            progress=StageRecord(ended[0].start if ended else image.pose, done),
            admissible=made.admissible,
            space=MetricMap(),
            decisions_left=ControlSettings().stage_decisions - decision + 1,
            sightings=made.sightings or image.sightings,  # older records have them with the step alone
        )

    @property
    def _task(self) -> Task:
        started = next((line for line in self._lines if isinstance(line, EpisodeStartedLine)), None)
        if started is None:
            raise RecordError(f"{str(self._directory)!r} holds no started episode: give the directory of an episode.")
        return InstructionTask(started.task_text) if started.task_kind == "vln" else ObjectGoalTask(started.task_text)

    def _only(self, kind: type[L], stage: int, missing: str, decision: int | None = None) -> tuple[int, L]:
        """Place and line of this kind in this stage."""
        for place, line in enumerate(self._lines):
            if isinstance(line, kind) and line.stage == stage and (decision is None or _number(line) == decision):
                return place, line
        raise RecordError(f"{str(self._directory)!r} holds {missing}: give another number.")

    def _subtask(self, stage: int) -> Subtask:
        return self._only(SubtaskIssuedLine, stage, f"no subtask of stage {stage}")[1].subtask

    def _feedback(self, stage: int) -> Feedback:
        _, ended = self._only(StageEndedLine, stage, f"no end of stage {stage}")
        record = StageRecord(ended.start, tuple(map(_executed, ended.decisions)))
        return Feedback(self._subtask(stage), record, ended.pool, StageEnd(ended.end))

    def _memory(self, line: MemoryLine | None) -> EgocentricMemory | None:
        if line is None:
            return None
        return EgocentricMemory(
            pose=line.pose,
            floor=line.floor,
            region=line.region,
            waypoints=line.waypoints,
            chain=line.chain,
            text=line.text,
            map_image=None if line.map_image is None else self._picture(line.map_image),
            frontiers=line.frontiers,
        )

    def _view(self, line: ViewLine) -> View:
        rgb = None if line.rgb is None else self._picture(line.rgb)  # None: not turned to
        return View(line.label, line.heading_rad, rgb, line.obstacle_m, line.sightings)

    def _picture(self, name: str | None) -> NDArray[np.uint8]:
        """(H, W, 3) RGB."""
        path = self._directory / (name or "no picture")
        picture = cv2.imread(str(path)) if path.is_file() else None
        if picture is None:
            raise RecordError(f"The picture {str(path)!r} is missing: prompts need a record of level full.")
        return np.ascontiguousarray(picture[..., ::-1], np.uint8)


def _number(line: object) -> int | None:
    return line.decision if isinstance(line, DecisionMadeLine) else None


def _executed(line: ExecutedLine) -> ExecutedDecision:
    return ExecutedDecision(
        asked=_action(line.asked),
        purpose=line.purpose,
        moved_m=line.moved_m,
        turned_rad=line.turned_rad,
        primitives=line.primitives,
        stalled=line.stalled,
        interrupted=line.interrupted,
    )


def _action(words: str) -> Action:
    """The action that :func:`~spacevln.core.describe` wrote."""
    match words.split():
        case ["forward", distance]:
            return MoveForward(float(distance))
        case ["left", angle]:
            return TurnLeft(float(angle))
        case ["right", angle]:
            return TurnRight(float(angle))
        case _:
            return Stop()
