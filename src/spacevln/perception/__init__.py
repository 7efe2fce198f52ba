"""From pixels to places: detectors ground phrases in images, lifting puts them into the episode frame."""

from spacevln.perception.attributes import Agreement
from spacevln.perception.label_detector import LabelDetector
from spacevln.perception.lifting import lift
from spacevln.perception.matching import Match, fit, match, names

__all__ = ["Agreement", "LabelDetector", "Match", "fit", "lift", "match", "names"]
