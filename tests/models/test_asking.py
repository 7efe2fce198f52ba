"""What is sent for a request: dialects, reply shapes, prices, keys."""

from __future__ import annotations

import copy
import json
import pickle
import traceback
from pathlib import Path
from typing import Any

import pytest
from chatting import GOOD, JPEG, SCHEMA, asking, request
from hypothesis import given
from hypothesis import strategies as st

from spacevln.core import ChatRequest, ModelError, PrerequisiteError, ReplyMode, Role, UnknownNameError, Usage, UsageError
from spacevln.models import HourlyPrice, ModelChoice, ModelDesk, RunAccess, Secret, TokenPrice, choose, pairs, price_of, profiles
from spacevln.models.dialect import request_body, strict_schema
from spacevln.models.modes import ModeMemory
from spacevln.models.prices import list_price, table
from spacevln.models.profiles import profile
from spacevln.testing.chat_server import Refuse, Say, ScriptedServer

pytestmark = pytest.mark.allow_hosts(["127.0.0.1"])
KEY = "sk-planted-4711-very-secret"


def body(name: str, mode: ReplyMode = ReplyMode.JSON_SCHEMA, asked: ChatRequest | None = None, **choice: Any) -> dict[str, Any]:
    return request_body(asked or request(), ModelChoice(profile=name, model="m", **choice), profile(name), mode)


@pytest.mark.parametrize("name", sorted(profiles()))
@pytest.mark.parametrize("mode", ReplyMode)
def test_every_profile_sends_a_request_that_is_plain_json_and_always_the_same(name: str, mode: ReplyMode) -> None:
    first, second = json.dumps(body(name, mode)), json.dumps(body(name, mode))
    assert first == second
    assert "data:image/jpeg;base64,/9j/" in first
    assert ("response_format" in first) == (mode is not ReplyMode.TEXT)


def test_only_an_explicit_cache_gets_a_marker_at_the_end_of_the_static_prefix() -> None:
    marked = body("dashscope")["messages"]
    assert marked[0]["content"][-1]["cache_control"] == {"type": "ephemeral"}
    assert "cache_control" not in json.dumps(marked[1])
    assert "cache_control" not in json.dumps(body("openai"))


def test_the_static_prefix_is_the_same_bytes_in_every_call_of_a_mode() -> None:
    for mode in ReplyMode:
        first, second = body("dashscope", mode)["messages"], body("dashscope", mode, request("Elsewhere?"))["messages"]
        assert json.dumps(first[0]) == json.dumps(second[0])
        assert first[1] != second[1]


def test_a_server_without_schemas_is_told_the_schema_in_words() -> None:
    for mode in (ReplyMode.JSON_OBJECT, ReplyMode.TEXT):
        words = body("openai-compatible", mode)["messages"][0]["content"]
        assert "JSON" in words
        assert json.dumps(SCHEMA.schema) in words
    assert "Schema" not in json.dumps(body("openai-compatible")["messages"])


@pytest.mark.parametrize(
    ("name", "off", "budgeted"),
    [
        ("dashscope", {"enable_thinking": False}, {"enable_thinking": True, "thinking_budget": 512}),
        ("vllm", {"chat_template_kwargs": {"enable_thinking": False}}, {"chat_template_kwargs": {"enable_thinking": True}}),
        ("moonshot", {"thinking": {"type": "disabled"}}, {"thinking": {"type": "enabled"}}),
        ("mimo", {"thinking": {"type": "disabled"}}, {"thinking": {"type": "enabled"}}),
        ("openrouter", {"reasoning": {"enabled": False}}, {"reasoning": {"max_tokens": 512}}),
        ("ollama", {"reasoning_effort": "none"}, {"reasoning_effort": "low"}),
    ],
)
def test_thinking_is_switched_off_or_budgeted_in_each_providers_way(
    name: str, off: dict[str, Any], budgeted: dict[str, Any]
) -> None:
    assert off.items() <= body(name).items()
    thinking = body(name, thinking=512)
    assert budgeted.items() <= thinking.items()
    assert thinking[profile(name).limit_field] == request().max_tokens + 512
    assert not set(off) & set(body(name, thinking=None))


def test_temperature_and_seed_are_sent_where_they_are_taken() -> None:
    assert body("vllm", seed=3)["temperature"] == 0.1
    assert body("vllm", seed=3)["seed"] == 3
    assert "temperature" not in body("moonshot")
    assert "temperature" not in body("vllm", temperature=None)


