"""Where the file of a split lies."""

from __future__ import annotations

from pathlib import Path

from spacevln.core import PrerequisiteError


def locate_split(path: Path, split: str, stem: str | None = None, suffixes: tuple[str, ...] = (".json.gz", ".json")) -> Path:
    """The file of a split.

    Args:
        path: the file itself, its folder, or the folder of all splits.
        split: name of the folder of a split.
        stem: of the file; the split's name by default.
        suffixes: accepted endings, best first.

    Raises:
        PrerequisiteError: there is no such file; the message lists where it was looked for.
    """
    if path.is_file():
        return path
    name = stem or split
    tried = [folder / f"{name}{suffix}" for folder in (path / split, path) for suffix in suffixes]
    found = next((candidate for candidate in tried if candidate.is_file()), None)
    if found is None:
        raise PrerequisiteError(
            f"Split {split!r} is not at {str(path)!r}: looked for {' and '.join(str(each) for each in tried)}; "
            "give the folder of the dataset, or the file (docs/benchmarks.md says where to get it)."
        )
    return found
