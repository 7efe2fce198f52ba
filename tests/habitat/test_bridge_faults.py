"""Whatever happens to the simulator ends in one typed error, and no process stays behind."""

from __future__ import annotations

import errno
import gc
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bridge_world import DATA, HERE, episode, scenes, small, use_standin
from spacevln_bridge import channel, messages

from spacevln.assembly import Configuration
from spacevln.core import EnvironmentFailure, EpisodeSpec, InstructionTask, MoveForward, PrerequisiteError, TurnLeft
from spacevln.environments.bridge import worker
from spacevln.environments.habitat.environment import HabitatEnvironment
from spacevln.environments.habitat.setup import HabitatSetup
from spacevln.evaluation import datasets
from spacevln.evaluation.attempt import Session
from spacevln.recording import RecordLevel


@pytest.fixture
def world(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> HabitatEnvironment:
    use_standin(monkeypatch, "0.3.4")
    return small(tmp_path, width_px=16, height_px=12, answer_s=20.0)


def descriptors() -> int:
    """Open ones of this process, without those of images that nobody can see any more."""
    gc.collect()
    return len(list(Path("/proc/self/fd").iterdir()))


def gone(pid: int) -> bool:
    for _ in range(100):
        try:
            os.kill(pid, 0)
        except ProcessLookupError:
            return True
        if Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] == "Z":
            return True
        time.sleep(0.05)
    return False


def test_a_killed_worker_is_one_error_and_the_next_episode_has_another(world: HabitatEnvironment) -> None:
    world.reset(episode())
    pid = world.simulator.worker.pid
    os.kill(pid, signal.SIGKILL)
    with pytest.raises(EnvironmentFailure, match=r"was lost"):
        world.execute(MoveForward())
    assert gone(pid)
    with pytest.raises(EnvironmentFailure, match=r"reset"):
        world.execute(MoveForward())
    assert world.reset(episode()).pose.x_m == pytest.approx(0, abs=1e-6)
    assert world.simulator.starts == 2
    world.close()


