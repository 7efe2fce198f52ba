"""Replays answer what was recorded, and nothing else."""

from __future__ import annotations

import pytest
from chatting import request

from spacevln.core import ChatReply, ModelError, ReplyRejected, ReplySource, Role
from spacevln.models import RecordedCall, RecordedModel, ReplayDiverged

CALLS = [
    RecordedCall(Role.PLANNER, request("one").digest, ChatReply("first", usd=0.1, latency_s=3.0)),
    RecordedCall(Role.EXECUTOR, request("x", Role.EXECUTOR).digest, ChatReply("step")),
    RecordedCall(Role.PLANNER, request("two").digest, ChatReply("", usd=0.1), "empty", "The reply is empty."),
    RecordedCall(Role.PLANNER, request("three").digest, None, "failed", "All 5 requests failed."),
]


def test_replies_refusals_and_failures_come_back_in_order() -> None:
    planner, executor = RecordedModel(Role.PLANNER, CALLS), RecordedModel(Role.EXECUTOR, CALLS)
    first = planner.complete(request("one"))
    assert (first.text, first.source, first.usd, first.latency_s) == ("first", ReplySource.RECORD, 0.0, 0.0)
    assert executor.complete(request("x", Role.EXECUTOR)).text == "step"
    with pytest.raises(ReplyRejected, match="empty") as refusal:
        planner.complete(request("two"))
    assert refusal.value.kind == "empty"
    with pytest.raises(ModelError, match="All 5 requests"):
        planner.complete(request("three"))
    with pytest.raises(ReplayDiverged, match=r"asks the planner a 4\. time, the record holds 3"):
        planner.complete(request("four"))


def test_another_request_is_no_replay() -> None:
    with pytest.raises(ReplayDiverged, match="planner call 1 differs"):
        RecordedModel(Role.PLANNER, CALLS).complete(request("else"))
    loose = RecordedModel(Role.PLANNER, CALLS, strict=False)
    assert loose.complete(request("else")).text == "first"
    assert loose.differing == 1
