"""Which episodes of a sequence: by scene, id, slice, seeded sample, and whether the scene is on this machine."""

from __future__ import annotations

import difflib
import hashlib
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, ValidationError

from spacevln.core import UnknownNameError, UsageError
from spacevln.evaluation.datasets.scenes import short_names
from spacevln.evaluation.datasets.sequence import EpisodeSequence

NAMED = 20
"""Longest list of names that is shown whole."""


def _several(value: object) -> object:
    return (value,) if isinstance(value, str | int) else value


def _slice(value: object) -> object:
    """``"A:B"`` as numbers."""
    if not isinstance(value, str):
        return value
    first, colon, last = value.partition(":")
    if not colon or not all(part.isdigit() for part in (first, last) if part):
        raise ValueError(f"{value!r} is no slice: give A:B with 0 <= A < B, e.g. 0:100")
    return (int(first) if first else 0, int(last) if last else None)


Names = Annotated[tuple[str, ...], BeforeValidator(_several), Field(min_length=1)]


class Filters(BaseModel):
    """Conditions, applied in the order of this list.

    Args:
        language: RxR-CE: ``en-US``, ``en-IN``, ``hi-IN``, ``te-IN``; one or several.
        role: RxR-CE: ``guide`` (default), ``follower``; one or several.
        available_in: folder of all scenes; episodes whose scene is not there are left out.
        scene: names of scenes, whole (``mp3d/X/X.glb``) or short (``X``).
        ids: episode ids, in this order.
        slice: ``"A:B"``, the A-th up to before the B-th.
        sample: so many, drawn without replacement, in the order of the file.
        seed: of the sample.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    language: Annotated[tuple[Literal["en-US", "en-IN", "hi-IN", "te-IN"], ...], BeforeValidator(_several)] | None = None
    role: Annotated[tuple[Literal["guide", "follower"], ...], BeforeValidator(_several)] | None = None
    available_in: Path | None = None
    scene: Names | None = None
    ids: Names | None = None
    slice: Annotated[tuple[Annotated[int, Field(ge=0)], int | None], BeforeValidator(_slice)] | None = None
    sample: Annotated[int, Field(ge=1)] | None = None
    seed: Annotated[int, Field(ge=0)] = 0

    @classmethod
    def of(cls, values: dict[str, Any]) -> Filters:
        """Filters from what a person gave.

        Raises:
            UsageError: a filter is unknown or its value is not allowed.
        """
        unknown = sorted(set(values) - set(cls.model_fields))
        if unknown:
            raise UnknownNameError("filter", unknown[0], cls.model_fields)
        try:
            return cls.model_validate(values)
        except ValidationError as error:
            first = error.errors()[0]
            name = str(first["loc"][0])
            message = first["msg"].removeprefix("Value error, ")
            raise UsageError(f"Filter {name}={values[name]!r} is not allowed: {message}.") from error

    @property
    def words(self) -> str:
        """The filters that are set, in one line; long lists by their number and digest."""
        set_ones = self.model_dump(mode="json", exclude_defaults=True)
        return " ".join(f"{name}={_plain(value)}" for name, value in set_ones.items())

    def apply(self, episodes: EpisodeSequence) -> EpisodeSequence:
        """The episodes that meet every condition but ``language`` and ``role``, which loaders apply.

        Raises:
            UsageError: a scene or an id is not there, or nothing is left.
        """
        if self.available_in is not None:
            episodes = _available(episodes, self.available_in)
        if self.scene is not None:
            episodes = _in_scenes(episodes, self.scene)
        if self.ids is not None:
            index = {name: position for position, name in enumerate(episodes.ids)}
            _refuse_unknown("episode", self.ids, index)
            episodes = episodes.picked([index[name] for name in self.ids])
        if self.slice is not None:
            episodes = episodes[self.slice[0] : self.slice[1]]
        if self.sample is not None:
            if self.sample > len(episodes):
                raise UsageError(
                    f"A sample of {self.sample} was asked for of {len(episodes)} episodes: give at most {len(episodes)}."
                )
            drawn = np.random.default_rng(self.seed).choice(len(episodes), self.sample, replace=False)
            episodes = episodes.picked(sorted(map(int, drawn)))
        if not len(episodes):
            raise UsageError(f"No episode is left by {self.words}: loosen a filter.")
        return episodes


def _available(episodes: EpisodeSequence, scenes_dir: Path) -> EpisodeSequence:
    present = {scene for scene in set(episodes.scenes) if (scenes_dir / scene).exists()}
    kept = [index for index, scene in enumerate(episodes.scenes) if scene in present]
    missing = len(set(episodes.scenes)) - len(present)
    note = f"{missing} scenes are not in {scenes_dir}: {len(episodes) - len(kept)} episodes left out"
    return episodes.picked(kept, [note] if missing else [])


def _in_scenes(episodes: EpisodeSequence, wanted: Iterable[str]) -> EpisodeSequence:
    names = {scene: short_names(scene) for scene in dict.fromkeys(episodes.scenes)}
    _refuse_unknown("scene", wanted, {name for group in names.values() for name in group})
    chosen = {scene for scene, group in names.items() if group & set(wanted)}
    return episodes.picked([index for index, scene in enumerate(episodes.scenes) if scene in chosen])


def _refuse_unknown(kind: str, wanted: Iterable[str], known: Iterable[str]) -> None:
    known = sorted(known)
    present = set(known)
    for name in wanted:
        if name in present:
            continue
        if len(known) <= NAMED:
            raise UnknownNameError(kind, name, known)
        near = difflib.get_close_matches(name, known, n=1)
        raise UsageError(
            f"Unknown {kind} {name!r}: {len(known)} are known, e.g. {known[0]!r}."
            + (f" Did you mean {near[0]!r}?" if near else "")
        )


def _plain(value: object) -> str:
    if not isinstance(value, list):
        return str(value)
    listed = ",".join(map(str, value))
    return listed if len(value) <= NAMED else f"{len(value)} of sha256 {hashlib.sha256(listed.encode()).hexdigest()[:12]}"
