"""Stage and episode budgets (paper "Experiment Setup"; DESIGN 5.6)."""

from __future__ import annotations

from spacevln.core import ContractError, InstructionTask, ObjectGoalTask, Task, UsageError

INSTRUCTION_STEPS = 260
OBJECT_GOAL_STEPS = 280
GN_BENCH_STEPS = 300


def default_step_limit(task: Task) -> int:
    """Environment steps of an episode [paper]: 260 for instructions, 280 for object goals. GN-Bench sets its 300 itself."""
    match task:
        case InstructionTask():
            return INSTRUCTION_STEPS
        case ObjectGoalTask():
            return OBJECT_GOAL_STEPS


class StepBudget:
    """Environment steps of one episode. Look-around, alignment and STOP are steps; the last one is held for STOP.

    Args:
        limit: number of steps, STOP included; at least 1.
    """

    def __init__(self, limit: int) -> None:
        if limit < 1:
            raise UsageError(f"Step budget {limit} leaves no room for STOP: give at least 1.")
        self.limit = limit
        self.taken = 0

    @property
    def left(self) -> int:
        """Steps that remain, the one for STOP included."""
        return self.limit - self.taken

    @property
    def can_move(self) -> bool:
        """Whether a step remains beside the one held for STOP."""
        return self.left > 1

    def affords(self, steps: int) -> bool:
        """Whether so many steps and STOP still fit; a step that could move must remain in any case."""
        return self.can_move and self.left > steps

    def spend(self) -> None:
        """Count one step.

        Raises:
            ContractError: none is left.
        """
        if self.left < 1:
            raise ContractError(f"All {self.limit} steps of the episode are spent: the loop must have stopped before.")
        self.taken += 1
