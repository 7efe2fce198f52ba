"""What workers share (rate, purse), and what is kept between runs (replies)."""

from __future__ import annotations

import threading
from dataclasses import dataclass
from pathlib import Path

import pytest
from chatting import GOOD, asking, request

from spacevln.core import ModelError, RecordError, ReplyRejected, ReplySource, SpendingLimit
from spacevln.models import RunAccess
from spacevln.models.ledger import RunLedger
from spacevln.testing.chat_server import Refuse, Say, ScriptedServer


@dataclass
class Now:
    s: float = 1000.0

    def __call__(self) -> float:
        return self.s


def test_places_are_given_out_in_turn_to_all_workers(tmp_path: Path) -> None:
    now = Now()
    workers = [RunLedger(tmp_path / "ledger.sqlite", requests_per_minute=30, clock=now) for _ in range(3)]
    assert [worker.reserve() for worker in workers * 2] == [0, 2, 4, 6, 8, 10]
    now.s += 11
    assert workers[0].reserve() == 1
    now.s += 60
    assert workers[1].reserve() == 0  # places that passed unused are gone: no burst
    for worker in workers:
        worker.close()


def test_a_pause_holds_for_all_workers_and_never_shrinks(tmp_path: Path) -> None:
    now = Now()
    first, second = (RunLedger(tmp_path / "ledger.sqlite", clock=now) for _ in range(2))
    first.pause(9)
    first.pause(3)
    assert second.reserve() == 9
    now.s += 9
    assert second.reserve() == 0
    first.close()
    second.close()


def test_the_purse_is_shared_survives_and_stops_the_run(tmp_path: Path) -> None:
    first = RunLedger(tmp_path / "ledger.sqlite", max_usd=1.0)
    second = RunLedger(tmp_path / "ledger.sqlite", max_usd=1.0)
    first.spend(0.6)
    second.check()
    second.spend(0.5)
    with pytest.raises(SpendingLimit, match=r"spent 1.1000 USD of --max-usd 1: run the same command"):
        first.check()
    first.close()
    second.close()
    resumed = RunLedger(tmp_path / "ledger.sqlite", max_usd=2.0)
    assert resumed.spent_usd == pytest.approx(1.1)
    resumed.check()
    resumed.close()


def test_threads_do_not_lose_a_cent(tmp_path: Path) -> None:
    ledger = RunLedger(tmp_path / "ledger.sqlite")
    threads = [threading.Thread(target=lambda: [ledger.spend(0.01) for _ in range(20)]) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert ledger.spent_usd == pytest.approx(0.8)
    ledger.close()


def test_a_ledger_that_cannot_be_opened_says_so(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="ledger"):
        RunLedger(tmp_path / "missing" / "ledger.sqlite")


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_the_run_stops_asking_when_its_money_is_spent(tmp_path: Path) -> None:
    price = {"kind": "tokens", "input": 1000.0, "output": 0.0}
    access = RunAccess(ledger=tmp_path / "ledger.sqlite", max_usd=0.15)
    say = Say(GOOD, usage={"prompt_tokens": 100})
    with ScriptedServer([say]) as server, asking(server.url, tmp_path, access=access, price=price) as setting:
        assert setting.planner.complete(request()).usd == pytest.approx(0.1)
        setting.planner.complete(request())
        with pytest.raises(SpendingLimit):
            setting.planner.complete(request())
        assert len(server.bodies) == 2


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_a_rate_limit_that_leaves_no_place_in_time_is_told(tmp_path: Path) -> None:
    access = RunAccess(requests_per_minute=0.5)
    with ScriptedServer([Say(GOOD)]) as server, asking(server.url, tmp_path, access=access) as setting:
        setting.planner.complete(request())
        with pytest.raises(ModelError, match="--requests-per-minute"):
            setting.planner.complete(request())


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_the_rate_limit_waits_for_its_place(tmp_path: Path) -> None:
    access = RunAccess(requests_per_minute=6)
    with ScriptedServer([Say(GOOD)]) as server, asking(server.url, tmp_path, access=access) as setting:
        setting.planner.complete(request())
        setting.planner.complete(request())
    assert 9 < setting.time.slept[0] <= 10


# kept replies


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_only_changed_calls_are_asked_again(tmp_path: Path) -> None:
    access = RunAccess(reply_cache=tmp_path / "cache")
    with ScriptedServer([Say("first"), Say("second"), Say("other"), Say("hotter")]) as server:
        with asking(server.url, tmp_path, access=access) as setting:
            # the same question twice in an episode is asked twice: the first answer was refused
            assert [setting.planner.complete(request()).text for _ in range(2)] == ["first", "second"]
        with asking(server.url, tmp_path, access=access) as setting:
            replies = [setting.planner.complete(request()) for _ in range(2)]
            assert [reply.text for reply in replies] == ["first", "second"]
            assert {(reply.source, reply.usd, reply.latency_s) for reply in replies} == {(ReplySource.CACHE, 0.0, 0.0)}
            assert setting.planner.complete(request("Changed?")).source is ReplySource.MODEL
        with asking(server.url, tmp_path, access=access, temperature=0.9) as setting:
            assert setting.planner.complete(request()).text == "hotter"
        assert len(server.bodies) == 4


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_failures_and_unusable_replies_are_not_kept(tmp_path: Path) -> None:
    access = RunAccess(reply_cache=tmp_path / "cache")
    with ScriptedServer([Say("", finish="length"), Refuse(401), Say("good")]) as server:
        with asking(server.url, tmp_path, access=access) as setting, pytest.raises(ReplyRejected):
            setting.planner.complete(request())
        with asking(server.url, tmp_path, access=access) as setting, pytest.raises(ModelError):
            setting.planner.complete(request())
        with asking(server.url, tmp_path, access=access) as setting:
            assert setting.planner.complete(request()).text == "good"


@pytest.mark.allow_hosts(["127.0.0.1"])
def test_a_damaged_kept_reply_is_told(tmp_path: Path) -> None:
    access = RunAccess(reply_cache=tmp_path / "cache")
    with ScriptedServer([Say("first")]) as server:
        with asking(server.url, tmp_path, access=access) as setting:
            setting.planner.complete(request())
        (file,) = (tmp_path / "cache").rglob("*.json")
        file.write_text("{")
        with asking(server.url, tmp_path, access=access) as setting, pytest.raises(RecordError, match="delete it"):
            setting.planner.complete(request())
