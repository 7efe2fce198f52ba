"""Bytes and transports of ROS 2, where the extra ``robot`` is installed; CI installs it."""

from __future__ import annotations

import itertools
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

for needed in ("cyclonedds", "zenoh", "rosbags"):
    pytest.importorskip(needed, reason="needs the extra 'robot'")

from robot_messages import HEADER, MESSAGES  # noqa: E402
from robot_peer import Peer  # noqa: E402

from spacevln.environments.robot import wire  # noqa: E402
from spacevln.environments.robot.guard.link import GuardProcess  # noqa: E402
from spacevln.environments.robot.guard.status import GuardState, StopReason  # noqa: E402
from spacevln.environments.robot.messages import (  # noqa: E402
    TYPE_NAMES,
    CameraInfo,
    CompressedImage,
    Header,
    Image,
    Message,
    Odometry,
    Quaternion,
    TFMessage,
    TriggerReply,
    Vector3,
)
from spacevln.environments.robot.profile import Limits, Mount, RobotProfile, Watchdog  # noqa: E402
from spacevln.environments.robot.transport import Qos, Topic, Transport, open_transport  # noqa: E402
from spacevln.environments.robot.transports.dds import idl_type  # noqa: E402
from spacevln.environments.robot.transports.zenoh import key_expression  # noqa: E402

pytestmark = [pytest.mark.slow, pytest.mark.enable_socket]

LINK = Path(__file__).parents[2] / "benchmarks" / "robot_link.py"
# a domain hears everything that is written in it: no two workers of one run may ever share one
WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
WORKERS = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
DOMAINS = itertools.cycle(range(10 + WORKER, 101, WORKERS))  # above 101 their ports are the system's own


def port_of(domain: int) -> int:
    return 17_500 + domain


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_two_implementations_of_cdr_agree_to_the_byte(message: Message) -> None:
    """What rosbags writes, CycloneDDS' own serialiser reads and writes again byte for byte; and we read what we wrote."""
    kind = type(message)
    data = wire.encode(message)
    theirs = idl_type(TYPE_NAMES[kind])
    assert bytes(theirs.deserialize(data).serialize(use_version_2=False)) == data
    again = wire.decode(data, kind)
    assert wire.encode(again) == data
    if not isinstance(message, Image | CompressedImage):
        assert again == message


def test_services_agree_too() -> None:
    for data, name in (
        (wire.encode_trigger_reply(TriggerReply(True, "stopped")), wire.TRIGGER_RESPONSE),
        (wire.encode_trigger_request(), wire.TRIGGER_REQUEST),
    ):
        assert bytes(idl_type(name).deserialize(data).serialize(use_version_2=False)) == data


def test_keys_are_those_of_rmw_zenoh() -> None:
    hashed = wire.type_hash("geometry_msgs/msg/Twist")
    assert hashed == "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"
    assert (
        key_expression(0, "/cmd_vel", "geometry_msgs/msg/Twist", hashed) == f"0/cmd_vel/geometry_msgs::msg::dds_::Twist_/{hashed}"
    )


def settings(name: str) -> tuple[dict[str, object], dict[str, object]]:
    domain = next(DOMAINS)
    if name == "dds":
        return {"domain": domain, "endpoint": "127.0.0.1"}, {"domain": domain, "endpoint": "127.0.0.1"}
    address = f"tcp/127.0.0.1:{port_of(domain)}"
    return {"domain": domain, "endpoint": f"listen/{address}"}, {"domain": domain, "endpoint": address}


@pytest.fixture(params=["dds", "zenoh"])
def pair(request: pytest.FixtureRequest) -> Iterator[tuple[Transport, Transport]]:
    one, other = settings(request.param)
    a, b = open_transport(request.param, **one), open_transport(request.param, **other)  # type: ignore[arg-type]
    yield a, b
    a.close()
    b.close()
    b.close()


def wait_for_peer(transport: Transport, topic: Topic[Image]) -> None:
    end = time.monotonic() + 20
    while not transport.peers(topic):
        assert time.monotonic() < end, "the peers did not find each other"
        time.sleep(0.01)


