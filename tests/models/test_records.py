"""Episodes in a house through the runner's own session: keys stay out, replays reach the same actions, forecasts learn."""

from __future__ import annotations

import itertools
import json
import re
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from spacevln.assembly import Configuration, ModelPair
from spacevln.cli.app import cli
from spacevln.core import Role, UsageError
from spacevln.evaluation.attempt import Session
from spacevln.evaluation.forecast import forecast, known_averages, recorded_averages
from spacevln.evaluation.houses import pick_episode
from spacevln.evaluation.replay import find_episode, replay
from spacevln.evaluation.summary import summarise
from spacevln.models import ModelChoice, RetrySettings, RunAccess
from spacevln.recording import RecordLevel, RunFile, episode_directory, read_events, write_file
from spacevln.testing.chat_server import Refuse, Say, ScriptedServer, Turn

pytestmark = pytest.mark.allow_hosts(["127.0.0.1"])
KEY = "sk-planted-0815-in-the-environment"


class Wanderer:
    """Plausible replies without eyes, and now and then a fault whose message repeats the key."""

    def __init__(self) -> None:
        self.count = itertools.count()

    def __call__(self, body: dict[str, Any]) -> Turn:
        number = next(self.count)
        if number % 7 == 3:
            return Refuse(503, f"worker of {KEY} is busy")
        schema = body["response_format"]["json_schema"]["schema"]
        asked = json.dumps(body["messages"][-1]["content"])
        return Say(self.act(asked, number) if "action" in schema["properties"] else self.plan(schema, number))

    def plan(self, schema: dict[str, Any], number: int) -> dict[str, Any]:
        places = [{"space": "hallway", "landmark": ""}, {"space": "kitchen", "landmark": "table"}]
        directions = [label for label in json.dumps(schema).split('"') if re.fullmatch(r"front|back|left \d+|right \d+", label)]
        return {
            "observation": "A room.",
            "memory": "Nothing yet.",
            "progress": {"reasoning": "Not there.", "verdict": "continue"},
            "decision": "Onward.",
            "plan": "Through.",
            "current_anchor": places[0],
            "chain": [
                {**places[0], "kind": "connector", "status": "here"},
                {**places[1], "kind": "room", "status": "ahead"},
            ],
            "next_anchor": places[1],
            "direction": directions[number % len(directions)],
            "instruction": "Walk on.",
            "landmark": "table",
            "complete": False,
        }

    def act(self, asked: str, number: int) -> dict[str, Any]:
        forwards = re.findall(r"forward \d\.\d\d", asked)
        words = forwards[0] if forwards and number % 3 else "left 30 avoid"
        return {"view": "", "detection": "", "progress": "", "action": {"reasoning": "", "choice": words}}


