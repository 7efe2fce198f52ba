"""A simulated robot, its guard and the agent under one simulated clock: every wait of the agent is lived through by the robot."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spacevln.core.geometry import Pose
from spacevln.environments.robot.guard.link import GuardInProcess
from spacevln.environments.robot.guard.process import WheelHolder
from spacevln.environments.robot.profile import RobotProfile
from spacevln.environments.robot.simulation.base import BaseSettings
from spacevln.environments.robot.simulation.robot import SensorSettings, SimulatedRobot
from spacevln.environments.robot.simulation.world import World
from spacevln.environments.robot.transports.loopback import LoopbackNetwork, LoopbackTransport

_TICK_S = 0.01
_EPOCH_NS = 1_700_000_000_000_000_000


class SimulatedClock:
    """Implements :class:`~spacevln.environments.robot.clock.Clock`; time passes only in :meth:`sleep`."""

    def __init__(self) -> None:
        self._ticks = 0
        self.each_tick: list[Callable[[], None]] = []

    def now_s(self) -> float:
        """Steady seconds."""
        return self._ticks * _TICK_S

    def stamp_ns(self) -> int:
        """Time of day [ns]."""
        return _EPOCH_NS + round(self._ticks * _TICK_S * 1e9)

    def sleep(self, duration_s: float) -> None:
        """Let everybody live through it, at least one tick."""
        for _ in range(max(1, round(duration_s / _TICK_S))):
            self._ticks += 1
            for act in self.each_tick:
                act()


class Lockstep:
    """The parts, wired.

    Attributes:
        clock, transport, link: what a :class:`~spacevln.environments.robot.environment.RobotEnvironment` needs.
        robot: its truth and its faults.
        holder: the guard.
        commands: every velocity that the guard commanded: time [s], forward [m/s], turn [rad/s].
    """

    def __init__(
        self,
        profile: RobotProfile,
        world: World,
        start: Pose,
        seed: int = 0,
        *,
        base: BaseSettings | None = None,
        sensors: SensorSettings | None = None,
        dry: bool = False,
    ) -> None:
        network, self.clock = LoopbackNetwork(), SimulatedClock()
        rng = np.random.default_rng(seed)
        self.transport = LoopbackTransport(network)
        self.robot = SimulatedRobot(
            LoopbackTransport(network), profile, world, start, self.clock, rng, base=base, sensors=sensors
        )
        self.holder = WheelHolder(LoopbackTransport(network), profile, self.clock, dry=dry)
        self.link = GuardInProcess(self.holder.guard)
        self.commands: list[tuple[float, float, float]] = []
        self._every = max(1, round(1 / profile.control_hz / _TICK_S))
        self._count = 0
        self.clock.each_tick.append(self._tick)

    def _tick(self) -> None:
        self.robot.move()
        self.robot.look()
        self._count += 1
        if self._count % self._every == 0:
            self.holder.tick()
            self.commands.append((self.clock.now_s(), *self.robot.base.commanded))
