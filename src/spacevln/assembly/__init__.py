"""Configuration, and the one place that names concrete classes."""

from spacevln.assembly.build import build_agent, build_environment
from spacevln.assembly.configuration import (
    ComponentSettings,
    Configuration,
    HousesSettings,
    LabelDetectorSettings,
)

__all__ = [
    "ComponentSettings",
    "Configuration",
    "HousesSettings",
    "LabelDetectorSettings",
    "build_agent",
    "build_environment",
]
