"""One attempt at an instruction of a route, wherever it is driven."""

from __future__ import annotations

import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.assembly.robots import connect, lockstep, simulated_profile
from spacevln.assembly.simulated_robot import RobotTruth, SimulatedRobotProcess
from spacevln.cli.robot.drive import attempt
from spacevln.core import Pose
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.episode import Episode
from spacevln.evaluation.robot_routes import Row, Trial
from spacevln.recording import ResultFile, episode_directory, read_events
from spacevln.recording.schema import EpisodeEndedLine

if TYPE_CHECKING:
    from spacevln.environments.robot.motion import Times
    from spacevln.environments.robot.profile import RobotProfile


@dataclass(frozen=True, slots=True)
class Drive:
    """What an attempt left: where the robot stopped, in the frame of the goal; its times; what it touched."""

    result: ResultFile
    end: Pose | None
    seconds: float
    times: Times | None = None
    truth: RobotTruth | None = None


@dataclass(frozen=True, slots=True)
class Setup:
    """Where trials are driven and how they are judged.

    Args:
        on: ``robot``, ``simulated``, ``lockstep``, ``ideal``.
        stop: ``tracked`` or ``measured``, of a real robot.
        radius_m: of success.
        profile: of the real robot.
        directory: of the records.
        options: of the agent.
    """

    on: str
    stop: str
    radius_m: float
    profile: RobotProfile
    directory: Path
    options: dict[str, Any]

    def attempt(self, trial: Trial) -> Row:
        """Drive a trial, judge it.

        Raises:
            UsageError: the route is not in an embedded house, and this needs one.
        """
        if self.on != "robot" and (trial.route.scene is None or trial.route.start is None):
            raise click.UsageError(f"Route {trial.route.id!r} has no scene and start: --on {self.on} needs both.")
        spec = trial.spec
        folder = episode_directory(self.directory, spec.episode_id)
        shutil.rmtree(folder, ignore_errors=True)  # of an attempt that was interrupted
        ways = {"robot": self._robot, "simulated": self._simulated, "lockstep": self._lockstep, "ideal": self._ideal}
        drive = ways[self.on](trial, folder)
        error_m = self._error_m(trial, drive.end)
        stopped, times, truth = drive.result.status == "stopped", drive.times, drive.truth
        return Row(
            episode_id=spec.episode_id,
            setting=trial.route.setting,
            status=drive.result.status,
            stopped=stopped,
            NE_m=round(error_m, 3),
            success=stopped and error_m <= self.radius_m,
            judged_by=self.stop if self.on == "robot" else self.on,
            seconds=round(drive.seconds, 1),
            first_motion_s=None if times is None else times.first_motion_s,
            idle_share=None if times is None else round(times.idle_share(drive.seconds), 3),
            held_s=None if times is None else round(times.held_s, 2),
            contacts=None if truth is None else truth.contacts,
            hardest_contact_m_s=None if truth is None else round(truth.hardest_contact_m_s, 3),
        )

    def _error_m(self, trial: Trial, end: Pose | None) -> float:
        """Horizontal distance from where the robot stopped to the goal [m]."""
        if self.on == "robot" and self.stop == "measured":
            return float(click.prompt("distance from the robot to the goal [m]", type=click.FloatRange(min=0)))
        x, y = trial.route.goal_m
        start = trial.spec.start if self.on != "robot" else Pose(0.0, 0.0)
        return (end or start).distance_m(x, y)

    def _robot(self, trial: Trial, folder: Path) -> Drive:
        spec = trial.spec
        click.pause(f"{spec.episode_id}: put the robot at the start of {trial.route.id!r}, then press a key ...")
        environment, _ = connect(self.profile)
        result = attempt(environment, Episode(spec), folder, dict(self.options), self.directory, [])
        return Drive(result, _told_end(folder), result.timing_s, environment.times)

    def _simulated(self, trial: Trial, folder: Path) -> Drive:
        spec, profile = trial.spec, simulated_profile()
        peer = SimulatedRobotProcess(profile, spec.scene, spec.start, trial.variant)
        try:
            environment, _ = connect(profile, place=peer.place, simulated=True)
            result = attempt(environment, Episode(spec), folder, dict(self.options), self.directory, [])
            truth = peer.measure()
        finally:
            peer.close()
        return Drive(result, truth.pose, result.timing_s, environment.times, truth)

    def _lockstep(self, trial: Trial, folder: Path) -> Drive:
        spec = trial.spec
        environment, parts = lockstep(spec.start, spec.scene, trial.variant)
        begin_s, base = parts.clock.now_s(), parts.robot.base
        try:
            result = attempt(environment, Episode(spec), folder, dict(self.options), self.directory, [])
        finally:
            base.world.close()
        truth = RobotTruth(base.pose, base.contacts, base.hardest_contact_m_s, base.travelled_m)
        return Drive(result, base.pose, parts.clock.now_s() - begin_s, environment.times, truth)

    def _ideal(self, trial: Trial, folder: Path) -> Drive:
        from spacevln.cli.model_options import access_from
        from spacevln.cli.options import configuration_from

        access = access_from(dict(self.options), self.directory)
        with Session(configuration_from(self.options), access=access) as session:
            result = session.attempt(Episode(trial.spec), folder)
        end = _told_end(folder)
        return Drive(result, None if end is None else trial.spec.start.compose(end), result.timing_s)


def _told_end(folder: Path) -> Pose | None:
    """Where the robot believed to be at the end, in the frame of its start."""
    ends = [line.pose for line in read_events(folder) if isinstance(line, EpisodeEndedLine)]
    return ends[-1] if ends else None