def test_a_strict_schema_is_closed_and_keeps_the_order_of_its_fields() -> None:
    loose = {
        "title": "T",
        "type": "object",
        "properties": {"title": {"type": "string", "default": "x"}, "a": {"anyOf": [{"$ref": "#/$defs/A"}, {"type": "null"}]}},
        "$defs": {"A": {"type": "object", "properties": {"b": {"type": "integer", "title": "B"}}}},
    }
    strict = strict_schema(loose)
    assert strict["required"] == ["title", "a"] == list(strict["properties"])
    assert strict["additionalProperties"] is False
    assert strict["properties"]["title"] == {"type": "string"}
    assert strict["$defs"]["A"] == {
        "type": "object",
        "properties": {"b": {"type": "integer"}},
        "required": ["b"],
        "additionalProperties": False,
    }
    assert "title" not in {key for key in strict if key != "properties"}


@pytest.mark.parametrize("offered", [list(ReplyMode), [ReplyMode.JSON_OBJECT, ReplyMode.TEXT], [ReplyMode.TEXT]])
def test_the_strictest_shape_is_found_out_once_and_remembered(offered: list[ReplyMode], tmp_path: Path) -> None:
    with ScriptedServer([Say(GOOD)], modes=offered) as server:
        with asking(server.url, tmp_path) as setting:
            assert {setting.planner.complete(request()).mode for _ in range(2)} == {offered[0]}
        refusals = len(ReplyMode) - len(offered)
        assert len(server.bodies) == 2 + refusals
        with asking(server.url, tmp_path) as again:  # another process: the file tells it
            assert again.planner.complete(request()).mode is offered[0]
        assert len(server.bodies) == 3 + refusals


def test_a_server_that_lost_a_shape_is_stepped_down_again(tmp_path: Path) -> None:
    with ScriptedServer([Say(GOOD)], modes=[ReplyMode.TEXT]) as server:
        ModeMemory(tmp_path / "modes.json").remember(server.url, "scripted", ReplyMode.JSON_SCHEMA)
        with asking(server.url, tmp_path) as setting:
            assert setting.planner.complete(request()).mode is ReplyMode.TEXT


def test_a_refusal_for_another_reason_is_told_as_it_is(tmp_path: Path) -> None:
    with (
        ScriptedServer([Refuse(400, "image too large")]) as server,
        asking(server.url, tmp_path) as setting,
        pytest.raises(ModelError, match="image too large"),
    ):
        setting.planner.complete(request())


def test_a_damaged_memory_of_shapes_is_no_obstacle(tmp_path: Path) -> None:
    (tmp_path / "modes.json").write_text("[1, 2")
    memory = ModeMemory(tmp_path / "modes.json")
    assert memory.recall("u", "m") is None
    memory.remember("u", "m", ReplyMode.TEXT)
    assert ModeMemory(tmp_path / "modes.json").recall("u", "m") is ReplyMode.TEXT


def test_thoughts_and_usage_of_every_dialect_are_read(tmp_path: Path) -> None:
    usage = {
        "prompt_tokens": 900,
        "completion_tokens": 70,
        "prompt_tokens_details": {"cached_tokens": 300, "cache_creation_input_tokens": 200},
        "completion_tokens_details": {"reasoning_tokens": 50},
    }
    say = Say(GOOD, usage=usage, message={"reasoning_content": "Let me see."})
    price = TokenPrice(input=1.0, output=10.0, cached=0.1, cache_write=2.0)
    with ScriptedServer([say]) as server, asking(server.url, tmp_path, price=price) as setting:
        reply = setting.planner.complete(request())
        assert setting.desk.ledger.spent_usd == pytest.approx(reply.usd)
    assert reply.thought == "Let me see."
    assert reply.usage == Usage(900, 300, 200, 70, 50)
    assert reply.usd == pytest.approx((400 * 1.0 + 300 * 0.1 + 200 * 2.0 + 70 * 10.0) / 1e6)


def test_a_server_that_tells_no_usage_costs_nobody_knows_what(tmp_path: Path) -> None:
    with ScriptedServer([Say(GOOD, usage=None)]) as server, asking(server.url, tmp_path) as setting:
        reply = setting.planner.complete(request())
    assert (reply.usage, reply.usd) == (Usage(), None)


# prices


def test_the_table_prices_every_hosted_model_of_the_papers_pairs() -> None:
    for pair in pairs():
        for choice in choose(pair).values():
            assert choice.profile == "vllm" or price_of(choice) is not None, choice


def test_every_row_tells_when_and_where_it_was_read() -> None:
    for row in table():
        assert len(row.seen) == 10
        assert row.source
        assert row.profile in profiles()


@given(st.integers(0, 300_000), st.integers(0, 5_000))
def test_a_larger_input_never_costs_less(tokens: int, output: int) -> None:
    price = list_price("dashscope-cn", "qwen3.5-plus")
    assert price is not None
    assert price.usd(Usage(tokens, 0, 0, output), 1.0) <= price.usd(Usage(tokens + 1000, 0, 0, output), 1.0)


