"""Dataset files: read whole, refused with the place when damaged (file, record, field).

Datasets are JSON, plain or gzipped. Bare ``NaN`` is accepted by the reader, because RxR-CE's word timings hold it; a field that
matters is validated by its model and refuses it.
"""

from __future__ import annotations

import gzip
import hashlib
import json
import zlib
from collections import Counter
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from spacevln.core import UsageError

FAR_M = 100_000.0
"""Coordinates beyond this are no building's."""

SHOWN_CHARS = 60


class DatasetError(UsageError):
    """A dataset file is missing, damaged, or of another format.

    Args:
        path: of the file.
        place: record and field, e.g. ``"episode 17 (id 18), field start_position.1"``; ``""`` for the whole file.
        problem: what is wrong there and what is needed.
    """

    def __init__(self, path: Path, place: str, problem: str) -> None:
        self.path = path
        self.place = place
        where = f", {place}" if place else ""
        super().__init__(f"{str(path)!r}{where}: {problem}; get the file again, or mend the record.")


class FileRecord(BaseModel):
    """Base of what is read from a dataset file: unknown keys are kept aside and listed, not refused."""

    model_config = ConfigDict(extra="allow", frozen=True)

    @property
    def unknown_keys(self) -> tuple[str, ...]:
        """Keys that the model does not name."""
        return tuple(self.__pydantic_extra__ or ())


def _unit(quaternion: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    norm = sum(part * part for part in quaternion) ** 0.5
    if abs(norm - 1.0) > 1e-3:
        raise ValueError(f"a rotation [x, y, z, w] has length 1, this one {norm:.3g}")
    return quaternion


def _upright(quaternion: tuple[float, float, float, float]) -> tuple[float, float, float, float]:
    if max(abs(quaternion[0]), abs(quaternion[2])) > 1e-3:
        raise ValueError("a start rotation turns about the vertical only, so x and z are 0")
    return quaternion


def _written(value: object) -> object:
    return str(value) if isinstance(value, int) and not isinstance(value, bool) else value


def _text(value: str) -> str:
    words = " ".join(value.split())
    if not words:
        raise ValueError("the text is empty")
    return words


Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Coordinate = Annotated[float, Field(strict=True, allow_inf_nan=False, ge=-FAR_M, le=FAR_M)]
Position = tuple[Coordinate, Coordinate, Coordinate]
Quaternion = Annotated[tuple[Number, Number, Number, Number], AfterValidator(_unit)]
UprightQuaternion = Annotated[Quaternion, AfterValidator(_upright)]
Text = Annotated[str, AfterValidator(_text)]
Identifier = Annotated[str, BeforeValidator(_written), AfterValidator(_text)]
"""Some files number their episodes, others name them; here an id is text."""
Length = Annotated[float, Field(strict=True, ge=0)]
"""A distance; infinite where there is no way, never NaN."""


def read_json(path: Path) -> Any:
    """The content of a ``.json`` or ``.json.gz`` file.

    Raises:
        DatasetError: it is missing, truncated, not gzip, not UTF-8 or not JSON.
    """
    try:
        data = path.read_bytes()
        if path.suffix == ".gz":
            data = gzip.decompress(data)
        return json.loads(data)
    except (EOFError, gzip.BadGzipFile, zlib.error) as error:
        raise DatasetError(path, "", f"it is damaged or cut short ({error})") from error
    except OSError as error:
        raise DatasetError(path, "", f"it cannot be read ({error.strerror})") from error
    except UnicodeDecodeError as error:
        raise DatasetError(path, f"byte {error.start}", "it is no UTF-8 text") from error
    except json.JSONDecodeError as error:
        raise DatasetError(path, f"line {error.lineno} column {error.colno}", f"it is no JSON ({error.msg})") from error
    except RecursionError as error:
        raise DatasetError(path, "", "it nests deeper than any dataset") from error


def sha256(path: Path) -> str:
    """SHA-256 of a file, in hex."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


R = TypeVar("R", bound=FileRecord)


def read_record(path: Path, place: str, kind: type[R], data: object) -> R:
    """One record of a file.

    Args:
        path, place: where it stands, for the message.
        kind: its model.
        data: the record as JSON gave it.

    Raises:
        DatasetError: a field is missing or wrong; the message names it.
    """
    if not isinstance(data, Mapping):
        raise DatasetError(path, place, f"an object is needed, this is {shown(data)}")
    try:
        return kind.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"] if part not in ("int", "str"))
        found = "nothing" if first["type"] == "missing" else shown(first["input"])
        message = first["msg"].removeprefix("Value error, ")
        raise DatasetError(path, f"{place}, field {field}" if place else f"field {field}", f"{message}, got {found}") from error


def list_of(path: Path, content: object, key: str, *, empty_ok: bool = False) -> list[Any]:
    """The list under a top-level key.

    Raises:
        DatasetError: the file is no object, or the key is missing, no list, or empty.
    """
    if not isinstance(content, Mapping):
        raise DatasetError(path, "", f"an object with {key!r} is needed, this is {shown(content)}")
    if key not in content:
        raise DatasetError(path, f"field {key}", f"it is missing, the file has {', '.join(map(str, content)) or 'nothing'}")
    records = content[key]
    if not isinstance(records, list):
        raise DatasetError(path, f"field {key}", f"a list is needed, this is {shown(records)}")
    if not records and not empty_ok:
        raise DatasetError(path, f"field {key}", "the list is empty")
    return records


def record_place(kind: str, index: int, data: object) -> str:
    """``"episode 17 (id 18)"``."""
    name = data.get("episode_id") if isinstance(data, Mapping) else None
    return f"{kind} {index}" + (f" (id {name})" if isinstance(name, int | str) and str(name) else "")


def refuse_duplicates(path: Path, ids: Iterable[str], what: str = "episode_id") -> None:
    """Refuse a file in which two records share an id.

    Raises:
        DatasetError: with the first such id and its place.
    """
    seen: dict[str, int] = {}
    for index, name in enumerate(ids):
        if name in seen:
            raise DatasetError(path, f"episode {index} (id {name}), field {what}", f"episode {seen[name]} has the same id")
        seen[name] = index


def unknown_note(records: Iterable[tuple[str, FileRecord]]) -> tuple[str, ...]:
    """One line that lists the keys which no model names, or none.

    Args:
        records: each with the path of its fields, e.g. ``"episodes[].info"``.
    """
    counts: Counter[str] = Counter()
    for path, record in records:
        counts.update(f"{path}.{key}" for key in record.unknown_keys)
    listed = ", ".join(f"{name} ({count}x)" for name, count in sorted(counts.items()))
    return (f"unknown keys, ignored: {listed}",) if listed else ()


def shown(value: object) -> str:
    """A value in a message, cut to a readable length."""
    text = repr(value)
    return text if len(text) <= SHOWN_CHARS else text[: SHOWN_CHARS - 3] + "..."
