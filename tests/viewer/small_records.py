"""Small records written with the real recorder."""

from __future__ import annotations

import math
from pathlib import Path

import cv2
import numpy as np

from spacevln.core import (
    AdmissibleActions,
    Anchor,
    Camera,
    ChatReply,
    CueKind,
    EpisodeStatus,
    ExecutorThought,
    LandmarkCandidate,
    Motion,
    ObstacleDistances,
    PlannerThought,
    Pose,
    Role,
    Sighting,
    SpaceKind,
    SpatialWaypoint,
    Speaker,
    StopReason,
    Subtask,
    Verdict,
)
from spacevln.recording import Diagnosis, Metrics, ResultFile, RunFile, SummaryFile, Truth, write_file
from spacevln.recording.calls import MessageLine, ModelCalledLine, TextLine
from spacevln.recording.schema import (
    DecisionMadeLine,
    EpisodeEndedLine,
    EpisodeStartedLine,
    FloorMapLine,
    LookedAroundLine,
    MapSavedLine,
    MemoryLine,
    ReplyRefusedLine,
    StageEndedLine,
    StepTakenLine,
    SubtaskIssuedLine,
    ViewLine,
    WaypointAddedLine,
)

LEVEL = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.88), (0.0, 0.0, 0.0, 1.0))
PAYLOAD = (
    "<script>document.title='broken'</script><img src=x onerror=\"document.title='broken'\">"
    "<svg onload=\"document.title='broken'\"></script><a href=\"javascript:document.title='broken'\">a</a>"
)
"""Text that would run if a page took it for markup."""


def write_run(directory: Path, episodes: int = 3, text: str = "Go on and stop.") -> Path:
    """A run of small episodes, every second of which failed."""
    directory.mkdir(parents=True, exist_ok=True)
    folder = directory / "episodes"
    results = [write_episode(folder / f"e-{number:03d}", text, good=number % 2 == 0, number=number) for number in range(episodes)]
    write_file(
        directory / "run.json",
        RunFile(
            version="1",
            suite="made-up",
            created="2026-01-01T00:00:00+00:00",
            command=("spacevln", "bench"),
            configuration={"driver": "agent", "planner": "rules", "executor": "rules"},
            configuration_hash="0",
            packages={},
            python="3",
            platform="here",
            git_revision=None,
        ),
    )
    failed = sum(result.diagnosis is not None for result in results)
    write_file(
        directory / "summary.json",
        SummaryFile(
            episodes=episodes,
            metrics={"SR": 50.0},
            statuses={"stopped": episodes},
            stop_reasons={"gate": episodes},
            rejections=0,
            fallbacks=0,
            unreachable=0,
            intervals={"SR": (10.0, 90.0)},
            diagnoses={"budget": failed},
            diagnoses_paper={"outside the paper": failed},
        ),
    )
    return directory


def write_episode(
    folder: Path, text: str, *, good: bool, number: int = 0, direction: str = "front", filmed: bool = False
) -> ResultFile:
    """Two stages of three steps each; ``filmed`` adds the pictures of an external camera."""
    (folder / "images").mkdir(parents=True)
    cells = np.zeros((60, 60, 3), np.uint8)
    cells[10:50, 10:50] = (0, 1, 1)
    cells[10:50, 10] = cells[10:50, 49] = (0, 0, 2)
    cv2.imwrite(str(folder / "images/map_floor_0.png"), cells)
    lines = [
        EpisodeStartedLine(
            time_s=0.0, episode_id=folder.name, scene="s", start=Pose(5.0, 5.0), task_kind="vln", task_text=text,
            camera=Camera(64, 48, 79.0, 0.88), T_body_camera=LEVEL,
        ),
        *(line for stage in range(2) for line in _stage(folder, stage, text, direction, filmed=filmed)),
        MapSavedLine(
            time_s=1.0,
            floors=(
                FloorMapLine(
                    floor=0, resolution_m=0.05, origin_m=(-1.5, -1.5), image="images/map_floor_0.png", region_names=(text,)
                ),
            ),
        ),
        EpisodeEndedLine(
            time_s=1.0, status=EpisodeStatus.STOPPED, stop_reason=StopReason.GATE, stopped=True, detail="", pose=Pose(1.0, 0.0),
            steps=6, lookaround_steps=0, align_steps=0, collisions=0, stages=2, seconds=1.0,
        ),
    ]  # fmt: skip
    (folder / "events.jsonl").write_text("".join(line.model_dump_json() + "\n" for line in lines), encoding="utf-8")
    result = ResultFile(
        episode_id=folder.name,
        scene="s",
        task_kind="vln",
        task_text=text,
        status=EpisodeStatus.STOPPED,
        stop_reason=StopReason.GATE,
        forced_stop=False,
        detail="",
        metrics=Metrics(
            SR=float(good), SPL=0.5, NE=0.1 * number, path_length=1.0, steps=6, lookaround_steps=0, align_steps=0, collisions=0,
            stages=2, rejections=0, fallbacks=0,
        ),
        truth=Truth(
            goals=((6.0, 5.0, 0.0),),
            shortest_path=((5.0, 5.0, 0.0), (6.0, 5.0, 0.0)),
            geodesic_m=1.0,
            final_distance_m=0.1,
        ),
        diagnosis=None if good else Diagnosis(name="budget", paper="outside the paper", reason=text, stage=1, step=5),
        timing_s=1.0 + number,
    )  # fmt: skip
    write_file(folder / "result.json", result)
    return result


