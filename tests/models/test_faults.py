"""Every way in which a server fails: what is tried again, what is given up, and what the listeners are told."""

from __future__ import annotations

from pathlib import Path

import pytest
from chatting import FAST, GOOD, asking, request

from spacevln.core import CallRetried, ModelCalled, ModelError, ReplyMode, ReplyRejected
from spacevln.models import RetrySettings
from spacevln.models.endpoint import retry_after_s
from spacevln.testing.chat_server import Hang, Raw, Refuse, Reset, Say, ScriptedServer, closed_url

pytestmark = pytest.mark.allow_hosts(["127.0.0.1"])


def kinds(heard: list[object]) -> list[str]:
    return [event.kind for event in heard if isinstance(event, CallRetried)]


def test_a_good_reply_comes_through(tmp_path: Path) -> None:
    good = Say(GOOD, usage={"prompt_tokens": 100, "prompt_tokens_details": {"cached_tokens": 40}})
    with ScriptedServer([good]) as server, asking(server.url, tmp_path) as setting:
        reply = setting.planner.complete(request())
    assert (reply.mode, reply.attempts, reply.model) == (ReplyMode.JSON_SCHEMA, 1, "scripted")
    assert (reply.usage.input_tokens, reply.usage.cached_tokens) == (100, 40)
    (called,) = setting.heard.events
    assert isinstance(called, ModelCalled)
    assert (called.reply, called.problem) == (reply, "")


