"""Zero-shot vision-and-language navigation with online Spatial Cognitive Memory (SpaceVLN)."""

__version__ = "0.1.0"
