"""How near generated episodes come to the statistics of R2R-CE: measured values beside their targets and tolerances.

Targets are means of val_seen and val_unseen (share of instructions in percent unless said otherwise).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spacevln.environments.houses.episodes.episode import HouseEpisode
from spacevln.environments.houses.episodes.weights import CLAUSE_SHARES, SENTENCE_SHARES, TURN_CODES

_NORMAL_95 = 1.645  # a share counts as outside its band only when chance does not explain it (one-sided, 5 %)


@dataclass(frozen=True, slots=True)
class Row:
    """One line of the table.

    Args:
        name: what was measured.
        value: on the episodes.
        target: of R2R-CE, or the middle of the allowed range.
        low, high: allowed range.
    """

    name: str
    value: float
    target: float
    low: float
    high: float

    @property
    def holds(self) -> bool:
        """Whether the value is allowed."""
        return self.low <= self.value <= self.high


def _share(flags: Sequence[bool]) -> float:
    return 100.0 * float(np.mean(flags))


def _band(name: str, flags: Sequence[bool], target: float, relative: float = 0.3) -> Row:
    """A share and its band around the target, wider by the sampling error at the band's edges."""
    low, high = target * (1 - relative), target * (1 + relative)
    error = [_NORMAL_95 * 100.0 * (edge / 100.0 * (1 - edge / 100.0) / len(flags)) ** 0.5 for edge in (low, high)]
    return Row(name, _share(flags), target, low - error[0], high + error[1])


def route_table(episodes: Sequence[HouseEpisode]) -> list[Row]:
    """Statistics of route episodes."""
    tags = [e.tags for e in episodes]
    words = np.array([t.words for t in tags])
    lengths = np.array([e.geodesic_m for e in episodes])
    named, attributed = (sum(t.mentions[k] for t in tags) for k in (0, 1))
    rows = [
        Row("words, mean", float(words.mean()), 27.0, 23.0, 31.0),
        Row("words, deviation", float(words.std()), 11.0, 8.0, 14.0),
        Row("anchors, mean", float(np.mean([t.anchors for t in tags])), 3.3, 2.9, 3.7),
        Row("clauses, mean", float(np.mean([t.clause_count for t in tags])), 4.7, 4.0, 5.4),
        Row("sentences, mean", float(np.mean([t.sentences for t in tags])), 2.5, 2.1, 2.9),
        Row("geodesic, mean m", float(lengths.mean()), 9.0, 8.5, 9.5),
        Row("geodesic, shortest m", float(lengths.min()), 4.0, 4.0, 21.0),
        Row("geodesic, longest m", float(lengths.max()), 21.0, 4.0, 21.0),
        Row("over 12 m", _share([length > 12.0 for length in lengths]), 22.5, 20.0, 35.0),
        Row("over 1 m of height", _share([abs(t.height_m) > 1.0 for t in tags]), 15.0, 8.0, 25.0),
        Row("attributed mentions", 100.0 * attributed / max(named, 1), 17.0, 12.0, 22.0),
        Row("ambiguity, worst m", max(t.ambiguity_m for t in tags), 1.5, 0.0, 3.0),
        Row("nodes, fewest", min(len(e.reference_path) for e in episodes), 4, 4, 7),
        Row("nodes, most", max(len(e.reference_path) for e in episodes), 7, 4, 7),
    ]
    rows += [
        _band(f"sentences {k + 1}{'+' if k == 4 else ''}", [min(t.sentences, 5) == k + 1 for t in tags], share)
        for k, share in enumerate(SENTENCE_SHARES)
    ]
    rows += [_band(code, [code in t.clauses for t in tags], share) for code, share in CLAUSE_SHARES.items()]
    rows.append(_band("any turn", [bool(TURN_CODES & set(t.clauses)) for t in tags], 62.0))
    return rows


def object_table(episodes: Sequence[HouseEpisode]) -> list[Row]:
    """Statistics of object-goal episodes."""
    tags = [e.tags for e in episodes]
    return [
        Row("unseen and two doors away", _share([not t.goal_visible and t.doors >= 2 for t in tags]), 75.0, 60.0, 100.0),
        Row("categories", len({e.category for e in episodes}), 70.0, min(30.0, len(episodes) / 4), 200.0),
        Row("geodesic, mean m", float(np.mean([e.geodesic_m for e in episodes])), 8.0, 4.0, 12.0),
    ]


def as_text(rows: Sequence[Row]) -> str:
    """The table as Markdown."""
    lines = ["| quantity | measured | R2R-CE | allowed | holds |", "|---|---|---|---|---|"]
    lines += [
        f"| {row.name} | {row.value:.1f} | {row.target:.1f} | {row.low:.1f} to {row.high:.1f} | {'yes' if row.holds else 'NO'} |"
        for row in rows
    ]
    return "\n".join(lines)
