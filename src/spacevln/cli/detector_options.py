"""Options that choose an open-vocabulary detector."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from spacevln.assembly import LabelDetectorSettings, OpenVocabularySettings
    from spacevln.perception.open_vocabulary.opening import DetectorChoice

F = TypeVar("F", bound=Callable[..., Any])


def model_choice_options(command: F) -> F:
    """Which models, where, with which thresholds."""
    for option in reversed(
        (
            click.option(
                "--grounder", default="grounding-dino-tiny", show_default=True, help="Finds boxes (spacevln models list)."
            ),
            click.option("--segmenter", default="sam2.1-tiny", show_default=True, help="Cuts masks; none = boxes only."),
            click.option("--box-threshold", type=click.FloatRange(0, 1), default=0.25, show_default=True),
            click.option("--text-threshold", type=click.FloatRange(0, 1), default=0.25, show_default=True),
            click.option("--device", type=click.Choice(["auto", "cpu", "cuda", "mps"]), default="auto", show_default=True),
            click.option("--dtype", type=click.Choice(["float32", "float16", "bfloat16"]), default="float32", show_default=True),
        )
    ):
        command = option(command)
    return command


def detector_options(command: F) -> F:
    """Which detector a run has."""
    for option in reversed(
        (
            click.option(
                "--detector",
                default="labels",
                show_default=True,
                help="A simulator's labels, or a model such as grounding-dino-tiny (see spacevln models list).",
            ),
            click.option("--segmenter", default=None, help="Cuts masks: by default sam2.1-tiny, with --preset paper repvit-sam."),
            click.option(
                "--detector-threshold", type=click.FloatRange(0, 1), default=None, help="By default 0.25, object goals 0.5."
            ),
            click.option(
                "--detector-device", type=click.Choice(["auto", "cpu", "cuda", "mps"]), default="auto", show_default=True
            ),
            click.option(
                "--detector-dtype", type=click.Choice(["float32", "float16", "bfloat16"]), default="float32", show_default=True
            ),
            click.option(
                "--detector-batch", type=click.IntRange(min=1), default=12, show_default=True, help="Images per forward pass."
            ),
            click.option(
                "--share-detector", is_flag=True, help="One process holds the detector for all workers of this machine."
            ),
            click.option("--miss-rate", type=click.FloatRange(0, 1), default=0.0, help="Share of labelled instances overlooked."),
            click.option("--confusion-rate", type=click.FloatRange(0, 1), default=0.0, help="Share called by a similar name."),
            click.option(
                "--jitter-px", type=click.FloatRange(min=0), default=0.0, help="How far their masks are shifted, at most."
            ),
        )
    ):
        command = option(command)
    return command


def detector_from(options: dict[str, Any]) -> LabelDetectorSettings | OpenVocabularySettings:
    """The detector that these options say."""
    from spacevln.assembly import LabelDetectorSettings, OpenVocabularySettings
    from spacevln.assembly.presets import PAPER
    from spacevln.perception.open_vocabulary.boxes import OBJECT_GOAL_THRESHOLD, BoxRules

    if options["detector"] == "labels":
        if options["segmenter"] or options["detector_threshold"] is not None:
            raise click.UsageError(
                "--segmenter and --detector-threshold belong to a model: add --detector, e.g. grounding-dino-tiny."
            )
        return LabelDetectorSettings(
            miss_rate=options["miss_rate"], confusion_rate=options["confusion_rate"], jitter_px=options["jitter_px"]
        )
    if options["miss_rate"] or options["confusion_rate"] or options["jitter_px"]:
        raise click.UsageError(
            "--miss-rate, --confusion-rate and --jitter-px simulate errors of labels: leave them out, or leave --detector out."
        )
    threshold = options["detector_threshold"]
    if threshold is None:
        threshold = OBJECT_GOAL_THRESHOLD if _goal_is_an_object() else BoxRules().box_threshold
    return OpenVocabularySettings(
        grounder=options["detector"],
        segmenter=options["segmenter"] or ("repvit-sam" if options["preset"] == PAPER else "sam2.1-tiny"),
        box_threshold=threshold,
        text_threshold=threshold,
        device=options["detector_device"],
        dtype=options["detector_dtype"],
        batch_size=options["detector_batch"],
        shared=options["share_detector"],
    )


def _goal_is_an_object() -> bool:
    """Whether the command's task or suite seeks objects."""
    asked = click.get_current_context().params
    return asked.get("task") == "objectnav" or str(asked.get("suite", "")).endswith(("objectnav", "ovon"))


def choice_from(options: dict[str, Any]) -> DetectorChoice:
    """What these options say."""
    from spacevln.perception.open_vocabulary.boxes import BoxRules
    from spacevln.perception.open_vocabulary.compute import Compute
    from spacevln.perception.open_vocabulary.opening import DetectorChoice

    return DetectorChoice(
        grounder=options["grounder"],
        segmenter=options["segmenter"],
        rules=BoxRules(box_threshold=options["box_threshold"], text_threshold=options["text_threshold"]),
        compute=Compute(options["device"], options["dtype"]),
    )
