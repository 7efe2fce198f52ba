"""What can be set about Spatial-CoT prompts; every value is part of the run's configuration."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Layout(StrEnum):
    """How the look-around reaches the planner."""

    SEPARATE = "separate"  # one picture per view
    MOSAIC = "mosaic"  # all views as tiles of one picture


@dataclass(frozen=True, slots=True)
class PromptSettings:
    """Settings of the model-written planner and executor.

    Args:
        hsm, landmark_memory, planner_scot, executor_scot, stagewise: the paper's component switches (Table 4): what is off is
            not spoken of.
        view_count: views of the look-around that are shown, evenly spaced from the front: 12, 6 or 4 of 12; 8 or 4 of 8.
            [paper: all 12]
        layout: separate pictures or one mosaic. [authors' code: separate]
        view_width_px: width of a view, in a mosaic of a tile [px]. [authors' code]
        forward_width_px: width of the executor's front view [px]. [authors' code]
        jpeg_quality: of both, 1 to 100. [authors' code]
        show_detections: whether the views show the detections of the last stage's landmark. [authors' code]
        turn_steps: largest turn that an executor may choose, in turn primitives. [authors' code: 1]
        planner_max_tokens: bound of a planner's reply. [authors' code]
        executor_max_tokens: bound of an executor's reply; the authors' code has 300 for two fields. [ours]
    """

    hsm: bool = True
    landmark_memory: bool = True
    planner_scot: bool = True
    executor_scot: bool = True
    stagewise: bool = True
    view_count: int = 12
    layout: Layout = Layout.SEPARATE
    view_width_px: int = 512
    forward_width_px: int = 512
    jpeg_quality: int = 75
    show_detections: bool = True
    turn_steps: int = 1
    planner_max_tokens: int = 4096
    executor_max_tokens: int = 600
