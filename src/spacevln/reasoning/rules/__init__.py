"""Rule-based planner and executor: honest baselines that need no model."""

from spacevln.reasoning.rules.executor import RuleExecutor
from spacevln.reasoning.rules.lattice import Gait
from spacevln.reasoning.rules.planner import RulePlanner

__all__ = ["Gait", "RuleExecutor", "RulePlanner"]
