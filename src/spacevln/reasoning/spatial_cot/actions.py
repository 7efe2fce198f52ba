"""Executor actions as words: every choice of a body, what of it is admissible now, and back."""

from __future__ import annotations

from collections.abc import Iterator

from spacevln.core import (
    Action,
    AdmissibleActions,
    EnvironmentSpec,
    MoveForward,
    Stop,
    TurnLeft,
    TurnPurpose,
    TurnRight,
    describe,
)

Choices = dict[str, tuple[Action, TurnPurpose | None]]


def action_choices(spec: EnvironmentSpec, turn_steps: int = 1) -> Choices:
    """Every action that may be chosen, by its words: ``"forward 0.75"``, ``"left 30 align"``, ``"right 30 avoid"``, ``"stop"``.

    Args:
        spec: step, turn and longest forward of the body.
        turn_steps: largest turn in turn primitives.
    """
    forwards = range(1, int(spec.max_forward_m / spec.step_m + 1e-9) + 1)
    choices: Choices = {}
    for count in forwards:
        forward = MoveForward(spec.step_m * count)
        choices[words_of(forward, None)] = (forward, None)
    for steps in range(1, turn_steps + 1):
        angle_deg = spec.turn_deg * steps
        for turn in (TurnLeft(angle_deg), TurnRight(angle_deg)):
            for purpose in TurnPurpose:
                choices[words_of(turn, purpose)] = (turn, purpose)
    choices[words_of(Stop(), None)] = (Stop(), None)
    return choices


def words_of(action: Action, purpose: TurnPurpose | None) -> str:
    """The words of one action; a turn's say what it is for."""
    turns = isinstance(action, TurnLeft | TurnRight)
    return f"{describe(action)} {purpose or TurnPurpose.ALIGN}" if turns else describe(action)


def admissible_words(admissible: AdmissibleActions, choices: Choices) -> Iterator[str]:
    """The choices that U_t allows, in order."""
    return (words for words, (action, _) in choices.items() if admissible.allows(action))
