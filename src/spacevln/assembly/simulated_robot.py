"""The simulated robot in a process of its own, and the handle by which an evaluation holds it.

The process reads one JSON object per line and answers each with one: ``{"place": [x, y, z, yaw], "scene": NAME}``,
``{"faults": {...}}``, ``{"truth": true}``. It ends with its input.
"""

from __future__ import annotations

import json
import subprocess
import sys
import threading
from dataclasses import dataclass
from typing import IO, Any

import numpy as np

from spacevln.assembly.robots import HouseWorld
from spacevln.core import EnvironmentFailure, EpisodeSpec, Pose
from spacevln.environments.robot.clock import SystemClock
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.simulation.robot import Faults, SensorSettings, SimulatedRobot
from spacevln.environments.robot.transport import open_transport

_STEP_S = 0.01


@dataclass(frozen=True, slots=True)
class RobotTruth:
    """What only the simulator knows: scene frame; contacts since the start."""

    pose: Pose
    contacts: int
    hardest_contact_m_s: float
    travelled_m: float


class RobotServer:
    """Runs a simulated robot in real time.

    Args:
        profile: of the robot; a Zenoh endpoint is listened at.
        scene, start: where it stands.
        seed: of all noise.
        sensors: other than the default ones.
    """

    def __init__(
        self, profile: RobotProfile, scene: str, start: Pose, seed: int = 0, sensors: SensorSettings | None = None
    ) -> None:
        endpoint = profile.endpoint if profile.transport != "zenoh" else f"listen/{profile.endpoint}"
        self._transport = open_transport(profile.transport, domain=profile.domain, distro=profile.distro, endpoint=endpoint)
        self._clock, self._world = SystemClock(), HouseWorld(scene)
        rng = np.random.default_rng(seed)
        self.robot = SimulatedRobot(self._transport, profile, self._world, start, self._clock, rng, sensors=sensors)
        self._ended = threading.Event()
        self._threads = [threading.Thread(target=self._look), threading.Thread(target=self._move)]
        for thread in self._threads:
            thread.start()

    def answer(self, said: dict[str, Any]) -> dict[str, Any]:
        """Obey one line."""
        if "place" in said:
            world = None
            if said.get("scene", self._world.scene) != self._world.scene:
                world = self._world = HouseWorld(said["scene"])
            self.robot.place(Pose(*said["place"]), world)
        elif "faults" in said:
            faults = dict(said["faults"])
            self.robot.faults = Faults(**{**faults, "silent": frozenset(faults.get("silent", ()))})
        base = self.robot.base
        pose = base.pose
        return {
            "pose": [pose.x_m, pose.y_m, pose.z_m, pose.yaw_rad],
            "contacts": base.contacts,
            "hardest_contact_m_s": base.hardest_contact_m_s,
            "travelled_m": base.travelled_m,
        }

    def close(self) -> None:
        """End."""
        self._ended.set()
        for thread in self._threads:
            thread.join()
        self._transport.close()

    def _look(self) -> None:
        seen = self._world
        while not self._ended.is_set():
            if self.robot.base.world is not seen:
                seen.close()
                seen = self._world
            if not self.robot.look():
                self._ended.wait(_STEP_S)
        seen.close()

    def _move(self) -> None:
        while not self._ended.wait(_STEP_S):
            self.robot.move()


def serve(source: IO[str], sink: IO[str]) -> None:
    """The process: the first line says what robot, the others are obeyed."""
    first = json.loads(source.readline())
    profile = RobotProfile.model_validate(first["profile"])
    server = RobotServer(profile, first["scene"], Pose(*first["start"]), first["seed"])
    try:
        _tell(sink, server.answer({}))
        for line in source:
            _tell(sink, server.answer(json.loads(line)))
    finally:
        server.close()


class SimulatedRobotProcess:
    """Starts the process and talks to it."""

    def __init__(self, profile: RobotProfile, scene: str, start: Pose, seed: int = 0) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "spacevln.assembly.simulated_robot"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        say = {"profile": profile.model_dump(mode="json"), "scene": scene, "start": _numbers(start), "seed": seed}
        self.truth = self._ask(say)

    def place(self, episode: EpisodeSpec) -> None:
        """Carry the robot to an episode's start."""
        self._ask({"place": _numbers(episode.start), "scene": episode.scene})

    def fail(self, **faults: Any) -> None:
        """Break something (:class:`~spacevln.environments.robot.simulation.robot.Faults`), or mend everything."""
        self._ask({"faults": faults})

    def measure(self) -> RobotTruth:
        """Where it really is, and what it touched."""
        return self._ask({"truth": True})

    def close(self) -> None:
        """End the process."""
        self._process.communicate(timeout=30)

    def _ask(self, said: dict[str, Any]) -> RobotTruth:
        if self._process.stdin is None or self._process.stdout is None:
            raise EnvironmentFailure("The simulated robot has no pipe: start it anew.")
        try:
            self._process.stdin.write(json.dumps(said) + "\n")
            self._process.stdin.flush()
            answer = self._process.stdout.readline()
        except OSError as error:
            raise EnvironmentFailure("The simulated robot has ended: see its message above.") from error
        if not answer:
            raise EnvironmentFailure("The simulated robot has ended: see its message above.")
        told = json.loads(answer)
        return RobotTruth(Pose(*told["pose"]), told["contacts"], told["hardest_contact_m_s"], told["travelled_m"])


def _tell(sink: IO[str], said: dict[str, Any]) -> None:
    sink.write(json.dumps(said) + "\n")
    sink.flush()


def _numbers(pose: Pose) -> list[float]:
    return [pose.x_m, pose.y_m, pose.z_m, pose.yaw_rad]


if __name__ == "__main__":
    serve(sys.stdin, sys.stdout)
