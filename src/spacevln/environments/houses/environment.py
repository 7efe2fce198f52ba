"""The embedded environment: furnished houses with a body and an RGB-D camera in them."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spacevln.core.actions import Action, Motion, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.errors import ContractError
from spacevln.core.geometry import Pose
from spacevln.core.interfaces import EnvironmentSpec
from spacevln.core.sensing import Camera, Observation
from spacevln.core.task import EpisodeSpec
from spacevln.environments.houses.chase import ChaseCamera
from spacevln.environments.houses.labels import house_labels, image_labels
from spacevln.environments.houses.rendering import Drawable, DrawnBody, Renderer, RendererName, make_renderer, renderer_info
from spacevln.environments.houses.walking.motion import Body, Ground

_KEPT_SCENES = 4
_TOLERANCE = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A house made ready: what is drawn and where one walks."""

    drawable: Drawable
    ground: Ground


def load_place(scene: str) -> Place:
    """The house that a scene name stands for.

    Raises:
        UsageError: the name is not of the form ``"house-000017"``.
    """
    from spacevln.environments.houses.ground.walkable import Walkable
    from spacevln.environments.houses.house import build_house, parse_scene_name
    from spacevln.environments.houses.scene import compile_scene

    house = build_house(parse_scene_name(scene))
    compiled = compile_scene(house)
    return Place(Drawable(house, compiled.model, compiled.geom_instance), Walkable(house))


class _Scenes:
    """The last few houses with their renderers."""

    def __init__(self, load: Callable[[str], Place], renderer_of: Callable[[Place], Renderer]) -> None:
        self._load = load
        self._renderer_of = renderer_of
        self._kept: OrderedDict[str, tuple[Place, Renderer]] = OrderedDict()

    def get(self, scene: str) -> tuple[Place, Renderer]:
        if scene not in self._kept:
            place = self._load(scene)
            while len(self._kept) >= _KEPT_SCENES:
                self._kept.popitem(last=False)[1][1].close()
            self._kept[scene] = (place, self._renderer_of(place))
        self._kept.move_to_end(scene)
        return self._kept[scene]

    def close(self) -> None:
        for _, renderer in self._kept.values():
            renderer.close()
        self._kept.clear()


class HousesEnvironment:
    """An :class:`~spacevln.core.interfaces.Environment` of procedural houses (DESIGN 5.1); the motion is that of VLN-CE.

    One process may hold several; each belongs to the thread that made it.

    Args:
        camera: of every observation; by default 640x480 (320x240 when rays are cast), HFOV 79 degrees, 0.88 m high.
        sliding: the body slides along what it hits.
        renderer: ``"gl"``, ``"raycast"`` or what works (``"auto"``; then ``SPACEVLN_RENDERER`` can decide).
        load: how a scene name becomes a house.

    Raises:
        UnknownNameError: no such renderer.
        PrerequisiteError: the renderer asked for cannot be used here.
    """

    def __init__(
        self,
        camera: Camera | None = None,
        *,
        sliding: bool = True,
        renderer: RendererName = "auto",
        load: Callable[[str], Place] = load_place,
    ) -> None:
        self.renderer_info = info = renderer_info(renderer)
        size = (640, 480) if info.name == "gl" else (320, 240)
        view = camera or Camera(*size, hfov_deg=79.0, height_m=0.88)
        self._spec = EnvironmentSpec(camera=view)
        self._sliding = sliding
        self._scenes = _Scenes(load, lambda place: make_renderer(info, place.drawable, view.width_px, view.height_px))
        self._episode: EpisodeSpec | None = None
        self._observation: Observation | None = None
        self._chase: ChaseCamera | None = None
        self._stopped = False

    @property
    def spec(self) -> EnvironmentSpec:
        """Camera, 0.25 m steps, 30 degree turns."""
        return self._spec

    def reset(self, episode: EpisodeSpec) -> Observation:
        """Put the body at the episode's start.

        Raises:
            UsageError: the scene is unknown.
        """
        place, self._renderer = self._scenes.get(episode.scene)
        self._labels = house_labels(place.drawable.house)
        self._body = Body(place.ground, sliding=self._sliding)
        self._at: Pose = self._body.placed(episode.start)
        self._start = self._at
        self._episode, self._observation, self._chase, self._stopped = episode, None, None, False
        return self.observe()

    def observe(self) -> Observation:
        """What the camera sees now; drawn once per pose."""
        if self._episode is None:
            raise ContractError("HousesEnvironment.observe() was called before reset(): reset to an episode first.")
        if self._observation is None:
            camera = self._spec.camera
            T_scene_camera = self._at.T_world_body
            T_scene_camera[2, 3] += camera.height_m
            frame = self._renderer.render(T_scene_camera, camera)
            self._observation = Observation(
                rgb=frame.rgb,
                depth_m=frame.depth_m,
                pose=self._at.relative_to(self._start),
                camera=camera,
                labels=image_labels(frame.instance_ids, self._labels),
            )
        return self._observation

    def external_view(self) -> NDArray[np.uint8]:
        """The robot as a camera behind it sees it, (H, W, 3); for records, never for the agent."""
        if self._episode is None:
            raise ContractError("HousesEnvironment.external_view() was called before reset(): reset to an episode first.")
        if self._chase is None:
            from spacevln.environments.houses.ground.walkable import AGENT_RADIUS_M

            place, renderer = self._scenes.get(self._episode.scene)
            camera = self._spec.camera
            body = DrawnBody(AGENT_RADIUS_M, camera.height_m)
            self._chase = ChaseCamera(place.drawable, renderer, body, (camera.width_px, camera.height_px))
        return self._chase.view(self._at)

    def execute(self, action: Action) -> Motion:
        """Carry out one primitive.

        Raises:
            ContractError: the action is none of the spec's primitives, or the episode is over.
        """
        if self._episode is None or self._stopped:
            raise ContractError("HousesEnvironment.execute() was called outside an episode: reset to an episode first.")
        spec = self._spec
        motion = Motion(moved_m=0.0, turned_rad=0.0, collided=False)
        match action:
            case Stop():
                self._stopped = True
                return motion
            case MoveForward(distance_m=distance_m) if abs(distance_m - spec.step_m) < _TOLERANCE:
                moved = self._body.forward(self._at, spec.step_m)
            case TurnLeft(angle_deg=angle_deg) if abs(angle_deg - spec.turn_deg) < _TOLERANCE:
                moved = self._body.turn(self._at, math.radians(spec.turn_deg))
            case TurnRight(angle_deg=angle_deg) if abs(angle_deg - spec.turn_deg) < _TOLERANCE:
                moved = self._body.turn(self._at, -math.radians(spec.turn_deg))
            case _:
                raise ContractError(
                    f"{action!r} is no primitive: allowed are Stop(), MoveForward({spec.step_m}), "
                    f"TurnLeft({spec.turn_deg}) and TurnRight({spec.turn_deg}); split longer decisions."
                )
        at, motion = moved
        if at != self._at:
            self._observation = None
        self._at = at
        return motion

    def close(self) -> None:
        """Free everything."""
        self._scenes.close()
        self._episode = self._observation = None
