"""Ineffective forward motion, from what the body really did (appendix "Action-space constraints")."""

from __future__ import annotations

from spacevln.core import Action, Motion, MoveForward


def is_stalled(asked: Action, motion: Motion, stall_m: float) -> bool:
    """Whether a forward primitive was asked and the body stood: it moved less than ``stall_m``."""
    return isinstance(asked, MoveForward) and motion.moved_m < stall_m
