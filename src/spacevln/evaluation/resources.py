"""What an attempt took: seconds, processor time, peak memory, the hardware's name (``resources.json``).

Kept apart from ``result.json``, which is the same wherever and however often an episode runs.
"""

from __future__ import annotations

import functools
import platform
import resource
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from spacevln.recording.record import Record
from spacevln.recording.schema import DecisionMadeLine, SubtaskIssuedLine

NAME = "resources.json"


class ResourcesFile(Record):
    """What one attempt took.

    Args:
        planner_calls, executor_calls: subtasks and decisions that were accepted.
        planner_s, executor_s: seconds until they were, summed; re-asking included.
        cpu_s: processor time of the process.
        peak_memory_mb: of the process since it began, resident.
        peak_gpu_mb: of the process on its GPU since it began; None where no GPU is used.
        processor, gpu: names.
    """

    planner_calls: int
    planner_s: float
    executor_calls: int
    executor_s: float
    cpu_s: float
    peak_memory_mb: float
    peak_gpu_mb: float | None
    processor: str
    gpu: str | None


def measure(lines: Iterable[object], cpu_begin_s: float) -> ResourcesFile:
    """The resources of the attempt that just ended in this process.

    Args:
        lines: its events.
        cpu_begin_s: ``time.process_time()`` when it began.
    """
    planner, executor = [], []
    for line in lines:
        match line:
            case SubtaskIssuedLine(seconds=seconds):
                planner.append(seconds)
            case DecisionMadeLine(seconds=seconds):
                executor.append(seconds)
            case _:
                pass
    gpu, peak_gpu_mb = _gpu()
    return ResourcesFile(
        planner_calls=len(planner),
        planner_s=round(sum(planner), 4),
        executor_calls=len(executor),
        executor_s=round(sum(executor), 4),
        cpu_s=round(time.process_time() - cpu_begin_s, 3),
        peak_memory_mb=round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / _RSS_PER_MB, 1),
        peak_gpu_mb=peak_gpu_mb,
        processor=processor_name(),
        gpu=gpu,
    )


_RSS_PER_MB = 1024 * 1024 if sys.platform == "darwin" else 1024  # bytes there, kilobytes on Linux


@functools.cache
def processor_name() -> str:
    """Name of the processor."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8", errors="replace").splitlines() if info.exists() else []
    named = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(named, "") or platform.processor() or platform.machine()


def _gpu() -> tuple[str | None, float | None]:
    """The GPU that torch uses in this process, if some detector brought torch along."""
    torch: Any = sys.modules.get("torch")
    if torch is None or not torch.cuda.is_available():
        return None, None
    return str(torch.cuda.get_device_name()), round(torch.cuda.max_memory_allocated() / 2**20, 1)