def test_messages_late_joiners_and_services(pair: tuple[Transport, Transport]) -> None:
    """Images arrive whole and in order, a latched transform reaches who comes later, a service answers."""
    a, b = pair
    images, static = Topic("/camera/image", Image), Topic("/tf_static", TFMessage, Qos.LATCHED)
    transforms = MESSAGES[4]
    assert isinstance(transforms, TFMessage)
    a.publish(static, transforms)
    got, late, done = list[Image](), list[TFMessage](), threading.Event()
    b.subscribe(images, got.append)
    b.subscribe(static, late.append)
    data = bytes(range(256)) * (640 * 480 * 3 // 256)
    a.publish(images, Image(HEADER, 480, 640, "rgb8", 1920, data))
    wait_for_peer(a, images)
    for k in range(10):
        a.publish(images, Image(Header(k), 480, 640, "rgb8", 1920, data))
        time.sleep(0.1)
    a.serve_trigger("/spacevln/stop", lambda: TriggerReply(True, "stopped"))
    assert b.call_trigger("/spacevln/stop", 20.0) == TriggerReply(True, "stopped")
    assert b.call_trigger("/nobody", 0.2) is None
    stamps = [image.header.stamp_ns for image in got if image.header.stamp_ns < 10]
    assert stamps == sorted(stamps)
    assert len(stamps) >= 8  # best effort: what QoS allows to lose
    assert all(image.data == data for image in got)
    done.wait(0.1)
    assert late[0] == transforms


def test_half_a_minute_of_images_over_loopback() -> None:
    """Two processes each, both transports at once, 640x480 at 10 Hz: what the issue asks of ten minutes (docs/results.md)."""
    links = [
        subprocess.Popen(
            [sys.executable, LINK, name, "--seconds", "30", "--domain", str(domain), "--port", str(port_of(domain))],
            stdout=subprocess.PIPE,
            text=True,
        )
        for name, domain in zip(("dds", "zenoh"), DOMAINS, strict=False)
    ]
    for link in links:
        told = json.loads(link.communicate(timeout=120)[0])
        assert (told["commands"]["lost"], told["commands"]["strange"]) == (0, 0)  # reliable
        for stream in told["streams"].values():
            assert stream["lost"] <= 0.02 * stream["sent"]  # best effort: what a busy machine may drop
            assert stream["median_ms"] < 15


def profile_of(name: str) -> tuple[RobotProfile, dict[str, object]]:
    one, other = settings(name)
    profile = RobotProfile(
        name="peer",
        transport=name,  # type: ignore[arg-type]
        domain=other["domain"],  # type: ignore[arg-type]
        endpoint=other["endpoint"],  # type: ignore[arg-type]
        mount=Mount(),
        limits=Limits(),
        # a shared test machine may starve the peer for a while; what is measured here is the agent's end
        watchdog=Watchdog(pose_s=2.0, image_s=2.0, clock_jump_s=5.0, skew_s=10.0, slack_m=99.0, slack_deg=999.0),
    )
    return profile, one


AGENT = """
import sys, time
from spacevln.environments.robot.guard.link import GuardProcess
from spacevln.environments.robot.profile import RobotProfile
link = GuardProcess(RobotProfile.model_validate_json(sys.argv[1]))
print(link.pid, flush=True)
while True:
    link.wish(0.3, 0.0)
    time.sleep(0.02)
"""


@pytest.mark.parametrize("name", ["dds", "zenoh"])
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP, signal.SIGINT])
def test_the_wheels_stop_when_the_agent_is_gone(name: str, how: signal.Signals) -> None:
    """Killed or frozen: the guard's own zero comes within 0.3 s, and it is the last command.

    A machine that keeps the test itself waiting for as long as that can not tell: then it is tried again. Even then the wheels
    stand in time, by the base's own time-out.
    """
    for _ in range(3):
        zero_s, stands_s, starved_s = end_of_agent(name, how)
        assert stands_s < 0.3
        if starved_s < 0.1:
            break
    assert zero_s < 0.3 or starved_s >= 0.1


def end_of_agent(name: str, how: signal.Signals) -> tuple[float, float, float]:
    """Seconds from the signal to the first zero, and until the wheels stand; and for how long nobody could run."""
    profile, listening = profile_of(name)
    peer = Peer(open_transport(profile.transport, **listening), profile)  # type: ignore[arg-type]
    agent = subprocess.Popen(
        [sys.executable, "-c", AGENT, profile.model_dump_json()], stdout=subprocess.PIPE, text=True, stderr=subprocess.DEVNULL
    )
    try:
        assert agent.stdout is not None
        guard = int(agent.stdout.readline())
        peer.wait_for_motion()
        peer.starved_s, gone_s = 0.0, time.monotonic()
        agent.send_signal(how)
        zero_s, stands_s = peer.wait_for_zero()
        time.sleep(0.1)  # until the peer could notice
        starved_s = peer.starved_s
    finally:
        agent.kill()
        agent.wait()
        agent.stdout.close()  # type: ignore[union-attr]
    end = time.monotonic() + 20
    while _alive(guard):
        assert time.monotonic() < end, "the guard outlives the agent"
        time.sleep(0.05)
    assert peer.commands[-1][1:] == (0.0, 0.0)
    peer.close()
    return zero_s - gone_s, stands_s - gone_s, starved_s


