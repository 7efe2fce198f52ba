"""Opening a detector by the names of its models."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from spacevln.core import UnknownNameError, UsageError
from spacevln.perception.open_vocabulary.boxes import BoxRules
from spacevln.perception.open_vocabulary.checkpoints import need
from spacevln.perception.open_vocabulary.compute import Compute, Device, Precision
from spacevln.perception.open_vocabulary.detector import Grounder, OpenVocabularyDetector, Segmenter
from spacevln.perception.weights import WeightStore, catalogue

BOXES_ONLY = "none"
"""Name of the segmenter that cuts nothing."""

GROUNDERS = tuple(name for name, model in catalogue().items() if model.role == "grounder")
SEGMENTERS = (*(name for name, model in catalogue().items() if model.role == "segmenter"), BOXES_ONLY)


@dataclass(frozen=True, slots=True)
class DetectorChoice:
    """Which models, and how they run.

    Args:
        grounder: one of :data:`GROUNDERS`.
        segmenter: one of :data:`SEGMENTERS`; the paper's is ``repvit-sam``.
        rules: which boxes count.
        compute: where and how precisely.
        batch_size: images per forward pass; a look-around has 12.
    """

    grounder: str = "grounding-dino-tiny"
    segmenter: str = "sam2.1-tiny"
    rules: BoxRules = BoxRules()  # noqa: RUF009 - frozen
    compute: Compute = Compute()  # noqa: RUF009 - frozen
    batch_size: int = 12


def open_detector(choice: DetectorChoice, store: WeightStore | None = None) -> OpenVocabularyDetector:
    """A detector with its models in memory.

    Raises:
        UsageError: a name is unknown, or weights are damaged.
        PrerequisiteError: a library or weights are missing; the sentence has the command.
    """
    store = store or WeightStore.default()
    _check(choice)
    grounder = _grounder(choice, store.open(choice.grounder))
    segmenter = None if choice.segmenter == BOXES_ONLY else _segmenter(choice, store.open(choice.segmenter))
    return OpenVocabularyDetector(grounder, segmenter, choice.rules, choice.batch_size)


def open_from(
    grounder: str,
    segmenter: str,
    box_threshold: float,
    text_threshold: float,
    device: Device,
    dtype: Precision,
    batch_size: int,
) -> OpenVocabularyDetector:
    """The same from plain values, as they come out of a configuration, here or in a detector server.

    Raises:
        UsageError, PrerequisiteError: see :func:`open_detector`.
    """
    rules = BoxRules(box_threshold, text_threshold)
    return open_detector(DetectorChoice(grounder, segmenter, rules, Compute(device, dtype), batch_size))


def _check(choice: DetectorChoice) -> None:
    for kind, name, allowed in (("grounder", choice.grounder, GROUNDERS), ("segmenter", choice.segmenter, SEGMENTERS)):
        if name not in allowed:
            raise UnknownNameError(kind, name, allowed)
    if choice.batch_size < 1:
        raise UsageError(f"batch_size={choice.batch_size} is not positive: give the images per forward pass.")


def _grounder(choice: DetectorChoice, folder: Path) -> Grounder:
    need("torch")
    need("transformers")
    if choice.grounder.startswith("owlv2"):
        from spacevln.perception.open_vocabulary.owlv2 import Owlv2

        return Owlv2(folder, choice.compute)
    from spacevln.perception.open_vocabulary.grounding_dino import GroundingDino

    return GroundingDino(folder, choice.compute)


def _segmenter(choice: DetectorChoice, folder: Path) -> Segmenter:
    if choice.segmenter.endswith("-onnx"):
        from spacevln.perception.open_vocabulary.onnx_sam import OnnxSegmenter

        return OnnxSegmenter(folder)
    if choice.segmenter == "repvit-sam":
        from spacevln.perception.open_vocabulary.repvit_sam import open_repvit_sam

        return open_repvit_sam(folder / "repvit_sam.pt", choice.compute)
    from spacevln.perception.open_vocabulary.sam import open_sam

    return open_sam(folder, choice.compute)
