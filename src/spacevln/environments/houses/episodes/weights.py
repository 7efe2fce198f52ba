"""How likely an instruction is chosen among the unambiguous ones of a house.

A log-linear (maximum entropy) weight over counts of clause templates, words, sentences, anchors and lengths, fitted by
:mod:`.fitting` so that the chosen instructions have R2R's statistics.
"""

from __future__ import annotations

import json
from functools import lru_cache
from importlib.resources import files

from spacevln.environments.houses.episodes.clauses import Clause, anchors, mentions
from spacevln.environments.houses.episodes.episode import Split
from spacevln.environments.houses.episodes.realise import Text

# share [%] of R2R-CE instructions that contain a clause template: mean of val_seen and val_unseen
CLAUSE_SHARES = {
    "T1": 34.0, "T2": 5.8, "T3": 7.2, "T4": 14.9, "T5": 3.2, "T6": 6.4, "T7": 6.5, "M1": 13.6, "M2": 15.9, "H1": 19.5,
    "X1": 20.2, "X2": 8.5, "N1": 29.8, "N2": 14.6, "N3": 18.3, "D1": 20.7, "D2": 9.8, "P1": 33.2, "P2": 4.3, "G1": 19.3,
    "G2": 7.9, "S1": 19.1, "A1": 3.8, "A2": 5.1, "A3": 3.6, "A4": 4.3, "C1": 12.5, "C2": 8.2, "O1": 2.8, "V1": 1.8,
    "Z1": 9.1, "Z2": 10.5, "Z3": 16.8, "Z4": 10.9, "Z5": 8.9, "Z6": 11.3, "Z7": 21.1, "Z8": 7.2,
}  # fmt: skip
SENTENCE_SHARES = (19.0, 34.0, 31.0, 11.0, 4.0)
TURN_COUNT_SHARES = (38.0, 40.0, 16.0, 6.0)
TURN_CODES = frozenset(("T1", "T2", "T3", "T4", "T5", "T6"))


def instruction_features(clauses: tuple[Clause, ...], text: Text, length_m: float, height_m: float) -> dict[str, float]:
    """Features of an instruction by name; most are 0 or 1."""
    codes = {code for clause in clauses for code in clause.codes}
    out = {f"has:{code}": 1.0 for code in sorted(codes)}
    out[f"sentences:{min(text.sentences, 5)}"] = 1.0
    out[f"turns:{min(sum(bool(TURN_CODES & set(c.codes)) for c in clauses), 3)}"] = 1.0
    out[f"anchors:{min(anchors(clauses), 6)}"] = 1.0
    named, attributed = mentions(clauses)
    out["attributed"] = attributed - 0.17 * named
    out["clauses"] = float(len(clauses))
    out["words"] = text.words / 10.0
    out["words2"] = (text.words / 10.0) ** 2
    out["short words"] = float(text.words <= 14)
    out["length"] = length_m / 10.0
    out["length2"] = (length_m / 10.0) ** 2
    out["long"] = float(length_m > 12.0)
    out["climb"] = float(abs(height_m) > 1.0)
    out["stopless"] = float(not clauses[-1].is_stop)
    return out


def targets() -> dict[str, float]:
    """The mean of every feature over R2R-CE's instructions."""
    out = {f"has:{code}": share / 100.0 for code, share in CLAUSE_SHARES.items()}
    out |= {f"sentences:{k + 1}": share / 100.0 for k, share in enumerate(SENTENCE_SHARES)}
    out |= {f"turns:{k}": share / 100.0 for k, share in enumerate(TURN_COUNT_SHARES)}
    out |= {f"anchors:{k}": v for k, v in {1: 0.05, 2: 0.22, 3: 0.33, 4: 0.24, 5: 0.11, 6: 0.05}.items()}
    # only a fifth of the houses has stairs; R2R climbs a little more often
    out |= {"has:S1": 0.165, "has:Z5": 0.078, "climb": 0.16}
    out["sentences:5"] = 0.025  # the longest are chosen a little too often on unseen houses
    mean, deviation = 2.7, 1.1
    out |= {"attributed": 0.0, "clauses": 4.7, "words": mean, "words2": mean**2 + deviation**2, "short words": 0.1}
    out |= {"length": 0.915, "length2": 0.915**2 + 0.36**2, "long": 0.255, "stopless": 0.128}
    return out


@lru_cache(maxsize=2)
def _fitted(split: Split) -> dict[str, float]:
    text = files(__package__ or "").joinpath("weights.json").read_text(encoding="utf-8")
    weights: dict[str, dict[str, float]] = json.loads(text)
    return weights[split]


def log_weight(features: dict[str, float], split: Split) -> float:
    """Logarithm of an unnormalised probability."""
    weights = _fitted(split)
    return sum(weights.get(name, 0.0) * value for name, value in features.items())