def _alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    with open(f"/proc/{pid}/stat") as file:  # noqa: PTH123 - an orphan may wait for its new parent to collect it
        return file.read().rpartition(")")[2].split()[0] != "Z"


def test_the_operators_service_stops_and_resumes_and_a_dead_guard_is_told() -> None:
    profile, listening = profile_of("dds")
    peer = Peer(open_transport("dds", **listening), profile)  # type: ignore[arg-type]
    link = GuardProcess(profile)
    ended = threading.Event()

    def wish() -> None:
        while not ended.wait(0.02):
            link.wish(0.3, 0.0)

    wisher = threading.Thread(target=wish)
    wisher.start()
    try:
        peer.wait_for_motion()
        reply = peer.transport.call_trigger(profile.topics.stop, 20.0)
        assert reply is not None
        peer.wait_for_zero()
        _until(lambda: link.status().reason is StopReason.OPERATOR)
        assert peer.transport.call_trigger(profile.topics.resume, 20.0) is not None
        peer.wait_for_motion()
    finally:
        ended.set()
        wisher.join()
    os.kill(link.pid, signal.SIGKILL)
    _until(lambda: link.status().state is GuardState.ENDED)
    link.close()
    peer.close()


def _until(holds) -> None:  # type: ignore[no-untyped-def]
    end = time.monotonic() + 20
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.01)


def test_a_bag_gives_posed_images(tmp_path) -> None:  # type: ignore[no-untyped-def]
    """A bag that rosbags writes, in MCAP, is read through the same streams as a live robot's messages."""
    import numpy as np
    from rosbags.rosbag2 import StoragePlugin, Writer

    from spacevln.core import Camera, RecordError
    from spacevln.environments.robot.bag import read_bag
    from spacevln.environments.robot.calibration import info_of
    from spacevln.environments.robot.images import depth_message, rgb_message
    from spacevln.environments.robot.profile import Images

    profile = RobotProfile(name="bag", mount=Mount(), images=Images(width_px=0))
    topics, camera = profile.topics, Camera(32, 24, 79.0, 0.88)
    rgb, depth = np.full((24, 32, 3), 7, np.uint8), np.full((24, 32), 2.0, np.float32)
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        names = {topics.rgb: Image, topics.depth: Image, topics.camera_info: CameraInfo, topics.odometry: Odometry}
        connections = {
            name: writer.add_connection(name, TYPE_NAMES[kind], typestore=wire.typestore()) for name, kind in names.items()
        }
        for k in range(30):
            header = Header(1_000_000_000 + k * 50_000_000, "camera")
            pose = Odometry(Header(header.stamp_ns, "odom"), "base", Vector3(3.0 + 0.02 * k), Quaternion())
            said = {topics.odometry: pose, topics.camera_info: info_of(camera, header)}
            if k % 3 == 1:
                said |= {topics.depth: depth_message(depth, header), topics.rgb: rgb_message(rgb, header)}
            for name, message in said.items():
                writer.write(connections[name], header.stamp_ns, wire.encode(message))
    frames = list(read_bag(tmp_path / "bag", profile))
    assert len(frames) == 10
    assert frames[0][1].pose.x_m == 0.0
    assert frames[-1][1].pose.x_m == pytest.approx(0.54)
    assert np.array_equal(frames[3][1].rgb, rgb)
    assert (frames[3][1].depth_m == 2.0).all()
    [mcap] = (tmp_path / "bag").glob("*.mcap")
    assert len(list(read_bag(mcap, profile))) == 10
    with pytest.raises(RecordError, match="none of the profile's topics"):
        list(
            read_bag(
                mcap,
                RobotProfile(
                    name="x",
                    topics=profile.topics.model_copy(update=dict.fromkeys(("rgb", "depth", "camera_info", "odometry"), "/other")),
                ),
            )
        )
