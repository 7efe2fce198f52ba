from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from spacevln.assembly import Configuration, LabelDetectorSettings, OpenVocabularySettings, build_detector
from spacevln.cli.detector_options import detector_from, detector_options
from spacevln.core import PrerequisiteError, UnknownNameError
from spacevln.perception import LabelDetector


def chosen(*arguments: str, preset: str | None = None) -> LabelDetectorSettings | OpenVocabularySettings | str:
    seen: list[LabelDetectorSettings | OpenVocabularySettings] = []

    @click.command()
    @click.argument("suite")
    @detector_options
    def command(suite: str, **options: object) -> None:
        assert suite
        seen.append(detector_from(options | {"preset": preset}))

    result = CliRunner().invoke(command, arguments)
    return seen[0] if seen else result.output


def test_labels_are_the_default_and_models_take_the_paper_s_thresholds() -> None:
    assert chosen("houses-vln") == LabelDetectorSettings()
    assert chosen("r2r-ce", "--detector", "grounding-dino-tiny") == OpenVocabularySettings(
        grounder="grounding-dino-tiny", segmenter="sam2.1-tiny"
    )
    paper = chosen("hm3d-ovon", "--detector", "grounding-dino-tiny", "--share-detector", preset="paper")
    assert paper == OpenVocabularySettings(
        grounder="grounding-dino-tiny", segmenter="repvit-sam", box_threshold=0.5, text_threshold=0.5, shared=True
    )
    assert "belong to a model" in str(chosen("houses-vln", "--segmenter", "repvit-sam"))
    assert "simulate errors of labels" in str(chosen("houses-vln", "--detector", "owlv2-base", "--miss-rate", "0.1"))


def test_the_choice_is_part_of_the_configuration_and_labels_keep_its_hash() -> None:
    models = Configuration(detector=OpenVocabularySettings(grounder="owlv2-base", segmenter="none"))
    assert Configuration.model_validate_json(models.model_dump_json()) == models
    assert models.hash != Configuration().hash
    assert set(Configuration().model_dump()["detector"]) == {"miss_rate", "confusion_rate", "jitter_px", "seed"}
    assert isinstance(build_detector(Configuration()), LabelDetector)


def test_missing_weights_and_wrong_names_are_sentences(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPACEVLN_MODELS", str(tmp_path))
    with pytest.raises(PrerequisiteError, match="run spacevln models download grounding-dino-base"):
        build_detector(Configuration(detector=OpenVocabularySettings(grounder="grounding-dino-base", segmenter="none")))
    with pytest.raises(UnknownNameError, match="grounding-dino-tiny"):
        build_detector(Configuration(detector=OpenVocabularySettings(grounder="grounding-dino", segmenter="none")))
