"""Writes an episode's record while it runs: one line per event, flushed at once; images beside it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import Literal, TextIO

import cv2
import numpy as np
from numpy.typing import NDArray

from spacevln.core import (
    CallRetried,
    DecisionMade,
    EgocentricMemory,
    EpisodeEnded,
    EpisodeStarted,
    Event,
    FallbackUsed,
    FloorMap,
    GateAsked,
    InstructionTask,
    LookedAround,
    MapSaved,
    ModelCalled,
    Pose,
    RecordError,
    ReplyRefused,
    StageEnded,
    StepTaken,
    SubtaskIssued,
    Task,
    View,
    WaypointAdded,
    describe,
)
from spacevln.recording import schema
from spacevln.recording.calls import CallRecorder
from spacevln.recording.record import Record


class RecordLevel(StrEnum):
    """How much is kept: ``full`` has depth and whole images, ``light`` neither (for long benchmarks)."""

    FULL = "full"
    LIGHT = "light"


LIGHT_WIDTH_PX = 320
EXTERNAL_WIDTH_PX, EXTERNAL_QUALITY = 360, 70
"""Of the pictures that show the robot from outside: shown small, at every level."""
JPEG_QUALITY = {RecordLevel.FULL: 90, RecordLevel.LIGHT: 70}
_ORIGIN = Pose(0.0, 0.0)
PNG_COMPRESSION = 1  # depth and maps are written while the agent waits; size matters less than time


def task_fields(task: Task) -> tuple[Literal["vln", "objectnav"], str]:
    """The (kind, text) pair under which a task is recorded."""
    return ("vln", task.instruction) if isinstance(task, InstructionTask) else ("objectnav", task.goal)


class EpisodeRecorder:
    """An event sink that writes ``events.jsonl`` and ``images/`` of one episode.

    Args:
        directory: of the episode; created, and an unfinished earlier attempt's events are replaced.
        level: how much to keep.
        external_view: gives the picture (H, W, 3) of a camera that shows the robot from outside, kept after every step.

    Raises:
        RecordError: the directory cannot be written.
    """

    def __init__(
        self,
        directory: Path,
        level: RecordLevel = RecordLevel.FULL,
        external_view: Callable[[], NDArray[np.uint8]] | None = None,
    ) -> None:
        self._directory = directory
        self._level = level
        self._external_view = external_view
        self._begin = time.monotonic()
        self._calls = CallRecorder(directory, pictures=level is RecordLevel.FULL)
        self._stage = 0
        self._image_of_rgb: dict[int, str] = {}
        try:
            (directory / "images").mkdir(parents=True, exist_ok=True)
            self._file: TextIO = (directory / "events.jsonl").open("w", encoding="utf-8")
        except OSError as error:
            raise RecordError(f"Cannot write the record {str(directory)!r} ({error.strerror}): give a writable --out.") from error

    def emit(self, event: Event) -> None:
        """Write one line."""
        try:
            line = self._line(event)
            self._file.write(line.model_dump_json() + "\n")
            self._file.flush()
        except OSError as error:
            raise RecordError(
                f"Cannot write the record {str(self._directory)!r} ({error.strerror}): free space and run again."
            ) from error

    def close(self) -> None:
        """Close the file. May be called twice."""
        self._file.close()

    def _line(self, event: Event) -> Record:
        t = round(time.monotonic() - self._begin, 3)
        match event:
            case EpisodeStarted():
                return _episode_start(event, t)
            case StepTaken():
                return self._step(event, t)
            case LookedAround(stage=stage, views=views, memory=memory):
                self._stage = stage
                return schema.LookedAroundLine(
                    time_s=t, stage=stage, views=tuple(map(self._view, views)), memory=self._memory(memory, stage)
                )
            case ReplyRefused(stage=stage, role=role, kind=kind, reason=reason):
                return schema.ReplyRefusedLine(time_s=t, stage=stage, role=role, kind=kind, reason=reason)
            case ModelCalled():
                return self._calls.called(event, self._stage, t)
            case CallRetried():
                return self._calls.retried(event, t)
            case SubtaskIssued(stage=stage, subtask=subtask, thought=thought, seconds=seconds, revision=revision):
                return schema.SubtaskIssuedLine(
                    time_s=t, stage=stage, subtask=subtask, thought=thought, seconds=seconds, revision=revision
                )
            case WaypointAdded(stage=stage, waypoint=waypoint):
                return schema.WaypointAddedLine(time_s=t, stage=stage, waypoint=waypoint)
            case DecisionMade():
                return _decision(event, t)
            case StageEnded():
                return _stage_end(event, t)
            case FallbackUsed(stage=stage, kind=kind, detail=detail):
                return schema.FallbackUsedLine(time_s=t, stage=stage, kind=kind, detail=detail)
            case GateAsked(stage=stage, accepted=accepted, clauses=clauses):
                return schema.GateAskedLine(time_s=t, stage=stage, accepted=accepted, clauses=clauses)
            case MapSaved(floors=floors):
                return schema.MapSavedLine(time_s=t, floors=tuple(map(self._floor_map, floors)))
            case EpisodeEnded():
                return _episode_end(event, t)

    def _step(self, event: StepTaken, t: float) -> schema.StepTakenLine:
        rgb = depth = external = None
        if event.observation is not None:
            rgb = self._write_rgb(f"{event.step:04d}_rgb.jpg", event.observation.rgb)
            self._image_of_rgb[id(event.observation.rgb)] = rgb
            if self._level is RecordLevel.FULL:
                depth = self._write_depth(f"{event.step:04d}_depth.png", event.observation.depth_m)
            if self._external_view is not None:
                picture = _narrow(self._external_view()[..., ::-1], EXTERNAL_WIDTH_PX)
                quality = [cv2.IMWRITE_JPEG_QUALITY, EXTERNAL_QUALITY]
                external = self._write(f"{event.step:04d}_external.jpg", picture, quality)
        return schema.StepTakenLine(
            time_s=t,
            step=event.step,
            stage=event.stage,
            phase=event.phase,
            action=describe(event.action),
            motion=event.motion,
            pose=event.pose,
            rgb=rgb,
            depth=depth,
            external=external,
            sightings=event.sightings,
        )

    def _view(self, view: View) -> schema.ViewLine:
        return schema.ViewLine(
            label=view.label,
            heading_rad=view.heading_rad,
            rgb=None if view.rgb is None else self._image_of_rgb.get(id(view.rgb)),
            obstacle_m=view.obstacle_m,
            sightings=view.sightings,
        )

    def _memory(self, memory: EgocentricMemory | None, stage: int) -> schema.MemoryLine | None:
        if memory is None:
            return None
        image = None
        if memory.map_image is not None:
            options = [cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION]
            image = self._write(f"stage_{stage:02d}_map.png", memory.map_image[..., ::-1], options)
        return schema.MemoryLine(
            pose=memory.pose,
            floor=memory.floor,
            region=memory.region,
            waypoints=memory.waypoints,
            chain=memory.chain,
            text=memory.text,
            map_image=image,
            frontiers=memory.frontiers,
        )

    def _floor_map(self, floor: FloorMap) -> schema.FloorMapLine:
        bgr = np.dstack([np.zeros_like(floor.cells), floor.regions, floor.cells])
        return schema.FloorMapLine(
            floor=floor.floor,
            resolution_m=floor.resolution_m,
            origin_m=floor.origin_m,
            image=self._write(f"map_floor_{floor.floor}.png", bgr, [cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION]),
            region_names=floor.region_names,
        )

    def _write_rgb(self, name: str, rgb: NDArray[np.uint8]) -> str:
        image: NDArray[np.uint8] = rgb[..., ::-1]
        if self._level is RecordLevel.LIGHT:
            image = _narrow(image, LIGHT_WIDTH_PX)
        return self._write(name, image, [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY[self._level]])

    def _write_depth(self, name: str, depth_m: NDArray[np.float32]) -> str:
        millimetres = np.clip(np.nan_to_num(depth_m, nan=0.0, posinf=0.0, neginf=0.0) * 1000 + 0.5, 0, 65535)
        return self._write(name, millimetres.astype(np.uint16), [cv2.IMWRITE_PNG_COMPRESSION, PNG_COMPRESSION])

    def _write(self, name: str, image: NDArray[np.uint8] | NDArray[np.uint16], options: list[int]) -> str:
        ok, data = cv2.imencode(Path(name).suffix, np.ascontiguousarray(image), options)
        if not ok:
            raise RecordError(f"Cannot encode the image {name!r} of shape {image.shape}.")
        (self._directory / "images" / name).write_bytes(data.tobytes())
        return f"images/{name}"


def _narrow(image: NDArray[np.uint8], width_px: int) -> NDArray[np.uint8]:
    """A picture (H, W, 3) at most so wide."""
    height, width = image.shape[:2]
    if width <= width_px:
        return image
    size = (width_px, round(height * width_px / width))
    return np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)


def _episode_start(event: EpisodeStarted, t: float) -> schema.EpisodeStartedLine:
    episode, seen = event.episode, event.observation
    kind, text = task_fields(episode.task)
    return schema.EpisodeStartedLine.model_validate(
        {
            "time_s": t,
            "episode_id": episode.episode_id,
            "scene": episode.scene,
            "start": episode.start,
            "origin": None if event.pose == _ORIGIN else episode.start.compose(_ORIGIN.relative_to(event.pose)),
            "task_kind": kind,
            "task_text": text,
            "camera": None if seen is None else seen.camera,
            "T_body_camera": None
            if seen is None
            else np.round(np.linalg.inv(seen.pose.T_world_body) @ seen.T_world_camera, 6).tolist(),
        }
    )


def _decision(event: DecisionMade, t: float) -> schema.DecisionMadeLine:
    return schema.DecisionMadeLine(
        time_s=t,
        stage=event.stage,
        decision=event.decision,
        action=describe(event.action),
        purpose=event.purpose,
        thought=event.thought,
        obstacles=event.obstacles,
        pool=event.pool,
        admissible=event.admissible,
        seconds=event.seconds,
        sightings=tuple(replace(each, surface_m=(), relief=()) for each in event.sightings),  # these stand with the step
    )


def _stage_end(event: StageEnded, t: float) -> schema.StageEndedLine:
    record = event.feedback.record
    decisions = tuple(
        schema.ExecutedLine(
            asked=describe(decision.asked),
            purpose=decision.purpose,
            moved_m=decision.moved_m,
            turned_rad=decision.turned_rad,
            primitives=decision.primitives,
            stalled=decision.stalled,
            interrupted=decision.interrupted,
        )
        for decision in record.decisions
    )
    return schema.StageEndedLine(
        time_s=t,
        stage=event.stage,
        end=event.feedback.end,
        start=record.start,
        pose=event.pose,
        decisions=decisions,
        pool=event.feedback.pool,
    )


def _episode_end(event: EpisodeEnded, t: float) -> schema.EpisodeEndedLine:
    return schema.EpisodeEndedLine(
        time_s=t,
        status=event.status,
        stop_reason=event.stop_reason,
        stopped=event.stopped,
        detail=event.detail,
        pose=event.pose,
        steps=event.steps,
        lookaround_steps=event.lookaround_steps,
        align_steps=event.align_steps,
        collisions=event.collisions,
        stages=event.stages,
        seconds=event.seconds,
    )
