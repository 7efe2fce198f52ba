"""Configuration, and the one place that names concrete classes."""

from spacevln.assembly.build import build_agent, build_environment
from spacevln.assembly.configuration import (
    ComponentSettings,
    Configuration,
    HousesSettings,
    KnownBuilding,
    LabelDetectorSettings,
    ModelPair,
)
from spacevln.assembly.registration import RegisteredEnvironment

__all__ = [
    "ComponentSettings",
    "Configuration",
    "HousesSettings",
    "KnownBuilding",
    "LabelDetectorSettings",
    "ModelPair",
    "RegisteredEnvironment",
    "build_agent",
    "build_environment",
]
