"""A benchmark run that costs nothing: a body in the void, a blind walker, sixteen episodes in four buildings.

``python scripted_bench.py DIRECTORY WORKERS [PACE_S [COUNT [HITS]]]`` runs or resumes it as ``spacevln bench`` would; where HITS
is given, the world waits for that many hits, spread over the run and counted by the size of ``DIRECTORY/hits``.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import time
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spacevln.assembly import Configuration
from spacevln.core import (
    Action,
    Camera,
    Detector,
    EnvironmentSpec,
    EpisodeSpec,
    InstructionTask,
    Motion,
    MoveForward,
    Observation,
    Pose,
    Stop,
)
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.baselines import BLIND_FORWARDS
from spacevln.evaluation.datasets import EpisodeSequence
from spacevln.evaluation.episode import Episode, Points
from spacevln.evaluation.journal import held
from spacevln.evaluation.pool import Attempt, WatchedPool, Workplace
from spacevln.evaluation.processes import Processes
from spacevln.evaluation.runner import alone, run_episodes, write_summary
from spacevln.recording import RecordLevel, ResultFile, SummaryFile, episode_directory, read_result

COUNT, SCENES = 16, 4
CAMERA = Camera(width_px=8, height_px=6, hfov_deg=79, height_m=0.88)


@dataclass(frozen=True)
class Gate:
    """Keeps a run from getting ahead of the hits that it is to take: after the n-th share of results comes the n-th hit.

    An episode waits at a step of its own, and not when it is begun again: who was hit may not be hit twice.
    """

    directory: Path
    episodes: int
    hits: int = 0

    def step_of(self, episode_id: str, before: int) -> int | None:
        """Before which forward an episode waits."""
        return zlib.crc32(episode_id.encode()) % BLIND_FORWARDS if self.hits and not before else None

    def tell(self, state: str) -> None:
        """Say which episode this worker is at, ``""`` for none: who hits looks first."""
        if self.hits:
            folder = self.directory / "workers"
            folder.mkdir(exist_ok=True)
            (folder / str(os.getpid())).write_text(state)

    def wait(self) -> None:
        while self._results() >= self.episodes * (self._taken() + 1) // (self.hits + 1):
            time.sleep(0.1)

    def _results(self) -> int:
        return sum(1 for _ in self.directory.glob("episodes/*/result.json"))

    def _taken(self) -> int:
        file = self.directory / "hits"
        return file.stat().st_size if file.exists() else 0


class Void:
    """Nothing but a body; every forward takes ``pace_s`` seconds."""

    def __init__(self, pace_s: float, gate: Gate) -> None:
        self.spec = EnvironmentSpec(camera=CAMERA)
        self.waits_at: int | None = None
        self._pace_s = pace_s
        self._gate = gate
        self._pose = Pose(0.0, 0.0)
        self._forwards = 0

    def reset(self, episode: EpisodeSpec) -> Observation:
        if episode.task == InstructionTask("die"):
            os._exit(9)
        if episode.task == InstructionTask("sleep"):
            time.sleep(3600)
        if episode.task == InstructionTask("fill"):  # what a full disk does: the next write of this process is refused
            resource.setrlimit(resource.RLIMIT_FSIZE, (1, resource.getrlimit(resource.RLIMIT_FSIZE)[1]))
        self._pose, self._forwards = Pose(0.0, 0.0), 0
        return self.observe()

    def observe(self) -> Observation:
        image = np.zeros((6, 8, 3), np.uint8)
        return Observation(rgb=image, depth_m=np.ones((6, 8), np.float32), pose=self._pose, camera=CAMERA)

    def execute(self, action: Action) -> Motion:
        if isinstance(action, MoveForward):
            if self._forwards == self.waits_at:
                self._gate.wait()
            self._forwards += 1
            time.sleep(self._pace_s)
            self._pose = self._pose.compose(Pose(action.distance_m, 0.0))
            return Motion(action.distance_m, 0.0, False)
        return Motion(0.0, 0.0, False)

    def close(self) -> None:
        pass


class Crow:
    """Truth as the crow flies: a goal ahead of the start."""

    radius_m = 3.0

    def __init__(self, goal_m: float) -> None:
        self.goals = np.array([[goal_m, 0.0, 0.0]])
        self.shortest_path = np.array([[0.0, 0.0, 0.0], [goal_m, 0.0, 0.0]])
        self.reference_path: Points | None = self.shortest_path

    def distances_m(self, positions: Points) -> Points:
        return np.linalg.norm(positions - self.goals, axis=1)

    def reached(self, position: Points) -> bool:
        return bool(self.distances_m(position[None])[0] < self.radius_m)

    def viewpoint_m(self, position: Points) -> float | None:
        del position
        return None

    def follow(self, pose: Pose) -> Action:
        return MoveForward() if self.distances_m(pose.position_m[None])[0] > 0.2 else Stop()


def scripted_episodes(count: int = COUNT, instructions: tuple[str, ...] = ()) -> EpisodeSequence:
    episodes = []
    for index in range(count):
        words = instructions[index] if index < len(instructions) else "Go ahead."
        spec = EpisodeSpec(f"void-{index:02d}", f"void-{index % SCENES}", Pose(0.0, 0.0), InstructionTask(words))
        episodes.append(Episode(spec, Crow(4.0 + index)))
    return EpisodeSequence.of(episodes)


@contextmanager
def open_void(job: str, detector: Detector | None = None, /) -> Iterator[Attempt]:
    del detector
    settings = json.loads(job)
    episodes = scripted_episodes(settings["count"], tuple(settings["instructions"]))
    gate = Gate(Path(settings["directory"]), settings["count"], settings["hits"])
    void = Void(settings["pace_s"], gate)
    gate.tell("")
    with Session(Configuration(driver="forward"), void) as session:

        def attempt(episode_id: str, before: int) -> None:
            folder = episode_directory(Path(settings["directory"]), episode_id)
            gate.tell(episode_id)
            with held(folder):
                if read_result(folder) is None:
                    void.waits_at = gate.step_of(episode_id, before)
                    session.attempt(episodes.by_id(episode_id), folder, level=RecordLevel.LIGHT, restarts=before)
            gate.tell("")

        yield attempt


def job(directory: Path, pace_s: float = 0.0, count: int = COUNT, instructions: tuple[str, ...] = (), hits: int = 0) -> str:
    """What :func:`open_void` opens."""
    return json.dumps({"directory": str(directory), "pace_s": pace_s, "count": count, "instructions": instructions, "hits": hits})


def _ignore(result: ResultFile) -> None:
    del result


def run(
    directory: Path,
    workers: int = 2,
    pace_s: float = 0.0,
    count: int = COUNT,
    instructions: tuple[str, ...] = (),
    deadline_s: float | None = None,
    hits: int = 0,
    workplace: Workplace | None = None,
) -> SummaryFile:
    episodes = scripted_episodes(count, instructions)
    with alone(directory):
        what = job(directory, pace_s, count, instructions, hits)
        pool = WatchedPool(workplace or Processes(), open_void, what, workers, deadline_s)
        run_episodes(episodes, directory, pool, _ignore)
    return write_summary(episodes, directory)


if __name__ == "__main__":
    target = Path(sys.argv[1])
    target.mkdir(parents=True, exist_ok=True)
    pace, number, to_take = (*sys.argv[3:6], *("0", str(COUNT), "0")[len(sys.argv[3:6]) :])
    run(target, int(sys.argv[2]), float(pace), int(number), hits=int(to_take))
