"""RxR-CE in VLN-CE's Habitat format (``RxR_VLNCE_v0``), guides and followers.

Source: https://github.com/jacobkrantz/VLN-CE, "RxR-Habitat". Not the graph-based ``.jsonl.gz`` files of the RxR repository.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from spacevln.core import EpisodeSpec, InstructionTask, UsageError
from spacevln.environments.bridge.frame import pose_from_habitat
from spacevln.evaluation.datasets.files import Identifier, refuse_duplicates, unknown_note
from spacevln.evaluation.datasets.locate import locate_split
from spacevln.evaluation.datasets.r2r_ce import (
    Info,
    Instruction,
    RouteRecord,
    annotations_of,
    path_notes,
    read_episodes,
    read_paths,
)
from spacevln.evaluation.datasets.scenes import scene_name
from spacevln.evaluation.datasets.sequence import EpisodeSequence, Source
from spacevln.evaluation.episode import Episode

SPLITS = ("train", "val_seen", "val_unseen", "test_challenge")
Role = Literal["guide", "follower"]
ROLES: tuple[Role, ...] = ("guide", "follower")
LANGUAGES = ("en-US", "en-IN", "hi-IN", "te-IN")

KNOWN_SHA256 = {"93abddce58e8232867a8738daa8107eb82953693a9d5e70779d1eb00386b222a": "RxR_VLNCE_v0 val_unseen_guide"}


class RxRInstruction(Instruction):
    """The words, their language and who spoke them; word timings (which may hold NaN) are not used."""

    instruction_id: Identifier | None = None
    language: Literal["en-US", "en-IN", "hi-IN", "te-IN"] | None = None
    annotator_id: Identifier | None = None
    edit_distance: float | None = None
    timed_instruction: list[Any] | None = None


class RxRInfo(Info):
    """The role of the annotator."""

    role: Role | None = None
    demonstration_id: Identifier | None = None
    metrics: dict[str, Any] | None = None


class RxRRecord(RouteRecord):
    """An episode of the file; followers have no trajectory of their own."""

    info: RxRInfo | None = None
    instruction: RxRInstruction


def load_rxr_ce(
    path: Path, split: str, roles: Sequence[str] = ("guide",), languages: Sequence[str] | None = None
) -> EpisodeSequence:
    """The episodes of a split.

    Args:
        path: a file, its folder, or the folder of all splits.
        split: one of :data:`SPLITS`.
        roles: whose instructions, of :data:`ROLES`.
        languages: of :data:`LANGUAGES`; None takes all.

    Raises:
        DatasetError: a file is missing or damaged.
        UsageError: a language is asked for of a file whose records name none.
    """
    files = [path] if path.is_file() else [locate_split(path, split, f"{split}_{role}") for role in roles]
    episodes: list[Episode] = []
    notes: list[str] = []
    sources: list[Path] = []
    counts: Counter[tuple[str, str]] = Counter()
    for file in files:
        records = read_episodes(file, RxRRecord, needs_truth=not split.startswith("test"))
        paths, gt_file = read_paths(file)
        sources += [file, *([gt_file] if gt_file else [])]
        counts.update((_role(file, record), record.instruction.language or "unknown") for record in records)
        kept = [record for record in records if _speaks(file, record, languages)]
        notes += [*unknown_note(part for record in records for part in record.records), *path_notes(kept, paths, gt_file)]
        for record in kept:
            spec = EpisodeSpec(
                record.episode_id,
                scene_name(record.scene_id),
                pose_from_habitat(record.start_position, record.start_rotation),
                InstructionTask(record.instruction.instruction_text),
            )
            tags = {"split": split, "role": _role(file, record), "language": record.instruction.language or "unknown"}
            episodes.append(Episode(spec, annotations=annotations_of(record, paths), tags=tags))
    refuse_duplicates(files[-1], (episode.episode_id for episode in episodes))
    listed = ", ".join(f"{role} {language} {count}" for (role, language), count in sorted(counts.items()))
    return EpisodeSequence.of(episodes, notes=[f"in the files: {listed}", *notes], source=Source.of(*sources))


def _role(file: Path, record: RxRRecord) -> str:
    if record.info is not None and record.info.role is not None:
        return record.info.role
    return "follower" if "follower" in file.name else "guide"


def _speaks(file: Path, record: RxRRecord, languages: Sequence[str] | None) -> bool:
    if languages is None:
        return True
    if record.instruction.language is None:
        raise UsageError(
            f"Episode {record.episode_id!r} of {str(file)!r} names no language, so {', '.join(languages)} cannot be picked: "
            "use the original RxR_VLNCE_v0 files, or leave the language out."
        )
    return record.instruction.language in languages
