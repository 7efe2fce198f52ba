"""The runner: every episode gets exactly one result, whatever dies, fills up, hangs or is started twice."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
import scripted_bench
from made_runs import plain_results, workers_of

from spacevln.core import RecordError, UsageError
from spacevln.evaluation.datasets import Selection
from spacevln.evaluation.journal import NAME, Journal, held, note
from spacevln.evaluation.pool import Outcome, Queue
from spacevln.evaluation.runner import alone, claim_directory, run_episodes, write_summary
from spacevln.recording import ResultFile, RunFile, episode_directory, read_file

SCRIPT = Path(scripted_bench.__file__)


def result_of(folder: Path) -> ResultFile:
    return read_file(folder / "result.json", ResultFile)


def test_the_queue_keeps_a_worker_in_its_building() -> None:
    queue = Queue([("a1", "A"), ("b1", "B"), ("a2", "A"), ("b2", "B")])
    assert queue.take(None, [None, None]) == "a1"
    assert queue.take(None, ["A", None]) == "b1"  # another building than the first worker's
    assert queue.take("A", ["A", "B"]) == "a2"
    queue.again("a2")
    assert queue.take("B", ["A", "B"]) == "b2"
    assert queue.take("B", ["A", "B"]) == "a2"
    assert not queue


def test_the_journal_counts_and_survives_a_cut_line(tmp_path: Path) -> None:
    assert Journal.read(tmp_path) == Journal()
    note(tmp_path, "started")
    note(tmp_path, "died", "exit code -9")
    note(tmp_path, "started")
    assert Journal.read(tmp_path) == Journal(2, 1, "exit code -9")
    path = tmp_path / NAME
    path.write_bytes(path.read_bytes()[:-10])
    assert Journal.read(tmp_path) == Journal(2, 1, "exit code -9")
    note(tmp_path, "started")
    assert Journal.read(tmp_path) == Journal(3, 1, "exit code -9")


def test_an_attempt_begins_in_a_clean_directory(tmp_path: Path) -> None:
    (tmp_path / "images").mkdir()
    (tmp_path / "images/0099_rgb.jpg").touch()
    (tmp_path / "events.jsonl").write_text("{}\n")
    note(tmp_path, "started")
    with held(tmp_path):
        assert [path.name for path in tmp_path.iterdir()] == [NAME]


def test_two_runners_do_not_share_a_directory(tmp_path: Path) -> None:
    with alone(tmp_path), pytest.raises(UsageError, match="at work"), alone(tmp_path):
        pass
    with alone(tmp_path, "-1-of-2"), alone(tmp_path, "-2-of-2"):
        pass


def run_file(suite: str, configuration_hash: str) -> RunFile:
    return RunFile(
        version="0",
        suite=suite,
        created="",
        command=(),
        configuration={},
        configuration_hash=configuration_hash,
        packages={},
        python="",
        platform="",
        git_revision=None,
    )


def test_a_directory_belongs_to_one_suite_and_configuration(tmp_path: Path) -> None:
    claim_directory(tmp_path, run_file("houses-vln", "a"))
    claim_directory(tmp_path, run_file("houses-vln", "a"))
    for suite, configuration in (("houses-vln", "b"), ("houses-objectnav", "a")):
        with pytest.raises(UsageError, match="another --out"):
            claim_directory(tmp_path, run_file(suite, configuration))


@pytest.mark.parametrize("count", [1, 2, 3, 7])
def test_shards_are_disjoint_and_complete(count: int) -> None:
    chosen = {"suite": "houses-vln", "seeds": (0, 20), "episodes": 18}
    whole = Selection.model_validate(chosen).load().ids
    shards = [Selection.model_validate({**chosen, "shard": (i, count)}) for i in range(1, count + 1)]
    parts = [shard.load().ids for shard in shards]
    assert sorted(name for part in parts for name in part) == sorted(whole)
    assert max(map(len, parts)) - min(map(len, parts)) <= 1
    assert {shard.name for shard in shards} == {Selection.model_validate(chosen).name}
    with pytest.raises(UsageError, match="does not exist"):
        Selection.model_validate({**chosen, "shard": (count + 1, count)}).load()


class Scripted:
    """A pool without processes: attempts what it is given, and dies as often as it is told."""

    def __init__(self, directory: Path, deaths: dict[str, int]) -> None:
        self._directory, self._deaths = directory, deaths
        self.handed_out: list[str] = []

    def outcomes(self, queue: Queue, begin: Callable[[str], int]) -> Iterator[Outcome]:
        with scripted_bench.open_void(scripted_bench.job(self._directory, count=3)) as attempt:
            while queue:
                name = queue.take()
                before = begin(name)
                self.handed_out.append(name)
                if self._deaths.get(name, 0):
                    self._deaths[name] -= 1
                    yield Outcome(name, "exit code -9")
                else:
                    attempt(name, before)
                    yield Outcome(name)


def test_one_death_restarts_the_second_is_a_failure_and_nothing_runs_twice(tmp_path: Path) -> None:
    episodes = scripted_bench.scripted_episodes(3)
    pool = Scripted(tmp_path, {"void-00": 1, "void-01": 2})
    told: list[ResultFile] = []
    run_episodes(episodes, tmp_path, pool, told.append)
    assert pool.handed_out == ["void-00", "void-00", "void-01", "void-01", "void-02"]
    assert [(result.episode_id, result.status, result.restarts) for result in told] == [
        ("void-00", "stopped", 1),
        ("void-01", "environment_failure", 1),
        ("void-02", "stopped", 0),
    ]
    assert "died 2 times, last: exit code -9" in told[1].detail
    assert told[1].metrics.SR == 0.0
    again = Scripted(tmp_path, {})
    retold: list[ResultFile] = []
    run_episodes(episodes, tmp_path, again, retold.append)
    assert again.handed_out == []
    assert retold == told  # a failure is not run again for a better result
    assert write_summary(episodes, tmp_path).episodes == 3


@pytest.mark.slow
def test_what_dies_hangs_or_fills_up(tmp_path: Path) -> None:
    words = ("Go ahead.", "die", "Go ahead.", "sleep")
    summary = scripted_bench.run(tmp_path, 2, count=5, instructions=words, deadline_s=3.0)
    assert summary.statuses == {"environment_failure": 2, "stopped": 3}
    died, late = (result_of(tmp_path / f"episodes/void-{index:02d}") for index in (1, 3))
    assert (died.restarts, late.restarts) == (1, 1)
    assert "exit code 9" in died.detail
    assert "longer than 3 s" in late.detail
    assert summary.metrics["SR"] == pytest.approx(20.0)  # failures stay in the denominator

    full = tmp_path / "full"  # the disk is full: a sentence, no result, and the next call goes on
    full.mkdir()
    with pytest.raises(RecordError, match=r"void-01.*File too large"):
        scripted_bench.run(full, 1, count=3, instructions=("Go ahead.", "fill"))
    assert not (full / "episodes/void-01/result.json").exists()
    assert not (full / "summary.json").exists()
    assert scripted_bench.run(full, 1, count=3).statuses == {"stopped": 3}


@pytest.mark.skipif(os.geteuid() != 0, reason="changes to another user to meet a directory that it may not write; needs root")
def test_a_read_only_directory_is_one_sentence(tmp_path: Path) -> None:
    tmp_path.chmod(0o755)
    os.seteuid(65534)
    try:
        for call in (lambda: claim_directory(tmp_path, run_file("s", "a")), lambda: note(tmp_path / "x", "started")):
            with pytest.raises(RecordError, match="give a writable --out"):
                call()
        with pytest.raises(RecordError, match="give a writable --out"), alone(tmp_path):
            pass
    finally:
        os.seteuid(0)


@pytest.mark.slow
def test_the_number_of_workers_does_not_matter(tmp_path: Path) -> None:
    runs = []
    for workers in (1, 3):
        folder = tmp_path / str(workers)
        folder.mkdir()
        scripted_bench.run(folder, workers)
        runs.append(plain_results(folder))
    assert runs[0] == runs[1]
    assert len(runs[0]) == scripted_bench.COUNT
    assert (tmp_path / "1/summary.json").read_bytes() == (tmp_path / "3/summary.json").read_bytes()


KILLS, EPISODES, PACE_S = 30, 62, 0.01


def starts(run: Path) -> int:
    return sum(Journal.read(path.parent).starts for path in run.glob(f"episodes/*/{NAME}"))


def wait_until(happened: Callable[[], bool], seconds: float) -> None:
    deadline = time.monotonic() + seconds
    while not happened() and time.monotonic() < deadline:
        time.sleep(0.1)


def begin(run: Path, hits: int = 0) -> subprocess.Popen[bytes]:
    command = [sys.executable, str(SCRIPT), str(run), "2", str(PACE_S), str(EPISODES), str(hits)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL)


@dataclass
class Assassin:
    """Kills runners and workers at random moments, and no worker of an episode that has lost one before."""

    run: Path
    rng: random.Random
    runner: subprocess.Popen[bytes]
    runners: int = 0
    workers: int = 0
    seen_starts: int = 0

    def strike(self) -> None:
        """One kill -9, somewhere between the start of a process and the end of an episode."""
        if self.rng.random() < 0.75:  # most hits fall into episodes, some into the start of a process
            wait_until(lambda: starts(self.run) > self.seen_starts, 120.0)
        time.sleep(self.rng.uniform(0.0, 0.6))
        assert self.runner.poll() is None
        if self.rng.random() < 0.2:
            self.runner.kill()
            self.runner.wait()
            self.runners += 1
        else:
            victim = self._victim()
            os.kill(victim, signal.SIGKILL)
            self.workers += 1
            wait_until(lambda: victim not in workers_of(self.runner.pid), 60.0)  # else the runner may not have noted it yet
        self.seen_starts = starts(self.run)
        with (self.run / "hits").open("ab") as file:
            file.write(b"x")
        if self.runner.poll() is not None:
            self.runner = begin(self.run, KILLS)

    def _victim(self) -> int:
        """A worker, stopped, whose death would be the first of its episode."""
        deadline = time.monotonic() + 120.0
        while True:
            assert time.monotonic() < deadline
            for worker in self.rng.sample(workers := workers_of(self.runner.pid), len(workers)):
                os.kill(worker, signal.SIGSTOP)  # what it is at stays so
                if self._may_be_hit(worker):
                    return worker
                os.kill(worker, signal.SIGCONT)
            time.sleep(0.05)

    def _may_be_hit(self, worker: int) -> bool:
        told = self.run / "workers" / str(worker)
        if not told.exists():
            return True  # it is starting, so it has no episode yet
        name = told.read_text()
        return bool(name) and not Journal.read(episode_directory(self.run, name)).deaths  # without a name, one may be on its way


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_kill_9_at_thirty_moments_loses_and_repeats_nothing(tmp_path: Path) -> None:
    """The world waits for the hits, so that each falls into the run and none behind its end, however fast the machine is."""
    rough, calm = tmp_path / "rough", tmp_path / "calm"
    rough.mkdir()
    assassin = Assassin(rough, random.Random(7), begin(rough, KILLS))
    for _ in range(KILLS):
        assassin.strike()
    assert assassin.runner.wait(timeout=600) == 0
    assert min(assassin.runners, assassin.workers) >= 3
    assert begin(calm).wait(timeout=600) == 0
    results = plain_results(rough)
    assert len(results) == EPISODES
    assert results == plain_results(calm)
    assert (rough / "summary.json").read_bytes() == (calm / "summary.json").read_bytes()
    journals = {folder: Journal.read(folder) for folder in (rough / "episodes").iterdir()}
    assert max(journal.deaths for journal in journals.values()) == 1
    assert all(result_of(folder).restarts == journal.starts - 1 for folder, journal in journals.items())
