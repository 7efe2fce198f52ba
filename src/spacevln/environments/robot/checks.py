"""What `spacevln robot check` finds out: rates, stamps, calibration, and whether depth and odometry tell the same motion."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spacevln.core.errors import EnvironmentFailure
from spacevln.core.geometry import Float, transform_points
from spacevln.core.sensing import Observation
from spacevln.environments.robot.clock import Clock
from spacevln.environments.robot.messages import NANO
from spacevln.environments.robot.observer import Observer, flat
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.streams import Streams

_POLL_S = 0.05
LEAST_HZ = {"rgb": 5.0, "depth": 5.0, "pose": 10.0}
"""Slower streams cannot be watched for a stop within 0.3 s."""
WORST_MISFIT_M = 0.12
"""Median misfit of two views' depth under the odometry between them, from which on the extrinsics or the clocks are doubted."""
_ENOUGH = 50


@dataclass(frozen=True, slots=True)
class Check:
    """One line of the report; ``mend`` says what to do when it is not ``ok``."""

    ok: bool
    what: str
    mend: str = ""


def check_streams(streams: Streams, profile: RobotProfile, clock: Clock, duration_s: float) -> list[Check]:
    """Listen for a while without moving."""
    begin, skews = streams.times.counts, list[float]()
    end_s = clock.now_s() + duration_s
    while clock.now_s() < end_s:
        clock.sleep(_POLL_S)
        latest = streams.pose
        if latest is not None:
            skews.append((clock.stamp_ns() - latest[0]) / NANO)
    rates = [(after - before) / duration_s for before, after in zip(begin, streams.times.counts, strict=True)]
    topics = profile.topics
    names = {"rgb": topics.rgb, "depth": topics.depth, "pose": topics.odometry or f"{topics.tf} to {profile.frames.base}"}
    found = [_rate(kind, names[kind], rate) for kind, rate in zip(names, rates, strict=True)]
    found += [_calibration(streams, profile), _mount(streams, profile), _clocks(skews, profile), _pairs(streams, profile)]
    return [*found, *_image(streams, profile)]


def _rate(kind: str, name: str, rate_hz: float) -> Check:
    if rate_hz == 0:
        return Check(False, f"{kind}: nothing on {name}", "start its driver, or name the topic in the profile ([topics])")
    slow = rate_hz < LEAST_HZ[kind]
    return Check(not slow, f"{kind}: {rate_hz:.1f} Hz on {name}", f"at least {LEAST_HZ[kind]:.0f} Hz are needed" if slow else "")


def _calibration(streams: Streams, profile: RobotProfile) -> Check:
    info = streams.info
    if info is None:
        return Check(False, f"calibration: nothing on {profile.topics.camera_info}", "name the topic in the profile ([topics])")
    return Check(
        info.k[0] > 0,
        f"calibration: {info.width}x{info.height}, fx {info.k[0]:.1f}, {info.distortion_model or 'no'} distortion",
        "" if info.k[0] > 0 else "calibrate the camera",
    )


def _mount(streams: Streams, profile: RobotProfile) -> Check:
    try:
        T = streams.place_of_camera()
    except EnvironmentFailure as error:
        return Check(False, f"camera on the body: {error}", "mend the transform, or give [mount] in the profile")
    if T is None:
        optical = streams.info.header.frame_id if streams.info else "the camera"
        return Check(
            False, f"camera on the body: no transform from {profile.frames.base} to {optical}", "publish it, or give [mount]"
        )
    pitch_deg = math.degrees(math.asin(max(-1.0, min(1.0, -T[2, 0]))))
    where = "profile" if profile.mount is not None else "TF"
    ok = bool(0.05 < T[2, 3] < 2.5)
    what = f"camera on the body: {T[2, 3]:.2f} m high, {round(pitch_deg)} degrees down ({where})"
    return Check(ok, what, "" if ok else "mend the transform, or give [mount] in the profile")


