"""Replies: their fields and order, what they become, and why they are refused."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from typing import Any

import hypothesis
import pytest
from cot_situations import BENCH, BODY, CHAIN, DIRECT_REPLY, MOVE, REASONING, REPLY, ROBOT, SOFA, later_call, settings
from hypothesis import given
from hypothesis import strategies as st

from spacevln.control import ControlSettings, validate_subtask
from spacevln.core import (
    AnchorStatus,
    CueKind,
    MoveForward,
    ObjectGoalTask,
    ReplyRejected,
    SpaceKind,
    Stop,
    TurnLeft,
    TurnPurpose,
    TurnRight,
    Verdict,
)
from spacevln.reasoning.spatial_cot import ExecutorPrompt, PlannerPrompt
from spacevln.reasoning.spatial_cot.actions import action_choices, words_of
from spacevln.reasoning.spatial_cot.json_schema import executor_schema, planner_schema
from spacevln.reasoning.spatial_cot.parsing import parse_executor, parse_planner
from spacevln.testing.dictation import planner_words

VARIABLES = ("current_anchor", "chain", "next_anchor", "direction", "instruction", "landmark", "complete")
CHOICES = action_choices(BODY)
REMOVED = object()


def changed(path: str, value: Any, reply: dict[str, Any] = REPLY) -> str:
    """A reply with one value changed or removed; ``path`` as in ``chain.0.status``."""
    mended = copy.deepcopy(reply)
    *way, last = (int(step) if step.isdigit() else step for step in path.split("."))
    node: Any = mended
    for step in way:
        node = node[step]
    if value is REMOVED:
        del node[last]
    else:
        node[last] = value
    return json.dumps(mended)


def refusal_of(parse: Callable[[], object]) -> ReplyRejected | None:
    try:
        parse()
    except ReplyRejected as refusal:
        return refusal
    return None


def kind_of(text: str) -> str:
    with pytest.raises(ReplyRejected) as refusal:
        PlannerPrompt(settings(), BODY).parse(text, later_call())
    return refusal.value.kind


def test_a_model_reasons_before_it_decides() -> None:
    assert tuple(planner_schema(("front",), scot=True).schema["properties"]) == (*REASONING, *VARIABLES)
    assert tuple(planner_schema(("front",), scot=False).schema["properties"]) == ("verdict", *VARIABLES)
    assert tuple(executor_schema(tuple(CHOICES), scot=True).schema["properties"]) == ("view", "detection", "progress", "action")
    action = executor_schema(tuple(CHOICES), scot=True).schema["properties"]["action"]
    assert tuple(action["properties"]) == ("reasoning", "choice")
    assert tuple(executor_schema(tuple(CHOICES), scot=False).schema["properties"]) == ("action",)


def test_schemas_are_plain_enough_for_every_constrained_decoder() -> None:
    def walk(node: Any) -> None:
        assert set(node) <= {"type", "properties", "required", "additionalProperties", "items", "anyOf", "enum"}
        if node.get("type") == "object":
            assert node["additionalProperties"] is False
            assert node["required"] == list(node["properties"])
        for child in (
            *node.get("properties", {}).values(),
            *node.get("anyOf", ()),
            *([node["items"]] if "items" in node else ()),
        ):
            walk(child)

    for scot in (True, False):
        walk(planner_schema(("front", "back"), scot=scot).schema)
        walk(executor_schema(tuple(CHOICES), scot=scot).schema)


def test_a_planner_reply_becomes_stage_variables() -> None:
    reply = parse_planner(json.dumps(REPLY), scot=True, first=False)
    subtask = reply.subtask
    assert subtask.chain == CHAIN
    assert (subtask.current_index, subtask.next_anchor, subtask.complete) == (1, SOFA, False)
    assert [subtask.status(i) for i in range(3)] == [AnchorStatus.VERIFIED, AnchorStatus.CURRENT, AnchorStatus.PENDING]
    assert subtask.current_anchor.space_kind is SpaceKind.CONNECTOR
    assert subtask.current_anchor.cue == "brown bench / picture"
    assert (subtask.direction, subtask.landmark, subtask.verdict) == ("front", "white sofa", Verdict.COMPLETED)
    assert subtask.target_m is None
    assert reply.thought.progress == "The doorway was passed."
    assert reply.fallbacks == ()
    assert validate_subtask(reply, later_call(), ControlSettings()) == []


def test_without_spatial_cot_the_same_stage_variables_come_without_reasoning() -> None:
    full = parse_planner(json.dumps(REPLY), scot=True, first=False)
    direct = parse_planner(json.dumps(DIRECT_REPLY), scot=False, first=False)
    assert direct.subtask == full.subtask
    assert direct.thought.observation == ""


def test_words_and_replies_are_each_others_inverse() -> None:
    reply = parse_planner(json.dumps(REPLY), scot=True, first=False)
    assert planner_words(reply) == REPLY
    assert planner_words(reply, scot=False) == DIRECT_REPLY


def test_a_complete_task() -> None:
    text = json.dumps(
        REPLY
        | {
            "chain": [anchor | {"status": "done"} for anchor in REPLY["chain"]],
            "next_anchor": None,
            "direction": None,
            "instruction": "",
            "landmark": "",
            "complete": True,
        }
    )
    subtask = PlannerPrompt(settings(), BODY).parse(text, later_call()).subtask
    assert (subtask.complete, subtask.current_index, subtask.next_anchor) == (True, 2, None)


def test_before_any_anchor_is_verified() -> None:
    chain = [anchor | {"status": "ahead"} for anchor in REPLY["chain"]]
    reply = parse_planner(json.dumps(REPLY | {"chain": chain}), scot=True, first=True)
    assert reply.subtask.current_index == -1
    assert reply.subtask.verdict is Verdict.FIRST


def test_kinds_of_cues_follow_from_their_words() -> None:
    chain = [dict(REPLY["chain"][0], landmark=cue) for cue in ("doorway", "stairs", "", "lamp")]
    reply = parse_planner(json.dumps(REPLY | {"chain": chain}), scot=True, first=False)
    assert [a.cue_kind for a in reply.subtask.chain] == [CueKind.OPENING, CueKind.STAIRS, CueKind.NONE, CueKind.SOLID]


@pytest.mark.parametrize(
    ("path", "value", "kind"),
    [
        ("direction", REMOVED, "missing_field"),
        ("observation", REMOVED, "missing_field"),
        ("progress.verdict", REMOVED, "missing_field"),
        ("chain.1.status", REMOVED, "missing_field"),
        ("action", "forward 0.25", "unknown_field"),
        ("complete", "false", "wrong_type"),
        ("complete", 0, "wrong_type"),
        ("chain", "bedroom, hallway", "wrong_type"),
        ("chain", {"0": "bedroom"}, "wrong_type"),
        ("instruction", None, "wrong_type"),
        ("next_anchor", "white sofa", "wrong_type"),
        ("observation", ["hallway"], "wrong_type"),
        ("progress.verdict", "done", "wrong_value"),
        ("chain.0.kind", "corridor", "wrong_value"),
        ("chain.0.status", "VERIFIED", "wrong_value"),
        ("landmark", "x" * 81, "too_long"),
        ("instruction", "x" * 601, "too_long"),
        ("chain", [], "chain"),
        ("chain.0.status", "ahead", "chain_order"),
        ("chain.0.status", "here", "chain_order"),
        ("chain", [REPLY["chain"][1], REPLY["chain"][0], REPLY["chain"][2]], "chain_order"),
        ("progress.verdict", "first", "verdict"),
        ("direction", "north", "direction"),
        ("direction", "IMAGE 3", "direction"),
        ("direction", None, "direction"),
    ],
)
def test_what_does_not_fit_is_refused_by_its_class(path: str, value: Any, kind: str) -> None:
    assert kind_of(changed(path, value)) == kind


def chain_of(*statuses: str) -> list[dict[str, Any]]:
    return [anchor | {"status": status} for anchor, status in zip(REPLY["chain"], statuses, strict=True)]


def said(verdict: str, chain: list[dict[str, Any]], next_anchor: int | None) -> str:
    """A later reply; the last stage headed for the second anchor, by the brown bench."""
    target = None if next_anchor is None else {name: chain[next_anchor][name] for name in ("space", "landmark")}
    rest = {"next_anchor": target, "landmark": "" if target is None else target["landmark"], "complete": target is None}
    return json.dumps(REPLY | {"progress": {"reasoning": "So.", "verdict": verdict}, "chain": chain} | rest)


@pytest.mark.parametrize(
    ("text", "agree"),
    [
        (said("completed", chain_of("done", "here", "ahead"), 2), True),
        (said("completed", chain_of("here", "ahead", "ahead"), 1), False),
        (said("completed", [chain_of("here", "", "")[0], *chain_of("", "", "ahead")[2:]], 1), False),
        (said("completed", chain_of("done", "done", "here"), None), True),
        (said("continue", chain_of("here", "ahead", "ahead"), 1), True),
        (said("continue", chain_of("done", "here", "ahead"), 2), False),
        (said("continue", chain_of("done", "done", "here"), None), False),
        (said("continue", [chain_of("here", "", "")[0], *chain_of("", "", "ahead")[2:]], 1), True),
        (said("transition", chain_of("here", "ahead", "ahead"), 1), False),
        (said("transition", [chain_of("here", "", "")[0], *chain_of("", "", "ahead")[2:]], 1), True),
        (said("transition", chain_of("done", "here", "ahead"), 2), True),
    ],
)
def test_a_verdict_agrees_with_the_chain_of_its_reply(text: str, agree: bool) -> None:
    refusal = refusal_of(lambda: PlannerPrompt(settings(), BODY).parse(text, later_call()))
    assert (refusal is None) == agree
    if refusal is not None:
        assert refusal.kind == "verdict"
        assert json.loads(text)["progress"]["verdict"] in refusal.reason


def test_a_place_to_search_may_leave_the_chain_once_it_was_reached() -> None:
    text = said("completed", [chain_of("here", "", "")[0], *chain_of("", "", "ahead")[2:]], 1)
    task = ObjectGoalTask("white sofa")
    assert PlannerPrompt(settings(), BODY).parse(text, later_call(task=task)).subtask.current_index == 0


@pytest.mark.parametrize("wrong", [REPLY, REPLY | {"complete": "no"}, REPLY | {"direction": "north"}])
def test_what_was_let_pass_is_counted_whether_the_reply_is_used_or_not(wrong: dict[str, Any]) -> None:
    text = f"I think {json.dumps(wrong)} is best."
    prompt = PlannerPrompt(settings(), BODY)
    refusal = refusal_of(lambda: prompt.parse(text, later_call()))
    told = prompt.parse(text, later_call()).fallbacks if refusal is None else refusal.fallbacks
    assert told == ("reply_prose",)


@pytest.mark.parametrize("text", ["", "Turn left.", '{"a": 1', "[1]", '{"a": 1} {"b": 2}', "\ufffd\ufffd", "{" * 5000])
def test_what_is_no_json_object_is_refused(text: str) -> None:
    assert kind_of(text) == "parse"


def test_the_reason_names_field_and_value() -> None:
    with pytest.raises(ReplyRejected, match=r"'chain\.0\.kind' is 'corridor'.*'room', 'connector'"):
        parse_planner(changed("chain.0.kind", "corridor"), scot=True, first=False)
    with pytest.raises(ReplyRejected, match=r"^Field 'direction' is missing\. Write exactly"):
        parse_planner(changed("direction", REMOVED), scot=True, first=False)


def test_a_reason_never_grows_with_the_reply() -> None:
    many = {f"field_{index}": "x" * 1000 for index in range(500)}
    with pytest.raises(ReplyRejected) as refusal:
        parse_planner(json.dumps(REPLY | many), scot=True, first=False)
    assert len(refusal.value.reason) < 800


@pytest.mark.parametrize(
    ("change", "kind"),
    [
        ({"next_anchor": {"space": "kitchen", "landmark": "stove"}}, "next_anchor"),
        ({"next_anchor": None}, "completion"),
        ({"complete": True}, "completion"),
        ({"direction": "left 60"}, "not_traversable"),
        ({"landmark": "none"}, "placeholder"),
        ({"instruction": "Go to {landmark}."}, "placeholder"),
        ({"instruction": ""}, "instruction"),
        ({"landmark": ""}, "landmark"),
    ],
)
def test_what_is_not_possible_here_is_refused_by_its_class(change: dict[str, Any], kind: str) -> None:
    context = later_call()
    reply = parse_planner(json.dumps(REPLY | change), scot=True, first=False)
    assert kind in [rejection.kind for rejection in validate_subtask(reply, context, ControlSettings())]


def test_verified_anchors_keep_their_place() -> None:
    swapped = [
        dict(REPLY["chain"][1], status="done"),
        dict(REPLY["chain"][0], status="here"),
        REPLY["chain"][2],
    ]
    reply = parse_planner(json.dumps(REPLY | {"chain": swapped}), scot=True, first=False)
    assert [r.kind for r in validate_subtask(reply, later_call(), ControlSettings())] == ["verified_moved"]


def test_unverified_anchors_may_be_refined() -> None:
    bench = dict(REPLY["chain"][1], space="corridor", status="ahead")
    chain = [dict(REPLY["chain"][0], status="here"), bench, REPLY["chain"][2]]
    change = {"chain": chain, "next_anchor": {"space": "corridor", "landmark": "brown bench"}, "landmark": "brown bench"}
    reply = parse_planner(json.dumps(REPLY | change), scot=True, first=False)
    assert validate_subtask(reply, later_call(), ControlSettings()) == []
    assert reply.subtask.next_anchor is not None
    assert reply.subtask.next_anchor.space_kind is BENCH.space_kind


@pytest.mark.parametrize("wrapped", ["```json\n{}\n```", "Here it is: {} I hope it helps."])
def test_json_among_other_words_is_used_and_counted(wrapped: str) -> None:
    plan = parse_planner(wrapped.replace("{}", json.dumps(REPLY)), scot=True, first=False)
    act = parse_executor(wrapped.replace("{}", json.dumps(MOVE)), CHOICES, scot=True)
    assert plan.fallbacks == act.fallbacks == (("reply_fenced",) if "`" in wrapped else ("reply_prose",))


@pytest.mark.parametrize(
    ("words", "action", "purpose"),
    [
        ("forward 0.25", MoveForward(0.25), None),
        ("forward 1.25", MoveForward(1.25), None),
        ("left 30 align", TurnLeft(30.0), TurnPurpose.ALIGN),
        ("right 30 avoid", TurnRight(30.0), TurnPurpose.AVOID),
        (" Left  30 ALIGN ", TurnLeft(30.0), TurnPurpose.ALIGN),
        ("stop", Stop(), None),
    ],
)
def test_an_executor_reply_becomes_an_action(words: str, action: object, purpose: TurnPurpose | None) -> None:
    reply = parse_executor(changed("action.choice", words, MOVE), CHOICES, scot=True)
    assert (reply.action, reply.purpose, reply.thought.action) == (action, purpose, "Free ahead.")
    assert parse_executor(json.dumps({"action": words}), CHOICES, scot=False).action == action


@pytest.mark.parametrize("words", ["forward 3.00", "forward", "backward 0.25", "left 30", "left 60 align", "turn left 30", ""])
def test_an_unknown_action_is_refused_with_all_known_ones(words: str) -> None:
    with pytest.raises(ReplyRejected, match=r"choose one of forward 0\.25, .*, stop\.") as refusal:
        ExecutorPrompt(settings(), BODY).parse(changed("action.choice", words, MOVE))
    assert refusal.value.kind == "action"


def test_choices_follow_from_the_body() -> None:
    assert list(action_choices(BODY))[:6] == [f"forward {k / 4:.2f}" for k in range(1, 6)] + ["left 30 align"]
    assert "left 45 align" in action_choices(ROBOT)
    assert {"left 30 align", "left 60 align", "left 90 avoid"} <= set(action_choices(BODY, turn_steps=3))
    assert all(words_of(*choice) == words for words, choice in action_choices(BODY, 6).items())


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.sampled_from([*REPLY, *MOVE, "verdict"]), inner, max_size=8),
    max_leaves=20,
)


@hypothesis.settings(max_examples=40)
@given(st.one_of(st.text(max_size=200), JSON.map(json.dumps), st.dictionaries(st.sampled_from(list(REPLY)), JSON).map(
    lambda part: json.dumps(REPLY | part)
)))  # fmt: skip
def test_no_reply_does_anything_but_fit_or_be_refused(text: str) -> None:
    for scot in (True, False):
        refusals = (
            refusal_of(lambda scot=scot: parse_planner(text, scot=scot, first=False)),
            refusal_of(lambda scot=scot: parse_executor(text, CHOICES, scot=scot)),
        )
        assert all(refusal is None or refusal.reason[0].isupper() for refusal in refusals)
