"""An episode as a log for the Rerun viewer: camera, depth, map, graph, landmarks, way and words on one timeline."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from spacevln.core import PrerequisiteError, RecordError
from spacevln.recording import read_events
from spacevln.recording.schema import EpisodeStartedLine, StepTakenLine
from spacevln.viewer.scenes import Scenes
from spacevln.viewer.topdown import FREE, GOAL, OBSTACLE, REGION_COLOURS, SHORTEST, WALKED

if TYPE_CHECKING:
    import rerun

Json = dict[str, Any]
LANDMARK, LINK = (180, 83, 9), (20, 110, 120)
LIFT = np.array([0.0, 0.0, 0.05])
"""Lines on the floor are drawn this high [m]."""
WALL_M = 0.5
"""Height at which cells of obstacles are drawn."""


def write_spatial_log(directory: Path, out: Path) -> Path:
    """Write an episode's ``.rrd`` for the Rerun viewer.

    Args:
        directory: of the episode's record.
        out: the file.

    Raises:
        PrerequisiteError: the Rerun SDK is not installed.
        RecordError: the record holds no step, or the file cannot be written.
    """
    try:
        import rerun
    except ImportError as error:
        raise PrerequisiteError("A spatial log needs the Rerun SDK: pip install 'spacevln[rerun]'.") from error
    scenes = Scenes(directory)
    if not scenes.steps:
        raise RecordError(f"{str(directory)!r} holds no step: there is nothing to log.")
    try:
        out.touch()
    except OSError as error:
        raise RecordError(f"Cannot write {str(out)!r} ({error.strerror}): give a writable --out.") from error
    stream = rerun.RecordingStream("spacevln", recording_id=directory.resolve().name)
    stream.save(out, default_blueprint=_blueprint(filmed=any(step["external"] for step in scenes.steps)))
    _Log(stream, scenes, directory).write()
    stream.flush()
    stream.disconnect()
    return out


def _blueprint(*, filmed: bool) -> rerun.blueprint.Blueprint:
    from rerun import blueprint as show

    return show.Blueprint(
        show.Horizontal(
            show.Spatial3DView(origin="world", name="Map and memory"),
            show.Vertical(
                show.Spatial2DView(origin="world/camera/image", name="What it sees"),
                *([show.Spatial2DView(origin="outside", name="External camera")] if filmed else []),
                show.Tabs(
                    show.TextLogView(origin="words", name="Decisions"),
                    show.TextDocumentView(origin="memory", name="Spatial memory"),
                    show.TimeSeriesView(origin="obstacles", name="Obstacle distances"),
                ),
            ),
            column_shares=[3, 2],
        ),
        collapse_panels=True,
    )


class _Log:
    """One pass over a story; everything is logged at the step after which it is known."""

    def __init__(self, stream: rerun.RecordingStream, scenes: Scenes, directory: Path) -> None:
        import rerun

        self._rerun = rerun
        self._stream = stream
        self._scenes = scenes
        self._directory = directory
        self._started: EpisodeStartedLine | None = None
        self._taken: list[StepTakenLine] = []
        for line in read_events(directory):
            if isinstance(line, EpisodeStartedLine):
                self._started = line
            elif isinstance(line, StepTakenLine):
                self._taken.append(line)

    def write(self) -> None:
        self._constants()
        looked = {stage["planned"]: number for number, stage in enumerate(self._scenes.stages) if "planned" in stage}
        ended = {stage["last"]: number for number, stage in enumerate(self._scenes.stages) if "last" in stage}
        told = -1
        for index, taken in enumerate(self._taken):
            self._stream.set_time("step", sequence=taken.step)
            self._stream.set_time("time", duration=taken.time_s)
            self._body(index, taken)
            self._map(index)
            if index in looked:
                self._boundary(looked[index], index)
            step = self._scenes.steps[index]
            if step["decision"] is not None and step["decision"] != told:
                told = step["decision"]
                self._decision(self._scenes.story["decisions"][told])
            if index in ended:
                self._say(
                    f"Stage {ended[index] + 1} ended by {self._scenes.stages[ended[index]].get('end', 'nothing')}.", "TRACE"
                )

    def _constants(self) -> None:
        show, log, story = self._rerun, self._stream.log, self._scenes.story
        log("world", show.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
        log("task", show.TextDocument(self._scenes.task), static=True)
        if story["shortest"]:
            way = np.array(story["shortest"]) + LIFT
            log("world/truth/shortest_path", show.LineStrips3D([way], colors=[SHORTEST], radii=0.02), static=True)
        if story["goals"]:
            goals = show.Points3D(story["goals"], colors=[GOAL], radii=0.12, labels=["goal"] * len(story["goals"]))
            log("world/truth/goal", goals, static=True)
        lines = {"left": SHORTEST, "front": WALKED, "right": GOAL}
        for side, colour in lines.items():
            log(f"obstacles/{side}", show.SeriesLines(colors=[colour], names=[f"{side} [m]"]), static=True)
        if self._started is None or self._started.camera is None:
            self._say("The record is older than format 1.2: it does not hold the camera, so there is no depth.", "WARN")

    def _body(self, index: int, taken: StepTakenLine) -> None:
        show, log = self._rerun, self._stream.log
        pose = taken.pose
        forward = [0.4 * np.cos(pose.yaw_rad), 0.4 * np.sin(pose.yaw_rad), 0.0]
        log("world/agent", show.Arrows3D(origins=[pose.position_m], vectors=[forward], colors=[WALKED], radii=0.04))
        places = [self._scenes.story["start"], *(step["at"] for step in self._scenes.steps[: index + 1])]
        way = np.array(places)[:, :3] + LIFT
        log("world/trajectory", show.LineStrips3D([way], colors=[WALKED], radii=0.02))
        path = None if taken.rgb is None else self._directory / taken.rgb
        if path is None or not path.exists():
            return
        with Image.open(path) as picture:
            width, height = picture.size
        self._camera(taken, width, height)
        if taken.external is not None and (self._directory / taken.external).exists():
            log("outside", show.EncodedImage(path=self._directory / taken.external))
        log("world/camera/image", show.EncodedImage(path=path))
        boxes = self._scenes.steps[index]["boxes"]
        scale = width / self._scenes.story["frame"][0]
        corners = scale * np.array([found["box"] for found in boxes], np.float64).reshape(-1, 4)
        labels = [found["name"] for found in boxes]
        log("world/camera/image/boxes", show.Boxes2D(array=corners, array_format=show.Box2DFormat.XYXY, labels=labels))

    def _camera(self, taken: StepTakenLine, width: int, height: int) -> None:
        """Pose, intrinsics for a picture of this size, and depth where it was recorded."""
        started = self._started
        if started is None or started.camera is None or started.T_body_camera is None:
            return
        show, log, camera = self._rerun, self._stream.log, started.camera
        T_world_camera = taken.pose.T_world_body @ np.array(started.T_body_camera)
        log("world/camera", show.Transform3D(translation=T_world_camera[:3, 3], mat3x3=T_world_camera[:3, :3]))
        k = width / camera.width_px
        eye = show.Pinhole(
            focal_length=[k * camera.fx_px, k * camera.fy_px],
            principal_point=[k * camera.cx_px, k * camera.cy_px],
            resolution=[width, height],
            camera_xyz=show.ViewCoordinates.FLU,
            image_plane_distance=0.4,
        )
        log("world/camera/image", eye)
        if taken.depth is not None and (self._directory / taken.depth).exists():
            with Image.open(self._directory / taken.depth) as picture:
                depth_mm = np.asarray(picture).astype(np.uint16)
            log("world/camera/image/depth", show.DepthImage(depth_mm, meter=1000.0))

    def _map(self, index: int) -> None:
        """The cells that come into sight with this step; they stay."""
        for floor, cells, colours in self._uncovered(index):
            points = self._rerun.Points3D(cells, colors=colours, radii=0.5 * floor["resolution"])
            self._stream.log(f"world/map/floor_{floor['floor']}/step_{index:04d}", points)

    def _uncovered(self, index: int) -> Iterator[tuple[Json, NDArray[np.float64], NDArray[np.uint8]]]:
        for floor in self._scenes.story["floors"]:
            cells, regions, seen = self._scenes.layers(floor)
            new = (cells > 0) & ((seen == index + 1) | ((index == 0) & (seen == 0)))
            if not new.any():
                continue
            ij = np.argwhere(new)
            xy = ij[:, ::-1] * floor["resolution"] + np.array(floor["origin"]) + 0.5 * floor["resolution"]
            z = floor["z"] + np.where(cells[new] == 2, WALL_M, 0.0)
            colours = np.array([FREE, OBSTACLE], np.uint8)[cells[new] - 1]
            inside = (cells[new] == 1) & (regions[new] > 0)
            colours[inside] = np.array(REGION_COLOURS, np.uint8)[(regions[new][inside] - 1) % len(REGION_COLOURS)]
            yield floor, np.column_stack([xy, z]), colours

    def _boundary(self, number: int, index: int) -> None:
        """What the planner had and said."""
        show, log = self._rerun, self._stream.log
        stage = self._scenes.stages[number]
        for refused in stage["refused"]:
            self._say(f"{refused['role']} reply refused ({refused['kind']}): {refused['reason']}", "WARN")
        for fallback in stage["fallbacks"]:
            self._say(f"Fallback ({fallback['kind']}): {fallback['detail']}", "WARN")
        subtask, memory = stage.get("subtask"), stage.get("memory")
        if memory is not None:
            log("memory", show.TextDocument(memory["text"]))
            self._graph(memory, index)
        if subtask is not None:
            self._say(f"Stage {number + 1}, {subtask['direction']}: {subtask['instruction']}", "INFO")
            self._say(f"{subtask['thought']['decision']}", "TRACE")

    def _graph(self, memory: Json, index: int) -> None:
        show, log = self._rerun, self._stream.log
        known = {each["index"]: each for each in self._scenes.story["waypoints"] if each["step"] <= index + 1}
        places = {number: np.array(each["at"][:3]) + 2 * LIFT for number, each in known.items()}
        labels = [f"{number} {each['region']}" for number, each in known.items()]
        log("world/graph/waypoints", show.Points3D(list(places.values()), labels=labels, colors=[WALKED], radii=0.1))
        links = [[places[a], places[b]] for a, b in memory["links"] if a in places and b in places]
        log("world/graph/edges", show.LineStrips3D(links, colors=[LINK], radii=0.03))
        chain = [places[number] for number in memory["chain"] if number in places]
        log("world/graph/chain", show.LineStrips3D([chain] if len(chain) > 1 else [], colors=[WALKED], radii=0.015))

    def _decision(self, decision: Json) -> None:
        show, log = self._rerun, self._stream.log
        self._say(f"{decision['action']}: {decision['thought']['action']}", "DEBUG")
        for side, value in zip(("left", "front", "right"), decision["obstacles"], strict=True):
            if value is not None:
                log(f"obstacles/{side}", show.Scalars(value))
        pool = decision["pool"]
        labels = [f"{each['name']} {each['confidence']:.2f}" for each in pool]
        places = np.array([each["at"] for each in pool], np.float64).reshape(-1, 3)
        log("world/landmarks", show.Points3D(places, labels=labels, colors=[LANDMARK], radii=0.1))

    def _say(self, text: str, level: str) -> None:
        self._stream.log("words", self._rerun.TextLog(text, level=level))
