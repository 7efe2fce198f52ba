"""The rules and the scripted doubles conform."""

from __future__ import annotations

from spacevln.core import Executor, ExecutorContext, MoveForward, Planner, Stop
from spacevln.reasoning.rules import RuleExecutor, RulePlanner
from spacevln.testing.reasoning import ExecutorConformance, PlannerConformance
from spacevln.testing.scripted import ScriptedExecutor


class TestRulePlanner(PlannerConformance):
    def make_planner(self) -> Planner:
        return RulePlanner()


class TestRuleExecutor(ExecutorConformance):
    def make_executor(self) -> Executor:
        return RuleExecutor()


def ahead(context: ExecutorContext) -> MoveForward | Stop:
    return MoveForward(context.admissible.forward_m[-1]) if context.admissible.forward_m else Stop()


class TestScriptedExecutor(ExecutorConformance):
    def make_executor(self) -> Executor:
        return ScriptedExecutor([ahead])
