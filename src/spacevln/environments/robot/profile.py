"""What is particular about one robot: topics, frames, body, limits. Data files in TOML; ``profiles/`` has three."""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, PositiveFloat, PositiveInt, ValidationError

from spacevln.core.errors import UnknownNameError, UsageError


class _Settings(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Topics(_Settings):
    """Names of the streams.

    Args:
        rgb, depth: sensor_msgs/Image, or CompressedImage where the name ends in ``/compressed`` or ``/compressedDepth``; depth is
            aligned to rgb.
        camera_info: of the rgb camera.
        odometry: nav_msgs/Odometry; ``""`` takes the pose from TF instead.
        cmd_vel: where the wheel guard writes.
        stamped_cmd_vel: TwistStamped (TurtleBot 4 on Jazzy) instead of Twist.
        tf, tf_static: transforms.
        labels: a simulator's instance ids (sensor_msgs/Image 32SC1); ``""`` on a real robot.
        stop, resume: std_srvs/Trigger services that the guard offers to the operator.
    """

    rgb: str = "/camera/color/image_raw"
    depth: str = "/camera/aligned_depth_to_color/image_raw"
    camera_info: str = "/camera/color/camera_info"
    odometry: str = "/odom"
    cmd_vel: str = "/cmd_vel"
    stamped_cmd_vel: bool = False
    tf: str = "/tf"
    tf_static: str = "/tf_static"
    labels: str = ""
    stop: str = "/spacevln/stop"
    resume: str = "/spacevln/resume"


class Frames(_Settings):
    """Names of the frames: ``fixed`` is what the pose is told in, ``base`` the body."""

    fixed: str = "odom"
    base: str = "base_link"


class Mount(_Settings):
    """Where the camera sits on the body, if TF does not say: ROS convention of the *body* (x forward, y left, z up).

    Args:
        x_m, y_m, z_m: optical centre from the base frame, z over the floor.
        pitch_deg: downward tilt positive; ``roll_deg``, ``yaw_deg`` as in REP-103.
    """

    x_m: float = 0.0
    y_m: float = 0.0
    z_m: PositiveFloat = 0.88
    roll_deg: float = 0.0
    pitch_deg: float = 0.0
    yaw_deg: float = 0.0


class Images(_Settings):
    """Encodings.

    Args:
        depth_scale_m: metres per unit of integer depth.
        width_px: of the observation; smaller than the camera's for less work. 0 keeps the camera's.
    """

    depth_scale_m: PositiveFloat = 0.001
    width_px: int = Field(default=640, ge=0, le=4096)


class Limits(_Settings):
    """What the wheel guard allows.

    Args:
        speed_m_s, turn_rad_s: largest velocities.
        accel_m_s2, turn_accel_rad_s2: largest changes of them; a stop for safety is exempt.
        brake_m_s2: deceleration that the base really has; decides how fast one may approach an obstacle.
        body_radius_m: of the disc around the base that must stay free.
        body_height_m: points between ``floor_m`` and this are obstacles.
        floor_m: lower points are floor.
        stop_m: kept free in front of the body.
        unseen_m_s: largest speed over floor that was not seen: what stands there is touched no harder.
        geofence_m: corners (x, y) of the area in the frame of the start that must not be left; none for no fence.
    """

    speed_m_s: PositiveFloat = 0.35
    turn_rad_s: PositiveFloat = 0.8
    accel_m_s2: PositiveFloat = 0.5
    turn_accel_rad_s2: PositiveFloat = 1.6
    brake_m_s2: PositiveFloat = 0.8
    body_radius_m: PositiveFloat = 0.25
    body_height_m: PositiveFloat = 1.2
    floor_m: PositiveFloat = 0.08
    stop_m: PositiveFloat = 0.1
    unseen_m_s: PositiveFloat = 0.08
    geofence_m: tuple[tuple[float, float], ...] = ()


class Watchdog(_Settings):
    """What must keep coming, and how soon its absence stops the robot.

    Args:
        agent_s, pose_s, image_s: oldest age of the agent's wish, of the pose, of rgb and depth while moving.
        skew_s: largest difference between a message's stamp and this machine's clock.
        clock_jump_s: largest change of that difference; what comes later than that for a moment counts as that old, what does so
            for two seconds, or comes earlier, as a clock that jumped.
        pose_jump_m, pose_jump_deg: beyond what the speed limits allow.
        depth_share: least share of depth pixels that measure.
        slack_m, slack_deg: commanded but not executed way at which the wheels count as blocked.
    """

    agent_s: PositiveFloat = 0.2
    pose_s: PositiveFloat = 0.25
    image_s: PositiveFloat = 0.22
    skew_s: PositiveFloat = 0.5
    clock_jump_s: PositiveFloat = 0.2
    pose_jump_m: PositiveFloat = 0.1
    pose_jump_deg: PositiveFloat = 6.0
    depth_share: float = Field(default=0.02, ge=0, le=1)
    slack_m: PositiveFloat = 0.06
    slack_deg: PositiveFloat = 10.0


class Motions(_Settings):
    """Primitives and how they are tracked.

    Args:
        step_m, max_forward_m: of forward targets.
        turn_deg: of a turn; eight of 45 degrees are a look-around.
        tolerance_m, tolerance_deg: within which a target is reached.
        timeout_s: of one primitive.
        settle_s: standing still before the image of a view is taken.
        patience_s: how long a stopped robot waits for lost data, or for the operator's resume, before the run ends.
        while_thinking: what the robot does while a model thinks of the next decision: ``"stand"``, or ``"continue"`` straight
            ahead towards the stage's next waypoint, one step at most.
    """

    step_m: PositiveFloat = 0.5
    max_forward_m: PositiveFloat = 1.5
    turn_deg: PositiveFloat = 45.0
    tolerance_m: PositiveFloat = 0.03
    tolerance_deg: PositiveFloat = 1.5
    timeout_s: PositiveFloat = 12.0
    settle_s: float = Field(default=0.15, ge=0)
    patience_s: PositiveFloat = 10.0
    while_thinking: Literal["stand", "continue"] = "stand"


class Sync(_Settings):
    """Which messages belong together.

    Args:
        slop_s: largest difference between the stamps of rgb and depth.
        pose_gap_s: largest gap between poses over which one is interpolated.
    """

    slop_s: PositiveFloat = 0.02
    pose_gap_s: PositiveFloat = 0.25


class RobotProfile(_Settings):
    """Everything about one robot.

    Args:
        name: e.g. ``"turtlebot4"``.
        about: one line for people.
        transport, domain, distro, endpoint: how its messages travel.
        control_hz: of the wheel guard and the tracker.
    """

    name: str
    about: str = ""
    transport: Literal["dds", "zenoh", "rclpy"] = "dds"
    domain: int = Field(default=0, ge=0, le=232)
    distro: Literal["humble", "jazzy", "kilted"] = "jazzy"
    endpoint: str = ""
    control_hz: PositiveInt = 50
    topics: Topics = Topics()
    frames: Frames = Frames()
    mount: Mount | None = None
    images: Images = Images()
    limits: Limits = Limits()
    watchdog: Watchdog = Watchdog()
    motions: Motions = Motions()
    sync: Sync = Sync()


def profile_names() -> tuple[str, ...]:
    """The profiles that come with the package."""
    folder = resources.files("spacevln.environments.robot") / "profiles"
    return tuple(sorted(item.name.removesuffix(".toml") for item in folder.iterdir() if item.name.endswith(".toml")))


def load_profile(name_or_path: str) -> RobotProfile:
    """A profile by its name, or from a TOML file.

    Raises:
        UnknownNameError: no such profile.
        UsageError: the file is not a profile.
    """
    path = Path(name_or_path)
    if path.suffix == ".toml":
        try:
            text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise UsageError(f"The profile {name_or_path!r} cannot be read ({error.strerror}): give a TOML file.") from error
    elif name_or_path in profile_names():
        text = (resources.files("spacevln.environments.robot") / "profiles" / f"{name_or_path}.toml").read_text(encoding="utf-8")
    else:
        raise UnknownNameError("robot profile", name_or_path, profile_names())
    try:
        return RobotProfile.model_validate(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise UsageError(f"The profile {name_or_path!r} is not TOML ({error}): mend it.") from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"]))
        raise UsageError(f"The profile {name_or_path!r} is wrong at {where!r}: {first['msg']}; see docs/robot.md.") from error
