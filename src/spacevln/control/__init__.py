"""Control reliability: which replies, actions and stops are admissible (paper appendix "Control Reliability", DESIGN 5.6)."""

from spacevln.control.admissible import AdmissibleActionControl, forward_choices
from spacevln.control.arrival import ArrivalKind, StageArrival
from spacevln.control.budgets import StepBudget, default_step_limit
from spacevln.control.gate import EpisodeGate, FinishClaim, GateVerdict
from spacevln.control.looking import turns_to_see, whole_turn
from spacevln.control.primitives import decompose, turns_toward
from spacevln.control.settings import ControlSettings
from spacevln.control.stable import StableFinalArrival, inside_final_region
from spacevln.control.stall import is_stalled
from spacevln.control.turns import TurnMonitor
from spacevln.control.validation import Rejection, chain_revision, validate_subtask

__all__ = [
    "AdmissibleActionControl",
    "ArrivalKind",
    "ControlSettings",
    "EpisodeGate",
    "FinishClaim",
    "GateVerdict",
    "Rejection",
    "StableFinalArrival",
    "StageArrival",
    "StepBudget",
    "TurnMonitor",
    "chain_revision",
    "decompose",
    "default_step_limit",
    "forward_choices",
    "inside_final_region",
    "is_stalled",
    "turns_to_see",
    "turns_toward",
    "validate_subtask",
    "whole_turn",
]