def test_a_stopped_worker_is_noticed_in_time(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    world = small(tmp_path, width_px=16, height_px=12)
    world.reset(episode())
    pid = world.simulator.worker.pid
    monkeypatch.setattr(world.simulator.worker, "_answer_s", 0.5)
    os.kill(pid, signal.SIGSTOP)
    begin = time.monotonic()
    with pytest.raises(EnvironmentFailure, match=r"did not answer Act within 0\.5 s"):
        world.execute(TurnLeft())
    assert time.monotonic() - begin < 5
    assert gone(pid)


def begin_and_step(world: HabitatEnvironment) -> None:
    world.reset(episode())
    world.execute(MoveForward())


@pytest.mark.slow
@pytest.mark.parametrize("moment", ["import", "open", "look", "step"])
@pytest.mark.parametrize(
    ("what", "told"),
    [
        ("kill", r"lost in \w+ \(.*SIGKILL"),
        ("stop", r"did not answer \w+ within 3 s"),
        ("garbage", r"lost in \w+ \(.*no message"),
    ],
)
def test_whatever_happens_whenever_is_one_error_and_no_process_stays(
    what: str, told: str, moment: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    use_standin(monkeypatch, "0.3.4", fault=f"{what}-{moment}")
    stops = what == "stop"
    monkeypatch.setattr(worker, "START_S", 3.0 if stops and moment == "import" else 30.0)
    started: list[int] = []
    start = worker.Worker._start
    monkeypatch.setattr(worker.Worker, "_start", lambda self, *ends: (found := start(self, *ends), started.append(found.pid))[0])
    before = descriptors()
    world = small(tmp_path, width_px=16, height_px=12, answer_s=3.0 if stops else 30.0, open_s=3.0 if stops else 30.0)
    with pytest.raises(EnvironmentFailure, match=told):
        begin_and_step(world)
    assert len(started) == 1
    assert gone(started[0])
    world.close()
    assert descriptors() == before


def test_a_scene_that_never_opens_is_given_up(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4", fault="hang")
    world = small(tmp_path, open_s=1.0)
    with pytest.raises(EnvironmentFailure, match=r"did not answer Open within 1 s"):
        world.reset(episode())


def test_a_native_death_tells_the_exit_code(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    world = small(tmp_path, gpu_device=0)
    with pytest.raises(EnvironmentFailure, match=r"exit code 1.*no GPU"):
        world.reset(episode())


@pytest.mark.parametrize(
    "garbage", [b"GET / HTTP/1.1\r\n\r\n", b"SVBR\x00\x00\x00\x02\xc1\xc1", b"SVBR\xff\xff\xff\xff", b"SVBR\x00\x00\x00\x01\x90"]
)
def test_garbage_is_one_error_at_either_end(garbage: bytes) -> None:
    ours, theirs = socket.socketpair()
    ours.sendall(garbage)
    with pytest.raises(channel.ChannelGarbled):
        channel.Channel(theirs).receive(1.0)
    ours.close()
    theirs.close()


def test_a_client_that_talks_nonsense_does_not_leave_the_worker_behind(world: HabitatEnvironment) -> None:
    world.reset(episode())
    worker = world.simulator.worker
    worker._channel._socket.sendall(b"nonsense that is longer than a header")
    with pytest.raises(EnvironmentFailure, match=r"lost in Act"):
        world.execute(TurnLeft())
    assert gone(worker.pid)


def test_another_version_is_refused_with_both_numbers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    monkeypatch.setattr(messages, "PROTOCOL", messages.PROTOCOL + 1)
    with pytest.raises(EnvironmentFailure, match=r"protocol 2, the client 3"):
        small(tmp_path).reset(episode())


def test_full_shared_memory_is_noticed_before_anything_starts(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(worker.os, "posix_fallocate", full)
    before = descriptors()
    with pytest.raises(EnvironmentFailure, match=r"No space left on device"):
        small(tmp_path).reset(episode())
    assert descriptors() == before


def test_missing_things_are_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with pytest.raises(PrerequisiteError, match=r"cannot be started"):
        HabitatEnvironment(HabitatSetup(python="/nowhere/python", scenes=str(scenes(tmp_path)))).reset(episode())
    monkeypatch.setenv("PYTHONPATH", "")
    use_standin(monkeypatch, "0.3.4")
    monkeypatch.setenv("PYTHONPATH", os.environ["PYTHONPATH"].replace(str(HERE / "standin"), ""))
    with pytest.raises(PrerequisiteError, match=r"habitat_sim cannot be imported"):
        small(tmp_path).reset(episode())
    use_standin(monkeypatch, "0.3.4")
    with pytest.raises(PrerequisiteError, match=r"Scene .* is missing"):
        small(tmp_path).reset(EpisodeSpec("1", "mp3d/none.glb", episode().start, InstructionTask("go")))


@pytest.mark.slow
def test_a_killed_client_leaves_no_worker(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4")
    script = (
        "import sys, time; sys.path[:0] = sys.argv[1:-1]; from bridge_world import small, episode; from pathlib import Path; "
        "w = small(Path(sys.argv[-1]), width_px=16, height_px=12); w.reset(episode()); "
        "print(w.simulator.worker.pid, flush=True); "
        "time.sleep(100)"
    )
    paths = [str(HERE), *(entry for entry in sys.path if entry)]
    client = subprocess.Popen([sys.executable, "-c", script, *paths, str(tmp_path)], stdout=subprocess.PIPE, text=True)
    assert client.stdout is not None
    pid = int(client.stdout.readline())
    client.kill()
    client.wait()
    client.stdout.close()
    assert gone(pid)


@pytest.mark.slow
def test_closing_leaves_neither_process_nor_descriptor(world: HabitatEnvironment) -> None:
    before = descriptors()
    for _ in range(2):
        world.reset(episode())
        pid = world.simulator.worker.pid
        world.close()
        assert gone(pid)
    assert descriptors() <= before


@pytest.mark.slow
def test_a_lost_worker_costs_one_episode_each_time_and_is_replaced(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    use_standin(monkeypatch, "0.3.4", fault="die")
    world = small(tmp_path, width_px=16, height_px=12)
    with Session(Configuration(driver="forward"), world) as session:
        for episode_of_file in datasets.load("r2r-ce", DATA)[:2]:
            folder = tmp_path / episode_of_file.episode_id
            result = session.attempt(episode_of_file, folder, level=RecordLevel.LIGHT)
            assert result.status == "environment_failure"
            assert "lost in Act" in result.detail
            assert not (folder / "crash.txt").exists()
        assert world.simulator.starts > 1