@pytest.mark.parametrize(
    ("fault", "kind"),
    [
        (Reset(mid_reply=True), "reset"),
        (Reset(mid_reply=False), "connection"),
        (Refuse(500, "oops"), "server"),
        (Refuse(503, "overloaded"), "server"),
        (Refuse(429, "slow down"), "rate_limit"),
        (Raw(b'{"choices": [{"mess'), "broken_reply"),
        (Raw(b'{"choices": [{"message": {"content": "\xff\xfe"}}]}'), "broken_reply"),
        (Raw(b"<html>Bad gateway</html>"), "broken_reply"),
        (Raw(b'{"error": "nothing here"}'), "broken_reply"),
        (Raw(b"[]"), "broken_reply"),
        (Raw(b""), "broken_reply"),
        (Raw(b"[" * 100_000), "broken_reply"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_passing_fault_is_tried_again_and_told(fault: object, kind: str, tmp_path: Path) -> None:
    with ScriptedServer([fault, Say(GOOD)]) as server, asking(server.url, tmp_path) as setting:  # type: ignore[list-item]
        reply = setting.planner.complete(request())
    assert reply.attempts == 2
    assert kinds(setting.heard.events) == [kind]
    assert len(setting.time.slept) == 1
    assert setting.heard.names() == ["CallRetried", "ModelCalled"]


def test_a_refused_connection_ends_as_a_model_error(tmp_path: Path) -> None:
    with asking(closed_url(), tmp_path) as setting, pytest.raises(ModelError, match=r"All 3 requests .* connection"):
        setting.planner.complete(request())
    assert kinds(setting.heard.events) == ["connection", "connection"]
    called = setting.heard.events[-1]
    assert isinstance(called, ModelCalled)
    assert (called.reply, called.problem) == (None, "failed")


def test_a_storm_of_500_ends_after_the_last_attempt_with_growing_waits(tmp_path: Path) -> None:
    retry = RetrySettings(attempts=5, first_wait_s=1, longest_wait_s=4, jitter=0.25, attempt_s=5, total_s=100)
    with (
        ScriptedServer([Refuse(500)]) as server,
        asking(server.url, tmp_path, retry) as setting,
        pytest.raises(ModelError, match="All 5 requests"),
    ):
        setting.planner.complete(request())
    assert len(server.bodies) == 5
    for wait, base in zip(setting.time.slept, (1, 2, 4, 4), strict=True):
        assert 0.75 * base <= wait <= 1.25 * base
    assert len({round(wait / base, 6) for wait, base in zip(setting.time.slept, (1, 2, 4, 4), strict=True)}) == 4


@pytest.mark.parametrize("hang", [Hang(), Hang(drip_s=0.05)], ids=["silent", "dripping"])
def test_a_hanging_server_cannot_hold_a_call_beyond_its_deadline(hang: Hang, tmp_path: Path) -> None:
    retry = RetrySettings(attempts=9, first_wait_s=0.1, jitter=0, attempt_s=0.25, total_s=0.8)
    with ScriptedServer([hang]) as server, asking(server.url, tmp_path, retry) as setting:
        begin = setting.time.clock()
        with pytest.raises(ModelError, match=r"no reply within 0.8 s \(\d requests, the last because of timeout|no place"):
            setting.planner.complete(request())
        assert setting.time.clock() - begin < 10  # 0.8 s on an idle machine, and the server never ends
    assert set(kinds(setting.heard.events)) == {"timeout"}


def test_retry_after_is_obeyed(tmp_path: Path) -> None:
    script = [Refuse(429, headers={"Retry-After": "7"}), Say(GOOD)]
    with ScriptedServer(script) as server, asking(server.url, tmp_path) as setting:
        setting.planner.complete(request())
    assert setting.time.slept[0] == 7


def test_a_retry_after_beyond_the_deadline_is_not_waited_for(tmp_path: Path) -> None:
    script = [Refuse(429, headers={"Retry-After": "3600"}), Say(GOOD)]
    with (
        ScriptedServer(script) as server,
        asking(server.url, tmp_path) as setting,
        pytest.raises(ModelError, match="no reply within 60 s"),
    ):
        setting.planner.complete(request())
    assert setting.time.slept == []


@pytest.mark.parametrize(
    ("headers", "expected"),
    [
        ({"retry-after": "2.5"}, 2.5),
        ({"retry-after-ms": "1500"}, 1.5),
        ({"retry-after": "Thu, 01 Jan 1970 00:00:30 GMT"}, 20.0),
        ({"retry-after": "-3"}, 0.0),
        ({"retry-after": "soon"}, None),
        ({"retry-after": "nan"}, None),
        ({}, None),
    ],
)
def test_retry_after_in_every_form(headers: dict[str, str], expected: float | None) -> None:
    assert retry_after_s(headers, now_s=10.0) == expected


@pytest.mark.parametrize(
    ("refusal", "kind"),
    [
        (Refuse(400, "bad image"), "bad_request"),
        (Refuse(401, "who are you"), "authentication"),
        (Refuse(402, "pay first"), "quota"),
        (Refuse(403, "not yours"), "authentication"),
        (Refuse(404, "no such model"), "not_found"),
        (Refuse(413, "too large"), "bad_request"),
        (Refuse(422, "unprocessable"), "bad_request"),
        (Refuse(429, "quota used up", code="insufficient_quota"), "quota"),
        (Refuse(403, "free tier only", code="AllocationQuota.FreeTierOnly"), "quota"),
        (Refuse(501, "not implemented"), "server"),
    ],
)
def test_what_waiting_does_not_mend_is_never_tried_again(refusal: Refuse, kind: str, tmp_path: Path) -> None:
    with (
        ScriptedServer([refusal]) as server,
        asking(server.url, tmp_path, mode=ReplyMode.TEXT) as setting,
        pytest.raises(ModelError, match=rf"refused the request \({kind}\): HTTP {refusal.status}"),
    ):
        setting.planner.complete(request())
    assert len(server.bodies) == 1
    assert setting.heard.names() == ["ModelCalled"]


@pytest.mark.parametrize(
    ("say", "kind"),
    [
        (Say('{"why": "the so', finish="length"), "cut_off"),
        (Say("", finish="content_filter"), "withheld"),
        (Say("", message={"refusal": "I cannot help with that."}), "withheld"),
        (Say("   \n"), "empty"),
        (Say("a" * 1_000_000), "too_long"),
    ],
)
def test_an_unusable_reply_is_rejected_with_a_reason_and_still_paid_for(say: Say, kind: str, tmp_path: Path) -> None:
    price = {"kind": "tokens", "input": 1.0, "output": 1.0}
    with ScriptedServer([say]) as server, asking(server.url, tmp_path, price=price) as setting:
        with pytest.raises(ReplyRejected) as refusal:
            setting.planner.complete(request())
        assert setting.desk.ledger.spent_usd > 0
    assert refusal.value.kind == kind
    (called,) = setting.heard.events
    assert isinstance(called, ModelCalled)
    assert called.problem == kind
    assert called.reply is not None


def test_a_body_without_end_is_not_read_to_its_end(tmp_path: Path) -> None:
    with ScriptedServer([Raw(b" " * 9_000_000), Say(GOOD)]) as server, asking(server.url, tmp_path) as setting:
        assert setting.planner.complete(request()).attempts == 2
    assert kinds(setting.heard.events) == ["broken_reply"]


def test_lone_surrogates_become_text_that_can_be_stored(tmp_path: Path) -> None:
    with ScriptedServer([Say("a\ud800b")]) as server, asking(server.url, tmp_path) as setting:
        assert setting.planner.complete(request()).text == "a?b"


def test_a_hedged_request_overtakes_a_hanging_one(tmp_path: Path) -> None:
    retry = FAST.model_copy(update={"hedge_after_s": 0.1})
    with ScriptedServer([Say("slow", after_s=2.0), Say(GOOD)]) as server, asking(server.url, tmp_path, retry) as setting:
        reply = setting.planner.complete(request())
        assert "sofa" in reply.text
        assert reply.attempts == 1
        assert len(server.bodies) == 2


def test_a_quick_reply_is_not_hedged(tmp_path: Path) -> None:
    retry = FAST.model_copy(update={"hedge_after_s": 2.0})
    with ScriptedServer([Say(GOOD)]) as server, asking(server.url, tmp_path, retry) as setting:
        setting.planner.complete(request())
    assert len(server.bodies) == 1


def test_when_both_hedged_requests_fail_the_call_is_tried_again(tmp_path: Path) -> None:
    retry = FAST.model_copy(update={"hedge_after_s": 0.05})
    script = [Hang(), Refuse(500), Say(GOOD)]
    short = retry.model_copy(update={"attempt_s": 1.0})
    with ScriptedServer(script) as server, asking(server.url, tmp_path, short) as setting:
        assert setting.planner.complete(request()).attempts == 2
