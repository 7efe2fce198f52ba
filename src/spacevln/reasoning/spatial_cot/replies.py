"""What a planner and an executor must write: one JSON object each, its reasoning fields before its decisions.

Paper appendix "Task-Guided Spatial Reasoning Details". The order of the fields is the order in which a model writes them, so it
reasons before it decides. The variants without Spatial-CoT (Table 4, -P and -E) hold the decisions alone.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

Words = Annotated[str, Field(max_length=6000)]
Name = Annotated[str, Field(max_length=80)]
Verdict = Literal["first", "completed", "continue", "transition"]


class _Reply(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True)


class Place(_Reply):
    """A space--landmark anchor (Eq. 1): a space and the landmark by which it is told."""

    space: Name
    landmark: Name


class ChainAnchor(_Reply):
    """An anchor of the chain C_k, with its state."""

    space: Name
    kind: Literal["room", "connector", "floor_transition", "unknown"]
    landmark: Name
    status: Literal["done", "here", "ahead"]


class ProgressEstimate(_Reply):
    """r_prog: the words, then the typed verdict on the last subtask."""

    reasoning: Words
    verdict: Verdict


class StageVariables(_Reply):
    """sigma_k (Eq. 2), in the order of the equation."""

    current_anchor: Place
    chain: Annotated[list[ChainAnchor], Field(min_length=1, max_length=24)]
    next_anchor: Place | None
    direction: Name | None
    instruction: Annotated[str, Field(max_length=600)]
    landmark: Name
    complete: bool


class _PlannerThought(_Reply):
    observation: Words
    memory: Words
    progress: ProgressEstimate
    decision: Words
    plan: Words


class SpatialCoTPlannerReply(StageVariables, _PlannerThought):
    """r^P_k and sigma_k: the five reasoning fields, then the stage variables."""


class _PlannerVerdict(_Reply):
    verdict: Verdict


class DirectPlannerReply(StageVariables, _PlannerVerdict):
    """sigma_k alone, with the verdict on the last subtask (ablation -P)."""


class ActionChoice(_Reply):
    """r_act: the words, then the action."""

    reasoning: Words
    choice: Name


class SpatialCoTExecutorReply(_Reply):
    """r^E_t: the four fields, the last of them with the action a_t."""

    view: Words
    detection: Words
    progress: Words
    action: ActionChoice


class DirectExecutorReply(_Reply):
    """a_t alone (ablation -E)."""

    action: Name