def _stage(folder: Path, stage: int, text: str, direction: str, *, filmed: bool) -> list[object]:
    anchors = (Anchor(text, SpaceKind.ROOM), Anchor("hallway", SpaceKind.CONNECTOR))
    subtask = Subtask(anchors, 0, anchors[0], anchors[1], direction, text, text, complete=False, verdict=Verdict.FIRST)
    candidate = LandmarkCandidate(0, text, (1.0, 0.0, 0.5), 1.0, 0.1, 0.9, visible=True, arrived=False, kind=CueKind.SOLID)
    sighting = Sighting(text, 0.9, (10, 10, 60, 60), (1.0, 0.0, 0.5), 1.0, 0.1, 0.3)
    memory = MemoryLine(
        pose=Pose(0.0, 0.0), floor=0, region=text, waypoints=(), chain=(), text=text, map_image=None, frontiers=()
    )
    image = f"images/{3 * stage:04d}_rgb.jpg"
    seen = (
        ViewLine(label=label, heading_rad=math.radians(deg), rgb=image, obstacle_m=1.0, sightings=(sighting,))
        for label, deg in (("front", 0), ("left 30", 30))
    )
    views = (*seen, ViewLine(label="back", heading_rad=math.pi, rgb=None, obstacle_m=0.4, sightings=()))
    lines: list[object] = [
        LookedAroundLine(time_s=0.0, stage=stage, views=views, memory=memory),
        ModelCalledLine(
            time_s=0.0, call=stage + 1, stage=stage, role=Role.PLANNER, model=text, digest="0",
            messages=(MessageLine(speaker=Speaker.USER, static=False, parts=(TextLine(text=f"Asked: {text}"),)),),
            schema_name=None, schema_file=None, max_tokens=9, reply=ChatReply(f"Answered: {text}"), parsed=None, problem="",
            detail="",
        ),
        ReplyRefusedLine(time_s=0.0, stage=stage, role="planner", kind="direction", reason=text),
        SubtaskIssuedLine(
            time_s=0.0, stage=stage, subtask=subtask, thought=PlannerThought(*5 * (text,)), seconds=0.1, revision=""
        ),
        WaypointAddedLine(time_s=0.0, stage=stage, waypoint=SpatialWaypoint(stage, Pose(0.5 * stage, 0.0), 0, text, (), text)),
        DecisionMadeLine(
            time_s=0.0, stage=stage, decision=1, action="forward 0.25", purpose=None,
            thought=ExecutorThought(*4 * (text,)), obstacles=ObstacleDistances(1.0, 0.4, math.inf), pool=(candidate,),
            admissible=AdmissibleActions((0.25,), True, False, (text,)),
            seconds=0.1,
        ),
    ]  # fmt: skip
    for k in range(3):
        name = f"images/{3 * stage + k:04d}_rgb.jpg"
        cv2.imwrite(str(folder / name), np.full((48, 64, 3), 40 * k + 60, np.uint8))
        external = name.replace("rgb", "external") if filmed else None
        if external:
            cv2.imwrite(str(folder / external), np.full((48, 64, 3), (200, 40 * k, 90), np.uint8))
        lines.append(
            StepTakenLine(
                time_s=0.1, step=3 * stage + k + 1, stage=stage, phase="execute", action="forward 0.25",
                motion=Motion(0.17, 0.0, False),
                pose=Pose((3 * stage + k + 1) / 6, 0.0), rgb=name, depth=None, external=external, sightings=(sighting,),
            )
        )  # fmt: skip
    lines.append(
        StageEndedLine(time_s=0.2, stage=stage, end="arrival", start=Pose(0.0, 0.0), pose=Pose(1.0, 0.0), decisions=(), pool=())
    )
    return lines
