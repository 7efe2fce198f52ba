"""Planner and executor replies as a model would write them, and minds that dictate them to a chat model.

With these any planner and executor, such as the rules, become the source of a scripted chat model: a whole episode runs through
prompts, HTTP and parsing, and must reach what its author reaches alone.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from spacevln.core import (
    Anchor,
    Executor,
    ExecutorContext,
    ExecutorReply,
    Planner,
    PlannerContext,
    PlannerReply,
    Task,
)
from spacevln.reasoning.spatial_cot.actions import words_of
from spacevln.reasoning.spatial_cot.wording import STATUS


def planner_words(reply: PlannerReply, *, scot: bool = True) -> dict[str, Any]:
    """The JSON object that says this reply; a metric target has no words."""
    subtask, thought = reply.subtask, reply.thought
    reasoning: dict[str, Any] = {
        "observation": thought.observation,
        "memory": thought.memory,
        "progress": {"reasoning": thought.progress, "verdict": subtask.verdict},
        "decision": thought.decision,
        "plan": thought.plan,
    }
    return (reasoning if scot else {"verdict": subtask.verdict}) | {
        "current_anchor": _place(subtask.current_anchor),
        "chain": [
            {
                "space": anchor.space,
                "kind": anchor.space_kind,
                "landmark": anchor.cue,
                "status": STATUS[subtask.status(index)],
            }
            for index, anchor in enumerate(subtask.chain)
        ],
        "next_anchor": None if subtask.next_anchor is None else _place(subtask.next_anchor),
        "direction": subtask.direction or None,
        "instruction": subtask.instruction,
        "landmark": subtask.landmark,
        "complete": subtask.complete,
    }


def executor_words(reply: ExecutorReply, *, scot: bool = True) -> dict[str, Any]:
    """The JSON object that says this reply."""
    choice, thought = words_of(reply.action, reply.purpose), reply.thought
    if not scot:
        return {"action": choice}
    return {
        "view": thought.view,
        "detection": thought.detection,
        "progress": thought.progress,
        "action": {"reasoning": thought.action, "choice": choice},
    }


def _place(anchor: Anchor) -> dict[str, str]:
    return {"space": anchor.space, "landmark": anchor.cue}


@dataclass
class Dictation:
    """Words on their way from their author to the chat model that says them."""

    lines: deque[str] = field(default_factory=deque)

    def tell(self, words: dict[str, Any]) -> None:
        """The author's next reply."""
        self.lines.append(json.dumps(words, ensure_ascii=False))

    def say(self, _request: object) -> str:
        """A line for a scripted chat model or server: the next reply."""
        return self.lines.popleft()


@dataclass
class DictatingPlanner:
    """Decides by ``author``; what counts is what ``speaker`` hears of it from its chat model.

    Args:
        author: what a reply has no words for (metric targets, the direction of a finished task) is dropped.
        speaker: asks the chat model.
        dictation: between the two; None = no words at all, the author's reply counts: what the speaker must equal.
        scot: with the reasoning fields.
    """

    author: Planner
    speaker: Planner | None = None
    dictation: Dictation = field(default_factory=Dictation)
    scot: bool = True

    def lookaround_queries(self, task: Task) -> Sequence[str]:
        """The author's: it cannot see pictures."""
        return self.author.lookaround_queries(task)

    def reset(self) -> None:
        """A new episode begins."""
        for planner in (self.author, self.speaker):
            if planner is not None:
                planner.reset()

    def plan(self, context: PlannerContext) -> PlannerReply:
        """The next subtask."""
        reply = self.author.plan(context)
        subtask = reply.subtask
        direction = "" if subtask.complete else subtask.direction
        reply = replace(reply, subtask=replace(subtask, target_m=None, direction=direction))
        if self.speaker is None:
            return reply
        self.dictation.tell(planner_words(reply, scot=self.scot))
        return self.speaker.plan(context)


@dataclass
class DictatingExecutor:
    """The same for an executor."""

    author: Executor
    speaker: Executor | None = None
    dictation: Dictation = field(default_factory=Dictation)
    scot: bool = True

    def reset(self) -> None:
        """A new episode begins."""
        for executor in (self.author, self.speaker):
            if executor is not None:
                executor.reset()

    def act(self, context: ExecutorContext) -> ExecutorReply:
        """The next action."""
        reply = self.author.act(context)
        if self.speaker is None:
            return reply
        self.dictation.tell(executor_words(reply, scot=self.scot))
        return self.speaker.act(context)
