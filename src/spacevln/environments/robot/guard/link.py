"""The agent's end of the pipe to the guard, and the same in one process for a simulated clock."""

from __future__ import annotations

import atexit
import contextlib
import json
import subprocess
import sys
import threading

from spacevln.core.errors import EnvironmentFailure
from spacevln.environments.robot.guard.process import FAREWELL_S
from spacevln.environments.robot.guard.status import GuardState, GuardStatus, StopReason
from spacevln.environments.robot.guard.wheel import WheelGuard
from spacevln.environments.robot.profile import RobotProfile

HANG_UP_S = 0.05
"""How long another thread may finish its line at the end of the interpreter."""


class GuardProcess:
    """Starts the guard; implements :class:`~spacevln.environments.robot.guard.status.WheelLink`.

    Args:
        profile: of the robot.
        dry: no motion.
    """

    def __init__(self, profile: RobotProfile, *, dry: bool = False) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "spacevln.environments.robot.guard"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            start_new_session=True,  # a Ctrl-C in the terminal must not end it with the agent
        )
        self._status = GuardStatus(GuardState.HELD, StopReason.POSE)
        self._lock, self._closed = threading.Lock(), False
        self._say({"profile": profile.model_dump(mode="json"), "dry": dry})
        self._reader = threading.Thread(target=self._listen, name="guard", daemon=True)
        self._reader.start()
        atexit.register(self._hang_up)  # an interrupted interpreter takes its time to end, and the pipe would stay open as long

    @property
    def pid(self) -> int:
        """Of the guard's process."""
        return self._process.pid

    def wish(self, speed_m_s: float, turn_rad_s: float) -> None:
        """Ask for velocities."""
        self._say({"wish": [speed_m_s, turn_rad_s]})

    def operate(self, word: str) -> None:
        """Stop or resume."""
        self._say({"operate": word})

    def status(self) -> GuardStatus:
        """The newest report; ENDED when the guard is gone."""
        return self._status

    def close(self) -> None:
        """Let go and wait until the guard has commanded zero."""
        if self._closed:
            return
        self._closed = True
        atexit.unregister(self._hang_up)
        with self._lock:
            if self._process.stdin is not None:
                self._process.stdin.close()
        try:
            self._process.wait(FAREWELL_S + 5.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._reader.join()
        if self._process.stdout is not None:
            self._process.stdout.close()

    def _hang_up(self) -> None:
        """End the pipe, which stops the wheels, and wait for nothing."""
        mine = self._lock.acquire(timeout=HANG_UP_S)
        with contextlib.suppress(OSError):
            if self._process.stdin is not None:
                self._process.stdin.close()
        if mine:
            self._lock.release()

    def _say(self, words: dict[str, object]) -> None:
        with self._lock:
            if self._process.stdin is None or self._closed:
                raise EnvironmentFailure("The wheel guard was let go and cannot be asked: open the robot anew.")
            try:
                self._process.stdin.write(json.dumps(words) + "\n")
                self._process.stdin.flush()
            except OSError as error:
                raise EnvironmentFailure(
                    "The wheel guard has ended: the base stops by its own command time-out; see its message above."
                ) from error

    def _listen(self) -> None:
        if self._process.stdout is not None:
            for line in self._process.stdout:
                said = json.loads(line)
                said |= {"state": GuardState(said["state"]), "reason": StopReason(said["reason"])}
                self._status = GuardStatus(**said)
        if self._status.state is not GuardState.ENDED:
            self._status = GuardStatus(GuardState.ENDED, StopReason.TRANSPORT)


class GuardInProcess:
    """A guard that somebody else ticks, under a simulated clock."""

    def __init__(self, guard: WheelGuard) -> None:
        self._guard = guard

    def wish(self, speed_m_s: float, turn_rad_s: float) -> None:
        """Ask for velocities."""
        self._guard.wish(speed_m_s, turn_rad_s)

    def operate(self, word: str) -> None:
        """Stop or resume."""
        self._guard.operate(word)

    def status(self) -> GuardStatus:
        """The newest report."""
        return self._guard.status()

    def close(self) -> None:
        """Stand still."""
        self._guard.wish(0.0, 0.0)
