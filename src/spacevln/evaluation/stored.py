"""The fixed suites of the houses that come with the program: what ``bench houses-vln --split test`` runs.

:mod:`.suites` made them once; beside each file stands the SHA-256 of its unpacked text.
"""

from __future__ import annotations

import shutil
from importlib.resources import files
from pathlib import Path

from spacevln.core import RecordError

VERSION = "v1"
"""Of the files, told in every run's name: whoever changes a file changes it too."""


def stored_suite(suite: str, split: str) -> Path:
    """The file of a suite's episodes.

    Args:
        suite: ``houses-vln``, in the file format of R2R-CE, or ``houses-objectnav``, in that of HM3D-OVON.
        split: ``test`` (200 episodes in 50 houses) or ``dev`` (50 in 50).
    """
    return Path(str(files("spacevln.evaluation"))) / "data" / f"{suite}_{split}.json.gz"


def copy_suite(suite: str, split: str, folder: Path) -> Path:
    """Copy a suite with all that stands beside it; the copy's file of episodes.

    Raises:
        RecordError: the folder cannot be written.
    """
    source = stored_suite(suite, split)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for file in source.parent.glob(f"{suite}_{split}*"):
            shutil.copyfile(file, folder / file.name)
    except OSError as error:
        raise RecordError(f"Cannot write {str(folder)!r} ({error.strerror}): give a folder that you may write.") from error
    return folder / source.name
