"""Robots: the connection to one, and an embedded house as the world of a simulated one."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from spacevln.core import Camera, EpisodeSpec, InstanceLabel, Pose
from spacevln.core.geometry import Float
from spacevln.environments.houses.environment import load_place
from spacevln.environments.houses.house import build_house, parse_scene_name
from spacevln.environments.houses.labels import house_labels
from spacevln.environments.houses.rendering import Renderer, make_renderer, renderer_info
from spacevln.environments.houses.walking.motion import sweep_disc
from spacevln.environments.robot.clock import SystemClock
from spacevln.environments.robot.environment import RobotEnvironment
from spacevln.environments.robot.guard.link import GuardProcess
from spacevln.environments.robot.profile import Images, Limits, RobotProfile, Topics
from spacevln.environments.robot.simulation.lockstep import Lockstep
from spacevln.environments.robot.simulation.robot import SensorSettings
from spacevln.environments.robot.simulation.world import Sight
from spacevln.environments.robot.transport import TransportName, open_transport

_CARRIED_S = 0.5
LOCKSTEP_HZ = 5.0


class HouseWorld:
    """An embedded house around a simulated robot; implements :class:`~spacevln.environments.robot.simulation.world.World`."""

    def __init__(self, scene: str) -> None:
        self.scene = scene
        self._place = load_place(scene)
        self._renderer: Renderer | None = None

    def render(self, T_scene_camera: Float, camera: Camera) -> Sight:
        """The picture; the renderer belongs to the thread that asks first."""
        if self._renderer is None:
            info = renderer_info()
            self._renderer = make_renderer(info, self._place.drawable, camera.width_px, camera.height_px)
        frame = self._renderer.render(T_scene_camera, camera)
        return Sight(frame.rgb, frame.depth_m, frame.instance_ids)

    def sweep(self, pose: Pose, dx_m: float, dy_m: float, radius_m: float) -> tuple[Pose, bool]:
        """Move a disc until it touches something."""
        ground = self._place.ground
        space = ground.floors[ground.floor_index(pose.x_m, pose.y_m, pose.z_m)]
        x, y, hit = sweep_disc((pose.x_m, pose.y_m), (dx_m, dy_m), space.boxes, space.discs, radius_m=radius_m, sliding=False)
        return Pose(x, y, ground.floor_height_m(x, y, pose.z_m), pose.yaw_rad), hit

    def close(self) -> None:
        """Free the renderer."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


def label_names(scene: str) -> Mapping[int, InstanceLabel]:
    """What the instance ids of an embedded house are called."""
    return house_labels(build_house(parse_scene_name(scene)))


def simulated_profile(transport: TransportName = "dds", domain: int = 42, port: int = 7448) -> RobotProfile:
    """The profile of the simulated robot: on this machine only, with a simulator's labels.

    Its body is that of a small robot: the houses' doors are as wide as real ones. What is higher
    than 5 cm stops it, as it does in the houses.
    """
    endpoint = "127.0.0.1" if transport == "dds" else f"tcp/127.0.0.1:{port}"
    return RobotProfile(
        name="simulated",
        about="a differential-drive base in an embedded house",
        transport=transport,
        domain=domain,
        endpoint=endpoint,
        topics=Topics(labels="/simulation/labels"),
        images=Images(width_px=0),
        limits=Limits(body_radius_m=0.2, stop_m=0.05, floor_m=0.05),
    )


def lockstep(start: Pose, scene: str, seed: int) -> tuple[RobotEnvironment, Lockstep]:
    """A simulated robot in an embedded house under a simulated clock, in this process: as fast as it can be computed.

    Images are 320x240 at 5 Hz. Close the environment, then ``robot.base.world``.
    """
    profile, world = simulated_profile(), HouseWorld(scene)
    profile = profile.model_copy(update={"watchdog": profile.watchdog.model_copy(update={"image_s": 2.5 / LOCKSTEP_HZ})})
    sensors = SensorSettings(Camera(320, 240, 79.0, 0.88), image_hz=LOCKSTEP_HZ)
    parts = Lockstep(profile, world, start, seed, sensors=sensors)

    def place(episode: EpisodeSpec) -> None:
        parts.robot.place(episode.start)
        parts.clock.sleep(_CARRIED_S)
        parts.link.operate("resume")

    return RobotEnvironment(parts.transport, parts.link, profile, parts.clock, place=place, label_names=label_names), parts


def connect(
    profile: RobotProfile, *, dry: bool = False, place: Callable[[EpisodeSpec], None] | None = None, simulated: bool = False
) -> tuple[RobotEnvironment, GuardProcess]:
    """A robot, and the guard of its wheels.

    Args:
        profile: of the robot.
        dry: no motion.
        place: puts it at an episode's start.
        simulated: it tells instance ids of an embedded house.

    Raises:
        PrerequisiteError: the transport is not installed.
        EnvironmentFailure: the robot is not heard.
    """
    transport = open_transport(profile.transport, domain=profile.domain, distro=profile.distro, endpoint=profile.endpoint)
    link = GuardProcess(profile, dry=dry)

    def placed(episode: EpisodeSpec) -> None:
        if place is not None:
            place(episode)
            SystemClock().sleep(_CARRIED_S)  # until the guard has seen the jump: being carried is no fault
            link.operate("resume")

    names = label_names if simulated else None
    return RobotEnvironment(transport, link, profile, place=placed, label_names=names, dry=dry), link
