"""What the command line says about models."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from spacevln.assembly import ModelPair
from spacevln.cli.app import cli
from spacevln.cli.costs import usage_line
from spacevln.cli.doctor_models import keys, model_findings
from spacevln.cli.model_options import models_from
from spacevln.core import ReplyMode, Usage, UsageError
from spacevln.models import HourlyPrice, TokenPrice
from spacevln.recording import CallUsage
from spacevln.testing.chat_server import Refuse, Say, ScriptedServer, closed_url

DEFAULTS: dict[str, Any] = {
    "model": None,
    "executor_model": None,
    "base_url": None,
    "thinking": "0",
    "temperature": 0.1,
    "price": None,
    "usd_per_hour": None,
}


def chosen(**options: Any) -> ModelPair:
    pair = models_from(DEFAULTS | options)
    assert pair is not None
    return pair


def test_planner_and_executor_may_be_different_models() -> None:
    pair = chosen(model="ollama:big", executor_model="ollama:small")
    assert (str(pair.planner), str(pair.executor)) == ("ollama:big", "ollama:small")
    assert models_from(DEFAULTS) is None


def test_options_reach_the_choice() -> None:
    pair = chosen(model="vllm:m", thinking="512", price="0.4/2.4/0.04", temperature=0.0)
    assert pair.planner.thinking == 512
    assert pair.planner.price == TokenPrice(input=0.4, output=2.4, cached=0.04)
    assert pair.executor.temperature == 0.0
    assert chosen(model="vllm:m", thinking="default").planner.thinking is None
    assert chosen(model="vllm:m", usd_per_hour=2.0).planner.price == HourlyPrice(usd_per_hour=2.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--base-url", "http://h/v1"], "--base-url needs --model"),
        (["--planner", "vlm"], "needs --model"),
        (["--planner", "rules", "--model", "vllm:m"], "nobody asks it"),
        (["--model", "vllm:m", "--thinking", "much"], "no number of tokens"),
        (["--model", "vllm:m", "--price", "cheap"], "is no price"),
        (["--model", "vllm:m", "--price", "1/2", "--usd-per-hour", "3"], "exclude each other"),
        (["--model", "gpt-unknown"], "says no provider"),
        (["--model", "dashscop:m"], "Did you mean 'dashscope'"),
    ],
)
def test_a_wrong_option_is_one_sentence(arguments: list[str], words: str, tmp_path: Path) -> None:
    result = CliRunner().invoke(cli, ["run", *arguments, "--out", str(tmp_path)])
    assert result.exit_code != 0
    assert words in (result.output if result.exit_code == 2 else str(result.exception))


def test_a_dry_run_tells_calls_tokens_and_cost_and_writes_nothing(tmp_path: Path) -> None:
    out = tmp_path / "out"
    arguments = ["houses-vln", "--episodes", "50", "--workers", "2", "--model", "paper-qwen3.5", "--dry-run", "--out", str(out)]
    result = CliRunner().invoke(cli, ["bench", *arguments], standalone_mode=False)
    assert "50 to run of 50, 2 at a time" in result.output
    assert "385 calls to dashscope-cn:qwen3.5-plus" in result.output
    assert "USD" in result.output
    assert "hours" in result.output
    assert not out.exists()


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_doctor_tells_what_a_model_can_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPACEVLN_CACHE_DIR", str(tmp_path))
    with ScriptedServer([Say({"colour": "red"})], modes=[ReplyMode.JSON_OBJECT, ReplyMode.TEXT], models=("m",)) as server:
        findings = list(model_findings(DEFAULTS | {"model": "m", "base_url": server.url, "price": "1/2"}))
    assert {finding.state for finding in findings} == {"ok"}
    told = "\n".join(finding.what for finding in findings)
    assert "reply shape: json_object" in told
    assert "sees pictures" in told
    assert "1 in, 2 out USD" in told
    assert json.loads((tmp_path / "reply-modes.json").read_text()) == {f"{server.url} m": "json_object"}


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_doctor_tells_what_is_wrong_and_how_to_mend_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SPACEVLN_CACHE_DIR", str(tmp_path))
    url = closed_url()
    dead = next(model_findings(DEFAULTS | {"model": "m", "base_url": url}))
    assert (dead.state, dead.mend) == ("missing", f"start the server at {url}, or give another --base-url")
    with ScriptedServer([Refuse(401, "bad key")]) as server:
        refused = next(model_findings(DEFAULTS | {"model": "m", "base_url": server.url}))
    assert refused.mend == "check the key in SPACEVLN_API_KEY"
    with ScriptedServer([Say({"colour": "blue"})], models=("other",)) as server:
        notes = [f.what for f in model_findings(DEFAULTS | {"model": "m", "base_url": server.url}) if f.state == "note"]
    assert any("does not see pictures" in note for note in notes)
    assert any("the server lists other models: other" in note for note in notes)


def test_keys_are_named_and_never_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MOONSHOT_API_KEY", "sk-planted")
    (finding,) = keys()
    assert "MOONSHOT_API_KEY" in finding.what
    assert "sk-planted" not in finding.what


def test_one_line_of_costs() -> None:
    usage = {"planner": CallUsage(calls=2, tokens=Usage(1000, 400, 0, 50), latency_s=5.0, usd=0.01, unpriced=1)}
    expected = "models   2 planner calls of 2.5 s, 1,000 tokens in (40 % cached), 50 out, 0.0100 USD, 1 of unknown price"
    assert usage_line(usage) == expected


def test_a_price_without_a_model_is_refused() -> None:
    with pytest.raises(UsageError, match="--price needs --model"):
        models_from(DEFAULTS | {"price": "1/2"})
