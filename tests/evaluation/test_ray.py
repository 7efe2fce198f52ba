"""The runner on a Ray cluster of several processes: the same results, though a worker is killed and a node dies."""

from __future__ import annotations

import importlib.util
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import scripted_bench
from made_runs import plain_results

from spacevln.assembly import Configuration
from spacevln.core import PrerequisiteError, UsageError
from spacevln.evaluation.datasets import Selection
from spacevln.evaluation.journal import NAME, Journal
from spacevln.evaluation.ray_cluster import RayCluster
from spacevln.evaluation.runner import Job, bench
from spacevln.recording import RecordLevel

pytestmark = [
    pytest.mark.slow,
    pytest.mark.timeout(600),
    pytest.mark.enable_socket,
    pytest.mark.filterwarnings("ignore"),  # Ray's own
    pytest.mark.skipif(importlib.util.find_spec("ray") is None, reason="needs `pip install 'spacevln[ray]'`"),
]


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    """A head without a CPU and three nodes of one CPU each, one to spare, all processes of this machine."""
    patch = pytest.MonkeyPatch()
    patch.setenv("RAY_AUTH_MODE", "disabled")  # else it leaves a token in the home directory
    patch.setenv("PYTHONPATH", str(Path(scripted_bench.__file__).parent), prepend=os.pathsep)  # its nodes know the tests' world
    from ray.cluster_utils import Cluster

    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    for _ in range(3):
        made.add_node(num_cpus=1)
    yield made
    made.shutdown()
    patch.undo()


def wait_for(happened: Callable[[], Any], seconds: float = 120.0) -> Any:
    deadline = time.monotonic() + seconds
    while not (found := happened()):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    return found


def attempting() -> list[int]:
    """Worker processes of this test's cluster that are in an attempt."""
    return [
        int(folder.name)
        for folder in Path("/proc").glob("[0-9]*")
        if b"ray::" in read(folder / "cmdline")
        and b".attempt" in read(folder / "cmdline")
        and descends(int(folder.name), os.getpid())
    ]


def descends(pid: int, ancestor: int) -> bool:
    while pid > 1:
        if pid == ancestor:
            return True
        fields = read(Path(f"/proc/{pid}/stat")).rpartition(b")")[2].split()
        pid = int(fields[1]) if fields else 0
    return False


def raylet_of(node: Any) -> int:
    """The process of a node, above those of its workers."""
    pid: int = node.all_processes["raylet"][0].process.pid
    return pid


def read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:  # the process has ended
        return b""


def results(run: Path) -> int:
    return len(list(run.glob("episodes/*/result.json")))


class Hits(threading.Thread):
    """Kills a worker in an attempt, and when that episode has its result, a node with a worker in another attempt."""

    def __init__(self, run_directory: Path, cluster: Any) -> None:
        super().__init__(daemon=True)
        self.done: list[str] = []
        self._directory, self._cluster = run_directory, cluster

    def run(self) -> None:
        wait_for(lambda: results(self._directory))
        os.kill(wait_for(attempting)[0], signal.SIGKILL)
        hit = wait_for(self._lost)[0]
        self.done.append("worker")
        wait_for(lambda: (hit / "result.json").exists())
        wait_for(lambda: len(attempting()) == 2)
        self._cluster.remove_node(wait_for(self._node_at_work), allow_graceful=False)
        self.done.append("node")

    def _node_at_work(self) -> Any:
        victim = attempting()[:1]
        return next((node for node in self._cluster.worker_nodes for pid in victim if descends(pid, raylet_of(node))), None)

    def _lost(self) -> list[Path]:
        folders = [path.parent for path in self._directory.glob(f"episodes/*/{NAME}")]
        return [folder for folder in folders if Journal.read(folder).deaths]


def test_a_killed_worker_and_a_dead_node_change_nothing(tmp_path: Path, cluster: Any) -> None:
    calm, rough = tmp_path / "calm", tmp_path / "rough"
    for folder in (calm, rough):
        folder.mkdir()
    undisturbed = scripted_bench.run(calm, 2)
    hits = Hits(rough, cluster)
    hits.start()
    place = RayCluster(cluster.address, Configuration())
    disturbed = scripted_bench.run(rough, 2, pace_s=0.05, workplace=place)
    hits.join()
    assert hits.done == ["worker", "node"]
    assert disturbed == undisturbed
    assert plain_results(rough) == plain_results(calm)
    assert len(plain_results(rough)) == scripted_bench.COUNT
    journals = [Journal.read(folder) for folder in (rough / "episodes").iterdir()]
    assert sorted(journal.deaths for journal in journals)[-3:] == [0, 1, 1]  # the killed worker's episode and the dead node's


def test_who_dies_twice_or_takes_too_long_fails(tmp_path: Path, cluster: Any) -> None:
    words = ("Go ahead.", "die", "Go ahead.", "sleep")
    place = RayCluster(cluster.address, Configuration())
    summary = scripted_bench.run(tmp_path, 2, count=4, instructions=words, deadline_s=5.0, workplace=place)
    assert summary.statuses == {"environment_failure": 2, "stopped": 2}


def job(directory: Path) -> Job:
    selection = Selection.model_validate({"suite": "houses-objectnav", "seeds": (3, 5)})
    return Job(selection, Configuration(driver="frontier", step_budget=15), directory, RecordLevel.LIGHT)


def test_workers_share_a_detector(tmp_path: Path, cluster: Any) -> None:
    for name, place in (("own", None), ("shared", RayCluster(cluster.address, Configuration(), detectors=1))):
        (tmp_path / name).mkdir()
        (tmp_path / name / "run.json").touch()
        assert bench(job(tmp_path / name), 2, lambda _: None, workplace=place).episodes == 2
    assert plain_results(tmp_path / "shared") == plain_results(tmp_path / "own")


def test_what_concerns_the_whole_run_ends_it_with_its_sentence(tmp_path: Path, cluster: Any) -> None:
    with pytest.raises(UsageError, match="all machines share"):  # no run.json: that is what a node without the directory sees
        bench(job(tmp_path), 2, lambda _: None, workplace=RayCluster(cluster.address, Configuration()))
    with pytest.raises(PrerequisiteError, match="no Ray cluster"):
        bench(job(tmp_path), 2, lambda _: None, workplace=RayCluster("127.0.0.1:1", Configuration()))
