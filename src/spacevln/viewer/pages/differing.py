"""Where two records of one episode part."""

from __future__ import annotations

from typing import Any

DECIDED = ("direction", "landmark", "next", "complete")
"""What of a subtask is a decision; its sentence may be worded otherwise."""


def first_difference(first: dict[str, Any], second: dict[str, Any]) -> dict[str, Any] | None:
    """The first planner or executor decision that differs between two stories; None when all agree.

    Returns:
        ``stage``, ``decision`` (its number; None for the planner's), ``what`` in words, the ``values`` of both sides and the
        index of the ``steps`` at which they are made.
    """
    for number in range(max(len(first["stages"]), len(second["stages"]))):
        stages = [story["stages"][number] if number < len(story["stages"]) else None for story in (first, second)]
        if None in stages:
            ends = [
                _last(story) if stage is None else stage["first"] for story, stage in zip((first, second), stages, strict=True)
            ]
            return _difference(number, None, "number of stages", _said(stages), ends)
        subtasks = [stage.get("subtask") for stage in stages if stage]
        for name in DECIDED:
            values = [subtask and subtask[name] for subtask in subtasks]
            if values[0] != values[1]:
                at = [stage.get("planned", stage["first"]) for stage in stages if stage]
                return _difference(number, None, f"planner: {name}", list(map(_word, values)), at)
        made = [[decision for decision in story["decisions"] if decision["stage"] == number] for story in (first, second)]
        for k in range(max(map(len, made))):
            pair = [decisions[k] if k < len(decisions) else None for decisions in made]
            values = [decision and decision["action"] for decision in pair]
            if values[0] != values[1]:
                at = [
                    min(decision["first"], _last(story)) if decision else stage.get("last", stage["first"])
                    for decision, story, stage in zip(pair, (first, second), stages, strict=True)
                    if stage
                ]
                return _difference(number, k + 1, f"executor: decision {k + 1}", list(map(_word, values)), at)
    return None


def _difference(stage: int, decision: int | None, what: str, values: list[str], steps: list[int]) -> dict[str, Any]:
    return {"stage": stage, "decision": decision, "what": what, "values": values, "steps": steps}


def _last(story: dict[str, Any]) -> int:
    return max(0, len(story["steps"]) - 1)


def _said(stages: list[dict[str, Any] | None]) -> list[str]:
    return ["ended before" if stage is None else "went on" for stage in stages]


def _word(value: object) -> str:
    return "none" if value in (None, "") else "yes" if value is True else "no" if value is False else str(value)
