"""A sequence of episodes: their ids at once, each episode when it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import overload

from spacevln.core import UnknownNameError
from spacevln.evaluation.episode import Episode


@dataclass(frozen=True, slots=True)
class Source:
    """Where episodes come from, for ``run.json`` and the reproduction card.

    Args:
        files: name and SHA-256 of each file that was read.
    """

    files: tuple[tuple[str, str], ...]

    @classmethod
    def of(cls, *paths: Path) -> Source:
        """The source of some files."""
        from spacevln.evaluation.datasets.files import sha256

        return cls(tuple((path.name, sha256(path)) for path in paths))


class EpisodeSequence(Sequence[Episode]):
    """Episodes of a suite.

    Args:
        ids: unique, in order.
        make: builds the episode of an id.
        scenes: name of the building of each; workers get episodes of one building in a row.
        notes: what a person should know about the data: unknown keys, missing truth, a count that differs from the paper's.
        source: the files it was read from; None for what the program makes.
    """

    def __init__(
        self,
        ids: Sequence[str],
        make: Callable[[str], Episode],
        scenes: Sequence[str],
        *,
        notes: Sequence[str] = (),
        source: Source | None = None,
    ) -> None:
        self.ids = tuple(ids)
        self.scenes = tuple(scenes)
        self.notes = tuple(notes)
        self.source = source
        self._make = make
        self._index = {name: index for index, name in enumerate(self.ids)}

    @classmethod
    def of(cls, episodes: Sequence[Episode], *, notes: Sequence[str] = (), source: Source | None = None) -> EpisodeSequence:
        """A sequence of episodes that are at hand."""
        by_id = {episode.episode_id: episode for episode in episodes}
        return cls(
            [episode.episode_id for episode in episodes],
            by_id.__getitem__,
            [episode.scene for episode in episodes],
            notes=notes,
            source=source,
        )

    def __len__(self) -> int:
        return len(self.ids)

    @overload
    def __getitem__(self, index: int) -> Episode: ...
    @overload
    def __getitem__(self, index: slice) -> EpisodeSequence: ...
    def __getitem__(self, index: int | slice) -> Episode | EpisodeSequence:
        if isinstance(index, slice):
            return self.picked(range(len(self.ids))[index])
        return self._make(self.ids[index])

    def __iter__(self) -> Iterator[Episode]:
        return map(self._make, self.ids)

    def picked(self, indices: Sequence[int], notes: Sequence[str] = ()) -> EpisodeSequence:
        """The episodes at some indices, in that order, with further notes."""
        return EpisodeSequence(
            [self.ids[index] for index in indices],
            self._make,
            [self.scenes[index] for index in indices],
            notes=(*self.notes, *notes),
            source=self.source,
        )

    def mapped(self, change: Callable[[Episode], Episode]) -> EpisodeSequence:
        """The same sequence with every episode changed when it is asked for; the change keeps id and building."""
        make = self._make
        return EpisodeSequence(
            self.ids, lambda episode_id: change(make(episode_id)), self.scenes, notes=self.notes, source=self.source
        )

    def by_id(self, episode_id: str) -> Episode:
        """The episode of an id.

        Raises:
            UnknownNameError: there is none.
        """
        if episode_id not in self._index:
            raise UnknownNameError("episode", episode_id, self.ids)
        return self._make(episode_id)
