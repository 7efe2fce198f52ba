"""The run record: one directory per run, written while it happens, read by everything that shows something (DESIGN 5.7)."""

from spacevln.recording.files import episode_directory, read_events, read_file, read_result, write_file
from spacevln.recording.schema import (
    FORMAT,
    Diagnosis,
    EventLine,
    Metrics,
    ResultFile,
    RunFile,
    SummaryFile,
    Truth,
)
from spacevln.recording.usage import CallUsage, total, usage_of
from spacevln.recording.writer import EpisodeRecorder, RecordLevel, task_fields

__all__ = [
    "FORMAT",
    "CallUsage",
    "Diagnosis",
    "EpisodeRecorder",
    "EventLine",
    "Metrics",
    "RecordLevel",
    "ResultFile",
    "RunFile",
    "SummaryFile",
    "Truth",
    "episode_directory",
    "read_events",
    "read_file",
    "read_result",
    "task_fields",
    "total",
    "usage_of",
    "write_file",
]
