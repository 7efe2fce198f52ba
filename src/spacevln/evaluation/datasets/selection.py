"""Which episodes of which suite: what ``bench`` takes and workers are told."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from spacevln.core import PrerequisiteError, UnknownNameError, UsageError
from spacevln.evaluation.datasets import gn_bench, hm3d_ovon, r2r_ce, rxr_ce
from spacevln.evaluation.datasets.filters import Filters
from spacevln.evaluation.datasets.paper import checked, paper_subset
from spacevln.evaluation.datasets.sequence import EpisodeSequence
from spacevln.evaluation.stored import VERSION, stored_suite

Probe = Literal["none", "swapped", "elsewhere", "last-noun"]
HOUSES_SUITES = ("houses-vln", "houses-objectnav")
BENCHMARKS = ("r2r-ce", "rxr-ce", "hm3d-ovon", "gn-bench")
SUITES = (*HOUSES_SUITES, *BENCHMARKS)

SPLITS: dict[str, tuple[str, ...]] = {
    "houses-vln": ("test", "dev"),
    "houses-objectnav": ("test", "dev"),
    "r2r-ce": ("val_unseen", *(split for split in r2r_ce.SPLITS if split != "val_unseen"), "paper"),
    "rxr-ce": ("val_unseen", *(split for split in rxr_ce.SPLITS if split != "val_unseen"), "paper"),
    "hm3d-ovon": ("val_unseen", *(split for split in hm3d_ovon.SPLITS if split != "val_unseen"), "paper"),
    "gn-bench": ("test_unseen", *(split for split in gn_bench.SPLITS if split != "test_unseen"), "paper"),
}
"""Splits of every suite, the default first."""


class Selection(BaseModel):
    """Which episodes of which suite.

    Args:
        suite: its name.
        split: of the suite; None takes the first of :data:`SPLITS`. ``test`` of a houses suite has phrases never used for tuning.
        path: where the data of a benchmark lies, or a houses suite in a file instead of the stored one.
        seeds: houses: one fresh episode of each house seed A..B-1 instead of a split.
        filters: conditions.
        episodes: only the first so many of what the filters leave.
        shard: (i, n): every n-th of those from the i-th on, i from 1, so that n machines share the work.
        probe: replaces the instruction, to see whether it matters (:mod:`..probes`).
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    suite: str
    split: str | None = None
    path: Path | None = None
    seeds: tuple[int, int] | None = None
    filters: Filters = Filters()
    episodes: int | None = None
    shard: tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(ge=1)]] | None = None
    probe: Probe = "none"

    @property
    def name(self) -> str:
        """One line that identifies the selection in ``run.json``; how many of its episodes run, and where, does not matter."""
        words = [self.suite]
        words.append(self._split if self.seeds is None else f"seeds {self.seeds[0]}:{self.seeds[1]}")
        words += [VERSION] if self.suite in HOUSES_SUITES and self.seeds is None and self.path is None else []
        words += [self.filters.words] if self.filters.words else []
        words += [f"probe {self.probe}"] if self.probe != "none" else []
        return " ".join(words)

    def load(self) -> EpisodeSequence:
        """The episodes.

        Raises:
            UsageError: the suite, split or a filter is unknown, or the selection is empty.
            PrerequisiteError: the data is not there.
        """
        everything = self.whole()
        if self.shard is None:
            return everything
        number, count = self.shard
        if number > count:
            raise UsageError(f"Shard {number}/{count} does not exist: give i/n with 1 <= i <= n.")
        return everything.picked(range(number - 1, len(everything), count))

    def whole(self) -> EpisodeSequence:
        """The episodes of all shards together."""
        if self.suite not in SUITES:
            raise UnknownNameError("suite", self.suite, SUITES)
        if self._split not in SPLITS[self.suite]:
            raise UnknownNameError(f"split of {self.suite}", self._split, SPLITS[self.suite])
        if self.episodes is not None and self.episodes < 1:
            raise UsageError(f"{self.episodes} episodes were asked for: give at least 1.")
        episodes = self._houses() if self.suite in HOUSES_SUITES else self._benchmark()
        return self.filters.apply(episodes)[: self.episodes]

    @property
    def _split(self) -> str:
        return self.split or SPLITS.get(self.suite, ("",))[0]

    def _houses(self) -> EpisodeSequence:
        self._refuse("language", "role", "available_in")
        from spacevln.evaluation.houses import fresh_episodes, stored_episodes
        from spacevln.evaluation.probes import probed

        if self.seeds is None:
            path = self.path or stored_suite(self.suite, self._split)
            return probed(stored_episodes(self.suite, path, self._split), self.probe)
        first, last = self.seeds
        if self.path is not None:
            raise UsageError(f"Seeds {first}:{last} and a suite in the file {str(self.path)!r} exclude each other: give one.")
        if not 0 <= first < last:
            raise UsageError(f"Seeds {first}:{last} name no house: give A:B with 0 <= A < B.")
        return probed(fresh_episodes(self.suite, range(first, last)), self.probe)

    def _benchmark(self) -> EpisodeSequence:
        if self.seeds is not None or self.probe != "none":
            raise UsageError(f"Suite {self.suite!r} has no house seeds and no probes: leave --seeds and --probe out.")
        if self.path is None:
            raise PrerequisiteError(
                f"Suite {self.suite!r} reads its episodes from files: give their folder with --data "
                "(docs/benchmarks.md says where to get them)."
            )
        if self.suite != "rxr-ce":
            self._refuse("language", "role")
        if self._split == "paper":
            subset = paper_subset(self.suite)
            everything = self._read(subset.split)
            listed = Filters(ids=self.filters.ids) if subset.listed else Filters()
            return checked(self.suite, listed.apply(everything))
        return self._read(self._split)

    def _read(self, split: str) -> EpisodeSequence:
        assert self.path is not None  # noqa: S101 - checked by the caller
        match self.suite:
            case "r2r-ce":
                return r2r_ce.load_r2r_ce(self.path, split)
            case "rxr-ce":
                subset = paper_subset(self.suite) if self._split == "paper" else None
                roles = self.filters.role or (subset.role if subset else None) or ("guide",)
                return rxr_ce.load_rxr_ce(self.path, split, roles, self.filters.language or (subset.language if subset else None))
            case "hm3d-ovon":
                return hm3d_ovon.load_hm3d_ovon(self.path, split)
            case _:
                return gn_bench.load_gn_bench(self.path, split)

    def _refuse(self, *names: str) -> None:
        for name in names:
            if getattr(self.filters, name) is not None:
                raise UsageError(f"Suite {self.suite!r} has no {name.replace('_', ' ')} to filter by: leave it out.")