def run_file(configuration: Configuration) -> RunFile:
    return RunFile(
        version="test",
        suite="run vln 7",
        created="2026-01-01T00:00:00+00:00",
        command=("spacevln",),
        configuration=configuration.model_dump(mode="json"),
        configuration_hash=configuration.hash,
        packages={},
        python="3",
        platform="p",
        git_revision=None,
    )


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of one short episode, recorded whole."""
    directory = tmp_path_factory.mktemp("run")
    with pytest.MonkeyPatch.context() as patch, ScriptedServer([Wanderer()]) as server:
        patch.setenv("SPACEVLN_API_KEY", KEY)
        patch.setenv("SPACEVLN_CACHE_DIR", str(directory / "machine"))
        retry = RetrySettings(attempts=3, first_wait_s=0.01)
        price = {"kind": "tokens", "input": 1.0, "output": 2.0}
        choice = ModelChoice.model_validate(
            {"profile": "openai-compatible", "model": "m", "base_url": server.url, "retry": retry, "price": price}
        )
        configuration = Configuration(
            planner="vlm", executor="vlm", models=ModelPair(planner=choice, executor=choice), step_budget=60
        )
        write_file(directory / "run.json", run_file(configuration))
        episode = pick_episode("vln", 7)
        access = RunAccess(ledger=directory / "ledger.sqlite", max_usd=5.0)
        with Session(configuration, access=access) as session:
            result = session.attempt(episode, episode_directory(directory, episode.episode_id), level=RecordLevel.FULL)
        write_file(directory / "summary.json", summarise([result]))
        assert any(KEY in headers["authorization"] for headers in server.headers)
    return directory


@pytest.mark.slow
def test_no_file_of_a_record_holds_the_key(record: Path) -> None:
    files = [path for path in record.rglob("*") if path.is_file()]
    assert {"run.json", "summary.json", "events.jsonl", "result.json", "ledger.sqlite"} <= {path.name for path in files}
    assert not [path for path in files if KEY.encode() in path.read_bytes()]
    events = (find_episode(record) / "events.jsonl").read_text()
    assert '"call_retried"' in events  # the server's messages repeated the key, and were masked
    assert "worker of *** is busy" in events


@pytest.mark.slow
def test_a_replay_reaches_the_same_actions_offline(record: Path, tmp_path: Path) -> None:
    report = replay(find_episode(record), tmp_path / "again")
    assert report.same_actions
    assert report.difference is None
    assert report.calls > 5
    assert report.recorded_actions > 20


@pytest.mark.slow
def test_a_changed_reply_is_found(record: Path, tmp_path: Path) -> None:
    folder = tmp_path / "run" / "episodes" / "changed"
    folder.mkdir(parents=True)
    (tmp_path / "run" / "run.json").write_text((record / "run.json").read_text())
    text = (find_episode(record) / "events.jsonl").read_text()
    done = [json.loads(line) for line in text.splitlines()]
    last = max(index for index, line in enumerate(done) if line["event"] == "model_called" and line["role"] == "executor")
    reply = done[last]["reply"]
    reply["text"] = json.dumps(json.loads(reply["text"]) | {"action": {"reasoning": "", "choice": "stop"}})
    (folder / "events.jsonl").write_text("".join(json.dumps(line) + "\n" for line in done))
    said = CliRunner().invoke(cli, ["replay", str(folder)], standalone_mode=False)
    assert said.return_value == 1
    recorded, replayed = said.output.split("first difference\n")[1].splitlines()
    assert ('"stop"' in recorded) != ('"stop"' in replayed)  # what differs is shown, however long the line


@pytest.mark.slow
def test_a_forecast_learns_from_a_record(record: Path) -> None:
    averages = recorded_averages(record)
    lines = list(read_events(find_episode(record)))
    planner = sum(line.event == "model_called" and line.role is Role.PLANNER for line in lines)
    assert averages.roles[Role.PLANNER].calls == planner
    choice = ModelChoice(profile="dashscope-cn", model="qwen3.5-plus")
    one = forecast(averages, dict.fromkeys(Role, choice), 1, 1)
    ten = forecast(averages, dict.fromkeys(Role, choice), 10, 5)
    assert one.usd is not None
    assert ten.usd == pytest.approx(10 * one.usd)
    assert ten.hours == pytest.approx(2 * one.hours)


def test_the_packages_averages_give_the_papers_order_of_cost() -> None:
    chosen = {
        Role.PLANNER: ModelChoice(profile="dashscope-cn", model="qwen3.5-plus"),
        Role.EXECUTOR: ModelChoice(profile="dashscope-cn", model="qwen3.5-flash"),
    }
    expected = forecast(known_averages("vln"), chosen, 1, 1)
    assert expected.usd == pytest.approx(0.010, rel=0.5)  # the paper: 0.010 USD an episode
    own = forecast(known_averages("objectnav"), {Role.PLANNER: ModelChoice(profile="vllm", model="m")}, 1, 1)
    assert own.usd is None


def test_a_record_without_models_teaches_no_forecast(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no finished episode that asked a model"):
        recorded_averages(tmp_path)


def test_what_was_not_recorded_in_an_embedded_house_is_not_replayed(tmp_path: Path) -> None:
    folder = tmp_path / "episodes" / "a"
    folder.mkdir(parents=True)
    (folder / "events.jsonl").touch()
    write_file(tmp_path / "run.json", run_file(Configuration()).model_copy(update={"configuration": {"environment": "a robot"}}))
    with pytest.raises(UsageError, match=r"was not recorded in an embedded house.*: look at it with `spacevln view`\.$"):
        replay(folder, tmp_path / "again")


def test_finding_the_episode_of_a_record(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / "episodes" / name).mkdir(parents=True)
        (tmp_path / "episodes" / name / "events.jsonl").touch()
    assert find_episode(tmp_path / "episodes" / "a").name == "a"
    assert find_episode(tmp_path, "b").name == "b"
    with pytest.raises(UsageError, match="holds 2 episodes: add --episode"):
        find_episode(tmp_path)
    with pytest.raises(UsageError, match="no such episode"):
        find_episode(tmp_path, "c")
