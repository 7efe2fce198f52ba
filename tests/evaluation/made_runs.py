"""Runs that never were: results, run files and whole directories of records, for tests of what reads them."""

from __future__ import annotations

from pathlib import Path

from spacevln.assembly import Configuration
from spacevln.core import EpisodeStatus, StopReason
from spacevln.evaluation.resources import ResourcesFile
from spacevln.evaluation.runs import Run
from spacevln.recording import Metrics, ResultFile, RunFile, Truth, episode_directory, write_file


def made_result(name: str, success: float = 1.0, **changes: object) -> ResultFile:
    distance = 1.0 if success else 8.0
    metrics = Metrics(
        SR=success,
        SPL=0.8 * success,
        OSR=success,
        NE=distance,
        nDTW=0.5,
        path_length=10.0,
        steps=100,
        lookaround_steps=36,
        align_steps=2,
        collisions=3,
        stages=4,
        rejections=1,
        fallbacks=0,
    )
    result = ResultFile(
        episode_id=name,
        scene="s",
        task_kind="vln",
        task_text="Go.",
        status=EpisodeStatus.STOPPED,
        stop_reason=StopReason.GATE,
        forced_stop=False,
        detail="",
        metrics=metrics,
        truth=Truth(goals=(), shortest_path=(), geodesic_m=9.0, final_distance_m=distance),
        timing_s=120.0,
    )
    return result.model_copy(update=changes)


def made_run(
    label: str, results: list[ResultFile], suite: str = "r2r-ce val_unseen", configuration: Configuration | None = None
) -> Run:
    file = RunFile(
        version="1",
        suite=suite,
        created="2026-01-01",
        command=("spacevln", "bench"),
        configuration=(configuration or Configuration()).model_dump(mode="json"),
        configuration_hash="c0ffee",
        packages={"numpy": "2"},
        python="3.12",
        platform="x",
        git_revision="abc",
        dataset={"val_unseen.json.gz": "f00d"},
    )
    used = ResourcesFile(
        planner_calls=2,
        planner_s=5.0,
        executor_calls=10,
        executor_s=20.0,
        cpu_s=1.0,
        peak_memory_mb=2048.0,
        peak_gpu_mb=None,
        processor="P",
        gpu=None,
    )
    by_id = {result.episode_id: result for result in results}
    return Run(label, Path(label), file, by_id, dict.fromkeys(by_id, used))


THREE = [made_result("1"), made_result("2"), made_result("3", 0.0)]


def write_run(folder: Path, results: list[ResultFile], configuration: Configuration | None = None) -> Path:
    """The directory of a run of ``houses-vln``."""
    folder.mkdir(parents=True)
    write_file(folder / "run.json", made_run(folder.name, [], "houses-vln seeds 0:4", configuration).file)
    for result in results:
        place = episode_directory(folder, result.episode_id)
        place.mkdir(parents=True)
        write_file(place / "result.json", result)
    return folder


def plain_results(run: Path) -> dict[str, str]:
    """Result files as text, without what may differ: times and restarts."""
    kept = {}
    for path in run.glob("episodes/*/result.json"):
        lines = path.read_text().splitlines()
        kept[path.parent.name] = "\n".join(line for line in lines if '"timing_s"' not in line and '"restarts"' not in line)
    return kept


def workers_of(pid: int) -> list[int]:
    """Worker processes of a runner."""
    try:
        found = [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
        return [child for child in found if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()]
    except (FileNotFoundError, ProcessLookupError):
        return []
