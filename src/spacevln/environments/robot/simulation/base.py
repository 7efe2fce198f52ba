"""A differential-drive base: lag, acceleration, slip, contact, and its own command time-out."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from spacevln.core.geometry import Pose, wrap_angle
from spacevln.environments.robot.simulation.world import World

_STEP_S = 0.01
_SLIP_TIME_S = 0.5


@dataclass(frozen=True, slots=True)
class BaseSettings:
    """Of the simulated base.

    Args:
        radius_m: of the disc that collides.
        lag_s: time constant with which the wheels follow a command.
        accel_m_s2, turn_accel_rad_s2: that the motors have.
        slip: standard deviation of the share of the wheels' way that is lost or won.
        command_timeout_s: without a command for so long, the base stops by itself.
    """

    radius_m: float = 0.18
    lag_s: float = 0.06
    accel_m_s2: float = 1.5
    turn_accel_rad_s2: float = 6.0
    slip: float = 0.03
    command_timeout_s: float = 0.25


class SimulatedBase:
    """The body's true motion, scene frame."""

    def __init__(self, world: World, pose: Pose, settings: BaseSettings, rng: np.random.Generator, now_s: float) -> None:
        self.world, self.pose, self._settings, self._rng = world, pose, settings, rng
        self.speed_m_s = self.turn_rad_s = 0.0
        self.blocked = False
        self.contacts = 0
        self.hardest_contact_m_s = 0.0
        self.travelled_m = 0.0
        self._command, self._command_s, self._now_s = (0.0, 0.0), float("-inf"), now_s
        self._slip = np.zeros(2)
        self._touching = False

    def command(self, speed_m_s: float, turn_rad_s: float, now_s: float) -> None:
        """A velocity command arrives."""
        self._command, self._command_s = (speed_m_s, turn_rad_s), now_s

    @property
    def commanded(self) -> tuple[float, float]:
        """What the base obeys now: the last command, or standing still when that is older than its time-out."""
        return self._command if self._now_s - self._command_s <= self._settings.command_timeout_s else (0.0, 0.0)

    def place(self, pose: Pose) -> None:
        """Carry the robot to a pose."""
        self.pose, self.speed_m_s, self.turn_rad_s = pose, 0.0, 0.0

    def advance(self, now_s: float) -> None:
        """Move on to a time."""
        while self._now_s + _STEP_S <= now_s + 1e-9:
            self._now_s += _STEP_S
            self._step()

    def _step(self) -> None:
        settings = self._settings
        goal_v, goal_w = self.commanded
        if self.blocked:
            self.speed_m_s = self.turn_rad_s = 0.0
            return
        share = _STEP_S / (settings.lag_s + _STEP_S)
        most_v, most_w = settings.accel_m_s2 * _STEP_S, settings.turn_accel_rad_s2 * _STEP_S
        self.speed_m_s += max(-most_v, min(most_v, share * (goal_v - self.speed_m_s)))
        self.turn_rad_s += max(-most_w, min(most_w, share * (goal_w - self.turn_rad_s)))
        decay = math.exp(-_STEP_S / _SLIP_TIME_S)
        self._slip = decay * self._slip + math.sqrt(1 - decay**2) * settings.slip * self._rng.standard_normal(2)
        moved_m = self.speed_m_s * _STEP_S * (1 - self._slip[0])
        turned_rad = self.turn_rad_s * _STEP_S * (1 - self._slip[1])
        self._move(float(moved_m), float(turned_rad))

    def _move(self, moved_m: float, turned_rad: float) -> None:
        yaw = self.pose.yaw_rad + turned_rad / 2
        dx, dy = moved_m * math.cos(yaw), moved_m * math.sin(yaw)
        then, hit = self.world.sweep(self.pose, dx, dy, self._settings.radius_m)
        if hit:
            if not self._touching:
                self.contacts += 1
                self.hardest_contact_m_s = max(self.hardest_contact_m_s, abs(self.speed_m_s))
            self.speed_m_s = 0.0
        self._touching = hit
        self.travelled_m += self.pose.distance_m(then.x_m, then.y_m)
        self.pose = Pose(then.x_m, then.y_m, then.z_m, wrap_angle(self.pose.yaw_rad + turned_rad))
