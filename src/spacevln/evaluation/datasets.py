"""Named suites of episodes, loaded lazily: an episode is made when it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Literal, overload

from pydantic import BaseModel, ConfigDict

from spacevln.core import PrerequisiteError, UnknownNameError, UsageError
from spacevln.evaluation.episode import Episode

Probe = Literal["none", "swapped", "last-noun"]
SuiteName = Literal["houses-vln", "houses-objectnav"]
SUITES: tuple[SuiteName, ...] = ("houses-vln", "houses-objectnav")
HABITAT_SUITES = ("r2r-ce", "rxr-ce", "hm3d-ovon", "gn-bench")
"""Suites whose names are fixed already and whose loaders come with later steps."""

TEST_SEEDS = (100_000, 100_100)
DEV_SEEDS = (0, 50)


class EpisodeSequence(Sequence[Episode]):
    """Episodes of a suite: their ids at once, each episode when it is indexed.

    Args:
        ids: unique, in order.
        make: builds the episode of an id.
    """

    def __init__(self, ids: Sequence[str], make: Callable[[str], Episode]) -> None:
        self.ids = tuple(ids)
        self._make = make

    def __len__(self) -> int:
        return len(self.ids)

    @overload
    def __getitem__(self, index: int) -> Episode: ...
    @overload
    def __getitem__(self, index: slice) -> EpisodeSequence: ...
    def __getitem__(self, index: int | slice) -> Episode | EpisodeSequence:
        if isinstance(index, slice):
            return EpisodeSequence(self.ids[index], self._make)
        return self._make(self.ids[index])

    def __iter__(self) -> Iterator[Episode]:
        return map(self._make, self.ids)

    def by_id(self, episode_id: str) -> Episode:
        """The episode of an id.

        Raises:
            UnknownNameError: there is none.
        """
        if episode_id not in self.ids:
            raise UnknownNameError("episode", episode_id, self.ids)
        return self._make(episode_id)


class Selection(BaseModel):
    """Which episodes of which suite.

    Args:
        suite: its name.
        split: ``test`` (phrases never used for tuning) or ``dev``.
        seeds: one fresh episode of each house seed A..B-1 instead of the split's own seeds.
        episodes: only the first so many.
        probe: replaces the instruction, to see whether it matters (:mod:`.probes`).
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    suite: str
    split: Literal["test", "dev"] = "test"
    seeds: tuple[int, int] | None = None
    episodes: int | None = None
    probe: Probe = "none"

    @property
    def name(self) -> str:
        """One line that identifies the selection in ``run.json``; how many of its episodes run does not matter."""
        seeds = self.seeds or (TEST_SEEDS if self.split == "test" else DEV_SEEDS)
        return f"{self.suite} seeds {seeds[0]}:{seeds[1]}" + (f" probe {self.probe}" if self.probe != "none" else "")

    def load(self) -> EpisodeSequence:
        """The episodes.

        Raises:
            UsageError: the suite is unknown or the selection is empty.
        """
        if self.suite in HABITAT_SUITES:
            raise PrerequisiteError(
                f"Suite {self.suite!r} needs the Habitat bridge, which this version does not have yet: use {' or '.join(SUITES)}."
            )
        if self.suite not in SUITES:
            raise UnknownNameError("suite", self.suite, (*SUITES, *HABITAT_SUITES))
        first, last = self.seeds or (TEST_SEEDS if self.split == "test" else DEV_SEEDS)
        if not 0 <= first < last:
            raise UsageError(f"Seeds {first}:{last} name no house: give A:B with 0 <= A < B.")
        if self.episodes is not None and self.episodes < 1:
            raise UsageError(f"{self.episodes} episodes were asked for: give at least 1.")
        from spacevln.evaluation.houses import house_episode, house_episode_id
        from spacevln.evaluation.probes import probe

        ids = [house_episode_id(self.suite, seed) for seed in range(first, last)][: self.episodes]
        return EpisodeSequence(ids, lambda episode_id: probe(house_episode(episode_id), self.probe))


def load(name: str, path: Path | None = None, *, split: Literal["test", "dev"] = "test", **filters: Any) -> EpisodeSequence:
    """The episodes of a suite.

    Args:
        name: ``"houses-vln"`` or ``"houses-objectnav"``.
        path: where the data lies; the embedded suites need none.
        split: ``"test"`` or ``"dev"``.
        filters: fields of :class:`Selection`.

    Raises:
        UsageError: the suite or a filter is unknown, or the selection is empty.
    """
    if path is not None:
        raise UsageError(
            f"Suite {name!r} is made by the program and reads no data, but path={str(path)!r} was given: leave it out."
        )
    unknown = sorted(set(filters) - set(Selection.model_fields))
    if unknown:
        raise UnknownNameError("filter", unknown[0], sorted(set(Selection.model_fields) - {"suite", "split"}))
    return Selection(suite=name, split=split, **filters).load()