def test_the_tier_is_chosen_by_the_input_of_the_call() -> None:
    price = list_price("dashscope-cn", "qwen3.5-plus")
    assert price is not None
    assert price.usd(Usage(200_000), 0) / price.usd(Usage(100_000), 0) == pytest.approx(2 * 2.0 / 0.8)
    assert price.usd(Usage(1_000_000), 0) > 0  # beyond the last row: its price


def test_an_own_server_costs_by_the_hour() -> None:
    assert HourlyPrice(usd_per_hour=3.6, parallel=4).usd(Usage(), 10.0) == pytest.approx(0.0025)


# choosing


def test_a_pair_of_the_paper_has_two_models() -> None:
    chosen = choose("paper-qwen3.5")
    assert str(chosen[Role.PLANNER]) == "dashscope-cn:qwen3.5-plus"
    assert str(chosen[Role.EXECUTOR]) == "dashscope-cn:qwen3.5-flash"
    assert len(pairs()) == 5


@pytest.mark.parametrize(
    ("name", "url", "expected"),
    [
        ("qwen3.5-plus", None, "dashscope:qwen3.5-plus"),
        ("ollama:qwen3-vl:8b", None, "ollama:qwen3-vl:8b"),
        ("qwen3-vl:8b", "http://h/v1", "openai-compatible:qwen3-vl:8b"),
        ("Qwen/Q", "http://h/v1", "openai-compatible:Qwen/Q"),
        ("vllm:Qwen/Q", "http://h/v1", "vllm:Qwen/Q"),
        ("relay:/tmp/talk", None, "relay:/tmp/talk"),
    ],
)
def test_names_of_models(name: str, url: str | None, expected: str) -> None:
    chosen = choose(name, url)[Role.PLANNER]
    assert str(chosen) == expected
    assert url is None or chosen.url == url


@pytest.mark.parametrize("name", ["gpt-unknown", "relay:", "openai-compatible:m"])
def test_a_name_that_says_no_server_is_refused(name: str) -> None:
    with pytest.raises(UsageError, match="--model"):
        choose(name)


def test_an_unknown_provider_is_met_with_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="dashscope"):
        choose("dashscop:qwen")


# keys


def test_a_secret_shows_itself_nowhere() -> None:
    secret = Secret(KEY)
    for shown in (repr(secret), str(secret), f"{secret}", f"{secret:>40}", repr([secret]), repr({"k": secret})):
        assert KEY not in shown
    assert secret.reveal() == KEY
    assert secret.scrub(f"bad key {KEY}!") == "bad key ***!"
    assert secret == Secret(KEY) != Secret("other")
    for leak in (pickle.dumps, copy.deepcopy):
        with pytest.raises(TypeError, match="never pickled"):
            leak(secret)


def test_a_missing_key_names_the_variable(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("DASHSCOPE_API_KEY", raising=False)
    with pytest.raises(PrerequisiteError, match="export DASHSCOPE_API_KEY="):
        ModelDesk(choose("qwen3.5-plus"))


def test_a_key_that_a_server_repeats_is_masked(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("SPACEVLN_API_KEY", KEY)
    with ScriptedServer([Refuse(401, f"Incorrect API key provided: {KEY}")]) as server:
        with asking(server.url, tmp_path) as setting, pytest.raises(ModelError) as error:
            setting.planner.complete(request())
        assert server.headers[0]["authorization"] == f"Bearer {KEY}"
    assert KEY not in str(error.value)
    assert "***" in str(error.value)
    shown = "".join(traceback.format_exception(error.value)) + repr(setting.heard.events) + repr(setting)
    assert KEY not in shown


def test_a_key_of_another_provider_is_never_sent(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("SPACEVLN_API_KEY", raising=False)
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    with ScriptedServer([Say(GOOD)]) as server, asking(server.url, tmp_path) as setting:
        setting.planner.complete(request())
    assert KEY not in json.dumps(server.headers)


def test_a_spending_limit_needs_a_price(tmp_path: Path) -> None:
    chosen = {role: ModelChoice(profile="vllm", model="m") for role in Role}
    with pytest.raises(UsageError, match="--max-usd needs a price"):
        ModelDesk(chosen, RunAccess(max_usd=1.0), memory=ModeMemory(tmp_path / "modes.json"))


def test_pictures_travel_as_they_are() -> None:
    import base64

    (picture,) = [part for part in body("vllm")["messages"][1]["content"] if part["type"] == "image_url"]
    assert base64.b64decode(picture["image_url"]["url"].partition("base64,")[2]) == JPEG