def _clocks(skews: Sequence[float], profile: RobotProfile) -> Check:
    if not skews:
        return Check(False, "clocks: no stamp to compare", "see above")
    middle, spread = float(np.median(skews)), float(np.ptp(skews))
    ok = abs(middle) < profile.watchdog.skew_s and spread < 2 * profile.watchdog.clock_jump_s
    return Check(
        ok,
        f"clocks: stamps are {1000 * middle:.0f} ms old, spread {1000 * spread:.0f} ms",
        "" if ok else "synchronise the clocks of robot and this machine (chrony), or run on the robot",
    )


def _pairs(streams: Streams, profile: RobotProfile) -> Check:
    offsets = streams.offsets_s()
    if not offsets:
        return Check(False, "colour and depth: no pair", "see above")
    worst = float(np.median(np.abs(offsets)))
    ok = worst <= profile.sync.slop_s
    return Check(
        ok, f"colour and depth: {1000 * worst:.0f} ms apart", "" if ok else "align depth to colour, or raise sync.slop_s"
    )


def _image(streams: Streams, profile: RobotProfile) -> list[Check]:
    snapshot = streams.snapshot()
    try:
        place = streams.place_of_camera()
        if snapshot is None or place is None:
            return [Check(False, "synchronised set: none", "see above")]
        seen = Observer(profile, snapshot.info, place).observation(snapshot, flat(snapshot.pose))
    except EnvironmentFailure as error:
        return [Check(False, f"images: {error}", "change the driver's settings")]
    share = float((seen.depth_m > 0).mean())
    ok = share > max(0.2, profile.watchdog.depth_share)
    return [
        Check(
            ok, f"depth: {100 * share:.0f} % of the pixels measure", "" if ok else "look at the lens, the light and depth_scale_m"
        )
    ]


def misfit_m(before: Observation, after: Observation) -> float | None:
    """Median distance between what an image measured and where the next one's points fall in it; None when they share nothing."""
    camera = before.camera
    points = transform_points(np.linalg.inv(before.T_world_camera).astype(np.float64), _points(after))
    points = points[points[:, 0] > 0.3]
    columns = np.floor(camera.cx_px - camera.fx_px * points[:, 1] / points[:, 0]).astype(int)
    rows = np.floor(camera.cy_px - camera.fy_px * points[:, 2] / points[:, 0]).astype(int)
    inside = (rows >= 0) & (rows < camera.height_px) & (columns >= 0) & (columns < camera.width_px)
    measured = before.depth_m[rows[inside], columns[inside]]
    both = measured > 0
    if both.sum() < _ENOUGH:
        return None
    return float(np.median(np.abs(measured - points[inside, 0])[both]))


def check_turning(views: Sequence[Observation]) -> Check:
    """Whether depth and odometry agree over the views of a look-around."""
    misfits = [misfit for a, b in itertools.pairwise(views) if (misfit := misfit_m(a, b)) is not None]
    if not misfits:
        return Check(False, "depth against odometry: the views share nothing", "turn in a room, not in the open")
    middle = float(np.median(misfits))
    ok = middle < WORST_MISFIT_M
    mend = "" if ok else "check the camera's tilt and place on the body, the stamps, and the direction of odometry"
    return Check(ok, f"depth against odometry: {100 * middle:.0f} cm apart over {len(views)} views", mend)


def _points(seen: Observation) -> Float:
    camera = seen.camera
    step = max(1, camera.height_px // 60)
    rows, columns = np.mgrid[step // 2 : camera.height_px : step, step // 2 : camera.width_px : step]
    depth = seen.depth_m[rows, columns].astype(np.float64)
    left = -(columns + 0.5 - camera.cx_px) / camera.fx_px * depth
    up = -(rows + 0.5 - camera.cy_px) / camera.fy_px * depth
    measured = (depth > 0) & (depth < 4.0)
    return transform_points(seen.T_world_camera, np.stack([depth, left, up], axis=-1)[measured])
