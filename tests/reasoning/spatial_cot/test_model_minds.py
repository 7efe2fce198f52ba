"""Planner and executor that ask a chat model: conformance, asking again, a whole episode in words."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from cot_situations import BENCH, BODY, MOVE, OBEY, REPLY, SOFA, first_call, later_call, query, settings

from spacevln.agent import AgentSettings, NavigationAgent
from spacevln.core import (
    Action,
    Anchor,
    ChatRequest,
    CueKind,
    DecisionMade,
    EpisodeSpec,
    EpisodeStatus,
    ExecutorContext,
    FallbackUsed,
    InstructionTask,
    ModelError,
    MoveForward,
    PlannerContext,
    Pose,
    ReplyRefused,
    ReplyRejected,
    SpaceKind,
    Speaker,
    StageEnd,
    StepTaken,
    Stop,
    StopReason,
    Subtask,
    SubtaskIssued,
    TurnLeft,
)
from spacevln.perception import LabelDetector
from spacevln.reasoning.rules import RuleExecutor, RulePlanner
from spacevln.reasoning.spatial_cot import ExecutorPrompt, ModelExecutor, ModelPlanner, PlannerPrompt
from spacevln.testing.chat import ChatLine, ScriptedChatModel
from spacevln.testing.dictation import DictatingExecutor, DictatingPlanner, Dictation
from spacevln.testing.flatland import Flatland
from spacevln.testing.reasoning import ExecutorConformance, PlannerConformance
from spacevln.testing.scripted import EventList, ScriptedExecutor, ScriptedPlanner, subtask_of

FLAT = Flatland().spec
CHAIN = (
    Anchor("living room", SpaceKind.ROOM, "sofa", CueKind.SOLID),
    Anchor("", SpaceKind.UNKNOWN, "doorway", CueKind.OPENING),
    Anchor("bedroom", SpaceKind.ROOM, "bed", CueKind.SOLID),
)


def by_feedback(context: PlannerContext) -> Subtask:
    last = context.last_subtask
    if last is None or context.feedback is None:
        return subtask_of(CHAIN, 0)
    return subtask_of(CHAIN, last.current_index + (context.feedback.end is StageEnd.ARRIVAL))


def ahead(context: ExecutorContext) -> Action:
    allowed = context.admissible
    return MoveForward(allowed.forward_m[-1]) if allowed.forward_m else TurnLeft() if allowed.left else Stop()


def planner_of(*script: ChatLine) -> tuple[ModelPlanner, ScriptedChatModel]:
    model = ScriptedChatModel(script)
    return ModelPlanner(model, PlannerPrompt(settings(), BODY)), model


def executor_of(*script: ChatLine) -> tuple[ModelExecutor, ScriptedChatModel]:
    model = ScriptedChatModel(script)
    return ModelExecutor(model, ExecutorPrompt(settings(), BODY)), model


def dictated(row: str = "full") -> tuple[DictatingPlanner, DictatingExecutor]:
    """The rules, speaking through a chat model."""
    options = settings(row, turn_steps=6)
    plans, acts = Dictation(), Dictation()
    planner = ModelPlanner(ScriptedChatModel([plans.say]), PlannerPrompt(options, FLAT))
    executor = ModelExecutor(ScriptedChatModel([acts.say]), ExecutorPrompt(options, FLAT))
    return (
        DictatingPlanner(RulePlanner(), planner, plans, options.planner_scot),
        DictatingExecutor(RuleExecutor(), executor, acts, options.executor_scot),
    )


class TestPlannerInWords(PlannerConformance):
    task = InstructionTask("Walk through the doorway and stop beside the bed.")

    def make_planner(self) -> DictatingPlanner:
        return dictated()[0]


class TestExecutorInWords(ExecutorConformance):
    def make_executor(self) -> DictatingExecutor:
        return dictated()[1]


def test_a_reply_that_cannot_be_read_is_asked_again_with_itself_and_the_reason() -> None:
    planner, model = planner_of("Go left.", {"a": 1}, REPLY)
    with pytest.raises(ReplyRejected) as first:
        planner.plan(later_call())
    with pytest.raises(ReplyRejected) as second:
        planner.plan(later_call(rejections=(first.value.reason,)))
    reasons = (first.value.reason, second.value.reason, "Direction 'x' is none of the views.")
    planner.plan(later_call(rejections=reasons))
    said = [(message.speaker, message.text) for message in model.requests[2].messages[2:]]
    assert [speaker for speaker, _ in said] == [Speaker.ASSISTANT, Speaker.USER] * 2
    assert said[0][1] == "Go left."
    assert reasons[0] in said[1][1]
    assert reasons[1] not in said[1][1]
    assert said[2][1] == '{"a": 1}'
    assert all(reason in said[3][1] for reason in reasons[1:])
    static = {request.messages[:2] for request in model.requests}
    assert len(static) == 1


def test_a_new_question_forgets_the_refused_replies() -> None:
    executor, model = executor_of("no", MOVE)
    with pytest.raises(ReplyRejected) as refusal:
        executor.act(query())
    executor.act(query(rejections=(refusal.value.reason,)))
    executor.act(query())
    assert [len(request.messages) for request in model.requests] == [2, 4, 2]


def test_a_reply_withheld_by_the_model_is_asked_again_with_the_reason_alone() -> None:
    executor, model = executor_of(ReplyRejected("truncated", "The reply was cut off."), MOVE)
    with pytest.raises(ReplyRejected):
        executor.act(query())
    executor.act(query(rejections=("The reply was cut off.",)))
    assert [message.speaker for message in model.requests[1].messages] == [Speaker.SYSTEM, Speaker.USER]
    assert "The reply was cut off." in model.requests[1].messages[1].text


def test_a_huge_refused_reply_is_not_sent_back_whole() -> None:
    planner, model = planner_of("x" * 1_000_000, REPLY)
    with pytest.raises(ReplyRejected):
        planner.plan(later_call())
    planner.plan(later_call(rejections=("No JSON object.",)))
    assert len(model.requests[1].messages[2].text) < 6100


def test_reset_forgets() -> None:
    planner, model = planner_of("no", REPLY)
    with pytest.raises(ReplyRejected):
        planner.plan(later_call())
    planner.reset()
    planner.plan(first_call(rejections=("From elsewhere.",)))
    assert [message.speaker for message in model.requests[1].messages] == [Speaker.SYSTEM, Speaker.USER]


def test_a_model_that_fails_for_good_is_let_pass() -> None:
    planner, _ = planner_of(ModelError("gone"))
    executor, _ = executor_of(ModelError("gone"))
    with pytest.raises(ModelError):
        planner.plan(first_call())
    with pytest.raises(ModelError):
        executor.act(query())


def test_the_look_around_of_a_model_detects_doorways() -> None:
    assert planner_of(REPLY)[0].lookaround_queries(InstructionTask("Go.")) == ("doorway",)


def run(planner: Any, executor: Any, limit: int = 80) -> tuple[EventList, Any]:
    sink = EventList()
    agent = NavigationAgent(Flatland(), LabelDetector(), planner, executor, AgentSettings(step_limit=limit), [sink])
    task = InstructionTask("Walk through the doorway and stop beside the bed.")
    return sink, agent.run(EpisodeSpec("words", "flatland", Pose(0.0, 0.0), task))


def kept(sink: EventList, *kinds: type) -> list[Any]:
    return [event for event in sink.events if isinstance(event, kinds)]


@pytest.mark.parametrize("row", ["full", pytest.param("-P-E", marks=pytest.mark.slow)])
def test_an_episode_in_words_is_the_episode_of_its_author(row: str) -> None:
    sink, result = run(*dictated(row))
    alone, expected = run(DictatingPlanner(RulePlanner()), DictatingExecutor(RuleExecutor()))
    assert [event.subtask for event in kept(sink, SubtaskIssued)] == [event.subtask for event in kept(alone, SubtaskIssued)]
    assert [event.action for event in kept(sink, StepTaken)] == [event.action for event in kept(alone, StepTaken)]
    assert (result.status, result.stop_reason, result.pose) == (expected.status, expected.stop_reason, expected.pose)
    assert kept(sink, ReplyRefused) == kept(alone, ReplyRefused)


def test_nonsense_leads_to_typed_rejections_and_a_controlled_end() -> None:
    planner = ModelPlanner(ScriptedChatModel(["Turn left.", "{}", '{"a": 1}', "[]"]), PlannerPrompt(settings(), FLAT))
    sink, result = run(planner, ScriptedExecutor())
    assert [event.kind for event in kept(sink, ReplyRefused)] == ["parse", "missing_field", "missing_field", "parse"]
    assert (result.status, result.stop_reason) == (EpisodeStatus.MODEL_FAILURE, StopReason.MODEL)
    assert [event.action for event in kept(sink, StepTaken)][-1] == Stop()


def test_a_nonsensical_executor_hands_the_stage_back() -> None:
    executor = ModelExecutor(ScriptedChatModel(["forward", '{"action": "fly"}']), ExecutorPrompt(settings("-E"), FLAT))
    sink, result = run(ScriptedPlanner([subtask_of((BENCH, SOFA), 0)]), executor)
    assert {event.kind for event in kept(sink, ReplyRefused)} == {"parse", "action"}
    assert {event.kind for event in kept(sink, FallbackUsed)} == {"executor_refused"}
    assert not kept(sink, DecisionMade)
    assert result.status is EpisodeStatus.STEP_LIMIT


def test_an_inadmissible_action_is_never_carried_out() -> None:
    """The model always wants the longest forward, also where an obstacle stands."""
    executor = ModelExecutor(ScriptedChatModel([{"action": "forward 1.25"}]), ExecutorPrompt(settings("-E"), FLAT))
    sink, result = run(ScriptedPlanner([subtask_of((BENCH, SOFA), 0, label) for label in ("front", "left 90")]), executor)
    assert "inadmissible" in {event.kind for event in kept(sink, ReplyRefused)}
    assert result.collisions == 0
    for event in kept(sink, DecisionMade):
        assert event.admissible.allows(event.action)


def test_a_premature_finish_is_refused_at_the_gate() -> None:
    claim = json.loads(json.dumps(REPLY)) | {"complete": True, "next_anchor": None, "direction": None, "instruction": ""}
    claim |= {"landmark": "", "chain": [anchor | {"status": "done"} for anchor in REPLY["chain"]]}
    start = REPLY | {"chain": [REPLY["chain"][0] | {"status": "here"}, *[a | {"status": "ahead"} for a in REPLY["chain"][1:]]]}
    start |= {"next_anchor": {"space": "hallway", "landmark": "brown bench"}, "landmark": "brown bench"}
    planner = ModelPlanner(ScriptedChatModel([claim, start, claim]), PlannerPrompt(settings(), FLAT))
    sink, result = run(planner, ScriptedExecutor())
    kinds = [event.kind for event in kept(sink, ReplyRefused)]
    assert kinds[0] == "first_finish"
    assert kinds[1:] == ["gate"] * 4
    assert result.status is EpisodeStatus.MODEL_FAILURE


FAULTS: tuple[Callable[[str], str], ...] = (
    lambda _: "",
    lambda _: "I would rather go left.",
    lambda text: text[: len(text) // 2],
    lambda text: f"```json\n{text}\n```",
    lambda text: f"Well: {text} - that is all.",
    lambda text: text.replace("{", "[", 1),
    lambda text: text.replace('"ahead"', '"done"'),
    lambda text: text.replace('"here"', '"ahead"'),
    lambda text: text.replace('"complete": false', '"complete": true'),
    lambda text: text.replace("front", "north"),
    lambda text: text.replace("forward", "fly"),
    lambda text: text.replace("0.25", "1.25").replace("0.50", "1.25"),
    lambda text: json.dumps({**json.loads(text), "extra": OBEY}),
    lambda text: json.dumps(dict.fromkeys(json.loads(text))),
    lambda text: "\ufffd" * 200 + text + " " * 10_000,
    lambda text: '{"a":' * 2000 + text,
)


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 40, 20))
def test_any_sequence_of_faulty_replies_ends_in_a_controlled_way(first: int) -> None:
    for seed in range(first, first + 20):
        rng = np.random.default_rng(seed)
        rate = float(rng.uniform(0.1, 0.9))

        def spoil(dictation: Dictation, rng: np.random.Generator = rng, rate: float = rate) -> Callable[[ChatRequest], str]:
            def say(request: ChatRequest) -> str:
                text = dictation.say(request)
                return FAULTS[rng.integers(len(FAULTS))](text) if rng.random() < rate else text

            return say

        options, plans, acts = settings("-P-E", turn_steps=6), Dictation(), Dictation()
        planner = ModelPlanner(ScriptedChatModel([spoil(plans)]), PlannerPrompt(options, FLAT))
        executor = ModelExecutor(ScriptedChatModel([spoil(acts)]), ExecutorPrompt(options, FLAT))
        minds = DictatingPlanner(ScriptedPlanner([by_feedback]), planner, plans, scot=False)
        sink, result = run(minds, DictatingExecutor(ScriptedExecutor([ahead]), executor, acts, scot=False), limit=40)
        assert result.status in (EpisodeStatus.STOPPED, EpisodeStatus.STEP_LIMIT, EpisodeStatus.MODEL_FAILURE)
        assert result.steps <= 40
        assert result.stopped
        assert all(event.admissible.allows(event.action) for event in kept(sink, DecisionMade))
        assert all(event.reason and event.kind for event in kept(sink, ReplyRefused))
