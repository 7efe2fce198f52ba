"""An episode's record as the one JSON object that its page shows; nothing here is judged or measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from spacevln.core import LandmarkCandidate, Pose, Sighting
from spacevln.recording import EventLine, ResultFile, usage_of
from spacevln.recording.calls import CallRetriedLine, ImageLine, ModelCalledLine, TextFileLine, TextLine
from spacevln.recording.schema import (
    DecisionMadeLine,
    EpisodeEndedLine,
    EpisodeStartedLine,
    ExecutedLine,
    FallbackUsedLine,
    FloorMapLine,
    GateAskedLine,
    LookedAroundLine,
    MapSavedLine,
    MemoryLine,
    ReplyRefusedLine,
    StageEndedLine,
    StepTakenLine,
    SubtaskIssuedLine,
    WaypointAddedLine,
)
from spacevln.viewer.pages.ground import layer

Json = dict[str, Any]
FRAME_PX = (640, 480)
"""Frame of the boxes where no image and no box says more."""


class Story:
    """Collects the lines of an episode. ``read`` fills it; ``json`` is what the page gets.

    Args:
        directory: of the episode's record, where long texts of prompts are read.
    """

    def __init__(self, directory: Path) -> None:
        self._directory = directory
        self.started: EpisodeStartedLine | None = None
        self.ended: EpisodeEndedLine | None = None
        self.poses: list[Pose] = [Pose(0.0, 0.0)]
        self.steps: list[Json] = []
        self.stages: list[Json] = []
        self.decisions: list[Json] = []
        self.waypoints: list[Json] = []
        self.texts: dict[str, str] = {}
        self._floors: tuple[FloorMapLine, ...] = ()
        self._step_of_image: dict[str, int] = {}
        self._width_px, self._height_px = 0, 0
        self._lines: list[EventLine] = []

    def read(self, lines: Iterable[EventLine]) -> Story:
        """Take in a record, complete or not."""
        for line in lines:
            self._lines.append(line)
            self._take(line)
        return self

    def json(self, result: ResultFile | None) -> Json:
        """What the page shows; coordinates in the episode frame, metres and radians rounded."""
        origin = self.started.T_scene_episode if self.started else Pose(0.0, 0.0)
        truth = result.truth if result else None
        return {
            "frame": [self._width_px or FRAME_PX[0], self._height_px or FRAME_PX[1]],
            "start": _pose(self.poses[0]),
            "steps": self.steps,
            "stages": self.stages,
            "decisions": self.decisions,
            "waypoints": self.waypoints,
            "floors": [layer(self._directory, line, self.poses, self._height(line.floor)) for line in self._floors],
            "decisive": self._index_of(result.diagnosis.step) if result and result.diagnosis else None,
            "goals": to_episode(truth.goals, origin) if truth else [],
            "shortest": to_episode(truth.shortest_path, origin) if truth else [],
            "texts": self.texts,
        }

    def _index_of(self, step: int | None) -> int | None:
        return next((index for index, taken in enumerate(self.steps) if taken["step"] == step), None)

    def _height(self, floor: int) -> float:
        """Height of a floor: that of the waypoints on it, else of the start."""
        on_it = [waypoint["at"][2] for waypoint in self.waypoints if waypoint["floor"] == floor]
        if on_it:
            return float(np.median(on_it))
        heights = [pose.z_m for pose in self.poses]
        return 0.0 if floor == 0 else max(heights) if floor > 0 else min(heights)

    def _stage(self, number: int) -> Json:
        while len(self.stages) <= number:
            self.stages.append(
                {"first": len(self.steps), "views": [], "refused": [], "fallbacks": [], "gates": [], "calls": [], "retries": []}
            )
        return self.stages[number]

    def _take(self, line: EventLine) -> None:
        match line:
            case EpisodeStartedLine():
                self.started = line
                self.poses[0] = line.start.relative_to(line.T_scene_episode)
            case StepTakenLine():
                self._step(line)
            case LookedAroundLine():
                self._looked(line)
            case SubtaskIssuedLine():
                self._subtask(line)
            case WaypointAddedLine(waypoint=waypoint):
                self.waypoints.append(
                    {
                        "index": waypoint.index,
                        "at": _pose(waypoint.pose),
                        "floor": waypoint.floor,
                        "region": waypoint.region,
                        "text": waypoint.text,
                        "step": len(self.steps),
                    }
                )
            case DecisionMadeLine():
                self._decision(line)
            case StageEndedLine():
                self._stage_end(line)
            case ReplyRefusedLine(role=role, kind=kind, reason=reason):
                self._stage(line.stage)["refused"].append({"role": role, "kind": kind, "reason": reason})
            case FallbackUsedLine(kind=kind, detail=detail):
                self._stage(line.stage)["fallbacks"].append({"kind": kind, "detail": detail})
            case GateAskedLine(accepted=accepted, clauses=clauses):
                self._stage(line.stage)["gates"].append({"accepted": accepted, "clauses": [list(clause) for clause in clauses]})
            case ModelCalledLine():
                self._stage(line.stage)["calls"].append(self._call(line))
            case CallRetriedLine():
                retry = {"role": line.role.value, "kind": line.kind, "detail": line.detail, "wait": line.wait_s}
                self._stage(max(0, len(self.stages) - 1))["retries"].append(retry)
            case MapSavedLine(floors=floors):
                self._floors = floors
            case EpisodeEndedLine():
                self.ended = line

    def _boxes(self, sightings: Sequence[Sighting]) -> list[Json]:
        boxes = []
        for sighting in sightings:
            self._width_px = max(self._width_px, sighting.box_px[2])
            self._height_px = max(self._height_px, sighting.box_px[3])
            name = " ".join((*sighting.attributes, sighting.category))
            boxes.append({"name": name, "box": list(sighting.box_px), "m": _short(sighting.distance_m)})
        return boxes

    def _step(self, line: StepTakenLine) -> None:
        stage = self._stage(line.stage)
        stage["last"] = len(self.steps)
        if line.rgb is not None:
            self._step_of_image[line.rgb] = len(self.steps)
        before = self.steps[-1] if self.steps else None
        still = before if line.rgb is None and line.phase == "stop" else None  # nothing moved: what was seen is still seen
        deciding = line.phase in ("execute", "stop") and bool(self.decisions) and self.decisions[-1]["stage"] == line.stage
        self.poses.append(line.pose)
        self.steps.append(
            {
                "step": line.step,
                "stage": line.stage,
                "phase": line.phase,
                "action": line.action,
                "moved": _short(line.motion.moved_m),
                "turned": _degrees(line.motion.turned_rad),
                "collided": line.motion.collided,
                "at": _pose(line.pose),
                "rgb": still["rgb"] if still else line.rgb,
                "external": still["external"] if still else line.external,
                "boxes": still["boxes"] if still else self._boxes(line.sightings),
                "decision": len(self.decisions) - 1 if deciding else None,
                "time": line.time_s,
            }
        )

    def _looked(self, line: LookedAroundLine) -> None:
        stage = self._stage(line.stage)
        for view in line.views:
            boxes = self._boxes(view.sightings)
            step = self._step_of_image.get(view.rgb) if view.rgb else None
            if step is not None and not self.steps[step]["boxes"]:
                self.steps[step]["boxes"] = boxes
            stage["views"].append(
                {"label": view.label, "heading": _degrees(view.heading_rad), "rgb": view.rgb, "m": _short(view.obstacle_m),
                 "boxes": boxes, "step": step}
            )  # fmt: skip
        stage["planned"] = max(stage["first"], len(self.steps) - 1)
        stage["memory"] = None if line.memory is None else _memory(line.memory)

    def _subtask(self, line: SubtaskIssuedLine) -> None:
        subtask = line.subtask
        self._stage(line.stage)["subtask"] = {
            "chain": [
                {"text": str(anchor), "kind": anchor.space_kind.value, "status": subtask.status(index).value}
                for index, anchor in enumerate(subtask.chain)
            ],
            "current": str(subtask.current_anchor),
            "next": None if subtask.next_anchor is None else str(subtask.next_anchor),
            "direction": subtask.direction,
            "instruction": subtask.instruction,
            "landmark": subtask.landmark,
            "complete": subtask.complete,
            "verdict": subtask.verdict.value,
            "target": None if subtask.target_m is None else [_short(value) for value in subtask.target_m],
            "thought": {name: getattr(line.thought, name) for name in ("observation", "memory", "progress", "decision", "plan")},
            "seconds": _short(line.seconds),
            "revision": line.revision,
        }

    def _decision(self, line: DecisionMadeLine) -> None:
        self.decisions.append(
            {
                "stage": line.stage,
                "number": line.decision,
                "action": line.action,
                "purpose": None if line.purpose is None else line.purpose.value,
                "thought": {name: getattr(line.thought, name) for name in ("view", "detection", "progress", "action")},
                "obstacles": [
                    _short(value) for value in (line.obstacles.left_30_m, line.obstacles.front_m, line.obstacles.right_30_m)
                ],
                "pool": [_candidate(candidate) for candidate in line.pool],
                "forward": list(line.admissible.forward_m),
                "left": line.admissible.left,
                "right": line.admissible.right,
                "reasons": list(line.admissible.reasons),
                "seconds": _short(line.seconds),
                "first": len(self.steps),
                "done": None,
            }
        )

    def _stage_end(self, line: StageEndedLine) -> None:
        stage = self._stage(line.stage)
        stage["end"] = line.end
        stage["pool"] = [_candidate(candidate) for candidate in line.pool]
        made = [decision for decision in self.decisions if decision["stage"] == line.stage]
        for decision, done in zip(made, line.decisions, strict=False):  # a killed run may lack the last ones
            decision["done"] = _done(done)

    def _call(self, line: ModelCalledLine) -> Json:
        reply = line.reply
        usage = usage_of([line]).get(line.role.value)
        return {
            "role": line.role.value,
            "model": line.model,
            "number": line.call,
            "problem": line.problem,
            "detail": line.detail,
            "reply": None if reply is None else reply.text,
            "seconds": None if reply is None else _short(reply.latency_s),
            "tokens": None if usage is None else [usage.tokens.input_tokens, usage.tokens.output_tokens],
            "usd": None if reply is None else reply.usd,
            "messages": [
                {"speaker": message.speaker.value, "parts": [self._part(part) for part in message.parts]}
                for message in line.messages
            ],
        }

    def _part(self, part: TextLine | TextFileLine | ImageLine) -> Json:
        match part:
            case TextLine(text=text):
                return {"text": text}
            case TextFileLine(file=file):
                path = self._directory / file
                if file not in self.texts and path.exists():
                    self.texts[file] = path.read_text(encoding="utf-8")
                return {"file": file}
            case ImageLine(name=name, file=picture):
                return {"name": name, "image": picture}


def to_episode(points: Iterable[tuple[float, float, float]], origin: Pose) -> list[list[float]]:
    """Points of the scene frame in the episode frame."""
    places = (Pose(x, y, z).relative_to(origin) for x, y, z in points)
    return [[round(place.x_m, 3), round(place.y_m, 3), round(place.z_m, 3)] for place in places]


def _memory(memory: MemoryLine) -> Json:
    links = {tuple(sorted(pair)) for arranged in memory.waypoints for pair in zip(arranged.path, arranged.path[1:], strict=False)}
    return {
        "region": memory.region,
        "floor": memory.floor,
        "text": memory.text,
        "image": _in_images(memory.map_image),
        "chain": list(memory.chain),
        "links": sorted(list(pair) for pair in links),
        "frontiers": [[_short(value) for value in frontier.position_m] for frontier in memory.frontiers],
    }


def _in_images(name: str | None) -> str | None:
    """The first records of format 1.0 name a map without its folder."""
    return name if name is None or "/" in name else f"images/{name}"


def _candidate(candidate: LandmarkCandidate) -> Json:
    return {
        "instance": candidate.instance,
        "name": " ".join((*candidate.attributes, candidate.category)),
        "at": [_short(value) for value in candidate.position_m],
        "m": _short(candidate.distance_m),
        "bearing": _degrees(candidate.bearing_rad),
        "confidence": _short(candidate.confidence),
        "visible": candidate.visible,
        "arrived": candidate.arrived,
        "kind": candidate.kind.value,
    }


def _done(line: ExecutedLine) -> Json:
    return {
        "moved": _short(line.moved_m),
        "turned": _degrees(line.turned_rad),
        "primitives": line.primitives,
        "stalled": line.stalled,
        "interrupted": line.interrupted,
    }


def _pose(pose: Pose) -> list[float]:
    return [round(pose.x_m, 3), round(pose.y_m, 3), round(pose.z_m, 3), round(pose.yaw_rad, 4)]


def _short(value: float) -> float | None:
    return round(value, 2) if math.isfinite(value) else None


def _degrees(angle_rad: float) -> int:
    return round(math.degrees(angle_rad))
