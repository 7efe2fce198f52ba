"""Spatial-CoT: planner and executor that ask a chat model (paper Sec. 3.3; DESIGN 5.4, family *vlm*)."""

from spacevln.reasoning.spatial_cot.executor import ModelExecutor
from spacevln.reasoning.spatial_cot.executor_prompt import ExecutorPrompt
from spacevln.reasoning.spatial_cot.planner import ModelPlanner
from spacevln.reasoning.spatial_cot.planner_prompt import PlannerPrompt
from spacevln.reasoning.spatial_cot.settings import Layout, PromptSettings

__all__ = ["ExecutorPrompt", "Layout", "ModelExecutor", "ModelPlanner", "PlannerPrompt", "PromptSettings"]
