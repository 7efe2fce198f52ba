"""The houses as a Gymnasium environment, ``spacevln/Houses-v0``: a fresh route episode at every reset.

Gymnasium 1 loads no plug-ins by itself; importing this module registers the environment, as does naming it::

    gymnasium.make("spacevln.environments.houses.gym:spacevln/Houses-v0")
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from spacevln.core.actions import Action, MoveForward, Stop, TurnLeft, TurnRight
from spacevln.core.errors import ContractError, PrerequisiteError
from spacevln.core.geometry import Pose
from spacevln.core.interfaces import Environment
from spacevln.core.sensing import Camera, Observation
from spacevln.core.task import EpisodeSpec, InstructionTask
from spacevln.environments.houses.environment import HousesEnvironment
from spacevln.environments.houses.episodes import NoEpisodeError, route_episode
from spacevln.environments.houses.episodes.grounds import Grounds
from spacevln.environments.houses.house import build_house
from spacevln.environments.houses.rendering import RANGE_M, RendererName
from spacevln.environments.houses.walking.geodesics import Field

try:
    import gymnasium
    from gymnasium import spaces
except ImportError as error:
    raise PrerequisiteError('Gymnasium is not installed: run `pip install "spacevln[gym]"`.') from error

SUCCESS_RADIUS_M = 3.0
SUCCESS_REWARD = 10.0
STEP_LIMIT = 500
_HOUSES = 1000
_FAR_M = 1000.0


@dataclass(frozen=True, slots=True)
class GymEpisode:
    """What a reset starts.

    Args:
        spec: for the environment.
        distance_m: geodesic distance of a pose in the scene frame to the goal.
    """

    spec: EpisodeSpec
    distance_m: Callable[[Pose], float]


def draw_route(rng: np.random.Generator) -> GymEpisode:
    """A route episode of a house of the development split."""
    while True:
        grounds = Grounds(build_house(int(rng.integers(_HOUSES))))
        try:
            episode = route_episode(grounds, int(rng.integers(2**31)))
        except NoEpisodeError:
            continue
        field = grounds.geodesics.distances_from(np.array(episode.goals))
        return GymEpisode(episode.spec, functools.partial(_distance_m, field))


def _distance_m(field: Field, pose: Pose) -> float:
    return field.at(pose.x_m, pose.y_m, pose.z_m)


class HousesGym(gymnasium.Env[dict[str, NDArray[Any]], np.int64]):
    """Follow a route instruction; the actions are 0 STOP, 1 forward 0.25 m, 2 left 30 degrees, 3 right 30 degrees.

    Observation: ``rgb`` (H, W, 3) uint8; ``depth`` (H, W, 1) float32 metres, 0 = none; ``pose`` (4,) float32: x, y, z, yaw in
    the episode frame. The instruction is in ``info``. Reward: metres of geodesic distance gained, and 10 for STOP within
    3 m of the goal.

    Args:
        render_mode: None or ``"rgb_array"``.
        camera, sliding, renderer: of :class:`~spacevln.environments.houses.environment.HousesEnvironment`.
        environment: makes another environment instead.
        draw: draws the episodes.
    """

    metadata: ClassVar[dict[str, Any]] = {"render_modes": ["rgb_array"], "render_fps": 4}

    def __init__(
        self,
        render_mode: str | None = None,
        *,
        camera: Camera | None = None,
        sliding: bool = True,
        renderer: RendererName = "auto",
        environment: Callable[[], Environment] | None = None,
        draw: Callable[[np.random.Generator], GymEpisode] = draw_route,
    ) -> None:
        self.render_mode = render_mode
        houses = functools.partial(HousesEnvironment, camera, sliding=sliding, renderer=renderer)
        self._environment: Environment = (environment or houses)()
        self._draw = draw
        self._episode: GymEpisode | None = None
        spec = self._environment.spec
        self._actions: tuple[Action, ...] = (
            Stop(),
            MoveForward(spec.step_m),
            TurnLeft(spec.turn_deg),
            TurnRight(spec.turn_deg),
        )
        size = (spec.camera.height_px, spec.camera.width_px)
        far = np.array([_FAR_M, _FAR_M, _FAR_M, np.pi + 1e-6], np.float32)
        self.action_space = spaces.Discrete(len(self._actions))
        self.observation_space = spaces.Dict(
            {
                "rgb": spaces.Box(0, 255, (*size, 3), np.uint8),
                "depth": spaces.Box(0.0, RANGE_M, (*size, 1), np.float32),
                "pose": spaces.Box(-far, far, dtype=np.float32),
            }
        )

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[Any]], dict[str, Any]]:
        """A new episode; ``options={"episode": GymEpisode}`` chooses it."""
        super().reset(seed=seed)
        self._episode = episode = (options or {}).get("episode") or self._draw(self.np_random)
        seen = self._environment.reset(episode.spec)
        self._distance_m = episode.distance_m(episode.spec.start)
        return _values(seen), self._info(episode, collided=False, success=False)

    def step(self, action: np.int64) -> tuple[dict[str, NDArray[Any]], float, bool, bool, dict[str, Any]]:
        """Carry out one action; STOP ends the episode."""
        episode = self._episode
        if episode is None:
            raise ContractError("HousesGym.step() was called before reset(): reset first.")
        chosen = self._actions[int(action)]
        stopped = isinstance(chosen, Stop)
        motion = self._environment.execute(chosen)
        seen = self._environment.observe()
        before, self._distance_m = self._distance_m, episode.distance_m(episode.spec.start.compose(seen.pose))
        success = stopped and self._distance_m < SUCCESS_RADIUS_M
        gained = before - self._distance_m if np.isfinite(before - self._distance_m) else 0.0
        reward = gained + (SUCCESS_REWARD if success else 0.0)
        return _values(seen), float(reward), stopped, False, self._info(episode, collided=motion.collided, success=success)

    def render(self) -> NDArray[np.uint8] | None:
        """The camera's picture, (H, W, 3) uint8."""
        if self.render_mode is None or self._episode is None:
            return None
        return self._environment.observe().rgb

    def close(self) -> None:
        """Free everything."""
        self._environment.close()

    def _info(self, episode: GymEpisode, *, collided: bool, success: bool) -> dict[str, Any]:
        spec = episode.spec
        words = spec.task.instruction if isinstance(spec.task, InstructionTask) else spec.task.goal
        return {
            "episode_id": spec.episode_id,
            "scene": spec.scene,
            "instruction": words,
            "distance_m": self._distance_m,
            "collided": collided,
            "success": success,
        }


def _values(seen: Observation) -> dict[str, NDArray[Any]]:
    pose = seen.pose
    return {
        "rgb": seen.rgb.copy(),
        "depth": seen.depth_m[..., None].copy(),
        "pose": np.array([pose.x_m, pose.y_m, pose.z_m, pose.yaw_rad], np.float32),
    }


def register() -> None:
    """Register ``spacevln/Houses-v0`` with Gymnasium; done when this module is imported, and harmless when repeated."""
    if "spacevln/Houses-v0" not in gymnasium.registry:
        gymnasium.register(
            id="spacevln/Houses-v0", entry_point="spacevln.environments.houses.gym:HousesGym", max_episode_steps=STEP_LIMIT
        )


register()
