"""Configuration, and the one place that names concrete classes."""

from spacevln.assembly.benchmark_presets import PRESETS, BenchmarkPreset, preset_of
from spacevln.assembly.build import build_agent, build_detector, build_environment, check_settings, prompt_settings
from spacevln.assembly.configuration import (
    ComponentSettings,
    Configuration,
    GNBenchSettings,
    HabitatSettings,
    HousesSettings,
    KnownBuilding,
    LabelDetectorSettings,
    ModelPair,
    OpenVocabularySettings,
    PromptOptions,
)
from spacevln.assembly.presets import ABLATIONS, PAPER, ablation_of, same_programs
from spacevln.assembly.registration import RegisteredEnvironment
from spacevln.assembly.situations import RecordedSituations

__all__ = [
    "ABLATIONS",
    "PAPER",
    "PRESETS",
    "BenchmarkPreset",
    "ComponentSettings",
    "Configuration",
    "GNBenchSettings",
    "HabitatSettings",
    "HousesSettings",
    "KnownBuilding",
    "LabelDetectorSettings",
    "ModelPair",
    "OpenVocabularySettings",
    "PromptOptions",
    "RecordedSituations",
    "RegisteredEnvironment",
    "ablation_of",
    "build_agent",
    "build_detector",
    "build_environment",
    "check_settings",
    "preset_of",
    "prompt_settings",
    "same_programs",
]
