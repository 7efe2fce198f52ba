"""What a robot's link loses and how late it is: two processes over loopback, images of 640x480 at 10 Hz, odometry at 50 Hz.

Run with ``python benchmarks/robot_link.py dds --seconds 600`` (or ``zenoh``); prints one JSON object. The parent plays the agent
and writes velocities at 50 Hz; the child plays the robot. Needs the extra ``robot``.
"""

from __future__ import annotations

import argparse
import itertools
import json
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spacevln.core import Camera
from spacevln.environments.robot.calibration import info_of
from spacevln.environments.robot.images import depth_message, rgb_message
from spacevln.environments.robot.messages import NANO, CameraInfo, Header, Image, Odometry, Quaternion, Twist, Vector3
from spacevln.environments.robot.transport import Qos, Topic, Transport, open_transport

CAMERA = Camera(640, 480, 79.0, 0.88)
IMAGE_HZ, ODOMETRY_HZ, COMMAND_HZ = 10, 50, 50
RGB, DEPTH, INFO = Topic("/camera/rgb", Image), Topic("/camera/depth", Image), Topic("/camera/info", CameraInfo)
ODOMETRY, COMMAND = Topic("/odom", Odometry), Topic("/cmd_vel", Twist, Qos.RELIABLE)
STREAMS: tuple[Topic[Any], ...] = (RGB, DEPTH, INFO, ODOMETRY)
DRAIN_S = 0.5


def play_robot(transport: Transport, seconds: float) -> dict[str, Any]:
    """Publish for a while; what was sent and heard."""
    commands = list[int]()
    transport.subscribe(COMMAND, lambda twist: commands.append(round(twist.linear.y)))
    messages = _messages()
    for topic, message in messages.items():
        transport.publish(topic, message)  # announces the writers; stamp 0 is not counted
    _wait(lambda: bool(commands) and all(transport.peers(topic) for topic in STREAMS))
    sent = dict.fromkeys((topic.name for topic in STREAMS), 0)
    begin_s, cpu_s = time.monotonic(), time.process_time()
    for k in range(round(seconds * ODOMETRY_HZ)):
        due_s = begin_s + k / ODOMETRY_HZ
        time.sleep(max(0.0, due_s - time.monotonic()))
        for topic in STREAMS if k % (ODOMETRY_HZ // IMAGE_HZ) == 0 else (ODOMETRY,):
            message = messages[topic]
            transport.publish(topic, replace(message, header=replace(message.header, stamp_ns=time.time_ns())))
            sent[topic.name] += 1
    cpu_s = time.process_time() - cpu_s
    time.sleep(DRAIN_S)
    return {"sent": sent, "commands": list(commands), "cpu_s": cpu_s}


def play_agent(transport: Transport, robot: subprocess.Popen[str]) -> dict[str, Any]:
    """Listen and command until the robot ends; what came, and how late [ms]."""
    late_ms: dict[str, list[float]] = {topic.name: [] for topic in STREAMS}
    for topic in STREAMS:
        transport.subscribe(topic, _noting(late_ms[topic.name]))
    ended, told = threading.Event(), list[str]()

    def listen() -> None:
        told.append(robot.communicate()[0])
        ended.set()

    listener = threading.Thread(target=listen)
    listener.start()
    cpu_s, begin_s = 0.0, 0.0
    for number in itertools.count():
        if ended.wait(1 / COMMAND_HZ):
            break
        if not begin_s and any(late_ms.values()):
            cpu_s, begin_s = time.process_time(), time.monotonic()
        transport.publish(COMMAND, Twist(Vector3(x=0.1, y=number)))
    took_s, cpu_s = time.monotonic() - begin_s, time.process_time() - cpu_s
    listener.join()
    return _report(json.loads(told[0]), late_ms, cpu_s, took_s)


def _report(robot: dict[str, Any], late_ms: dict[str, list[float]], cpu_s: float, took_s: float) -> dict[str, Any]:
    heard = robot["commands"]
    meant = range(heard[0], max(heard) + 1)
    streams = {
        name: {
            "sent": robot["sent"][name],
            "lost": robot["sent"][name] - len(late),
            "median_ms": round(float(np.median(late)), 2),
            "p99_ms": round(float(np.percentile(late, 99)), 2),
            "max_ms": round(max(late), 2),
        }
        for name, late in late_ms.items()
    }
    return {
        "seconds": round(took_s, 1),
        "streams": streams,
        "commands": {
            "heard": len(heard),
            "lost": len(set(meant) - set(heard)),
            "strange": len(heard) - len(set(meant) & set(heard)),  # twice, or of another writer
        },
        "cpu_percent": {"robot": round(100 * robot["cpu_s"] / took_s, 1), "agent": round(100 * cpu_s / took_s, 1)},
    }


def _messages() -> dict[Topic[Any], Any]:
    """One of each, of noise, which nothing can compress; made beforehand: what is measured is the way of the bytes."""
    rng, header = np.random.default_rng(0), Header(0, "camera")
    rgb = rng.integers(0, 256, (480, 640, 3), dtype=np.uint8)
    depth_m = rng.uniform(0.5, 9.0, (480, 640)).astype(np.float32)
    return {
        RGB: rgb_message(rgb, header),
        DEPTH: depth_message(depth_m, header),
        INFO: info_of(CAMERA, header),
        ODOMETRY: Odometry(header, "base_link", Vector3(), Quaternion()),
    }


def _noting(late_ms: list[float]) -> Any:
    def note(message: Any) -> None:
        if message.header.stamp_ns:
            late_ms.append((time.time_ns() - message.header.stamp_ns) / NANO * 1e3)

    return note


def _wait(holds: Any, limit_s: float = 30.0) -> None:
    end_s = time.monotonic() + limit_s
    while not holds():
        if time.monotonic() > end_s:
            raise SystemExit("the two processes did not find each other")
        time.sleep(0.01)


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure one transport."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("transport", choices=("dds", "zenoh"))
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--domain", type=int, default=77)
    parser.add_argument("--port", type=int, default=17_977)
    parser.add_argument("--play-robot", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    address = "127.0.0.1" if given.transport == "dds" else f"tcp/127.0.0.1:{given.port}"
    listening = given.transport == "zenoh" and not given.play_robot
    transport = open_transport(given.transport, domain=given.domain, endpoint=f"listen/{address}" if listening else address)
    try:
        if given.play_robot:
            print(json.dumps(play_robot(transport, given.seconds)))
        else:
            again = [sys.executable, __file__, *(sys.argv[1:] if arguments is None else arguments), "--play-robot"]
            with subprocess.Popen(again, stdout=subprocess.PIPE, text=True) as robot:
                print(json.dumps({"transport": given.transport, **play_agent(transport, robot)}, indent=2))
    finally:
        transport.close()


if __name__ == "__main__":
    main()
