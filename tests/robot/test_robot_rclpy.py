"""The rclpy transport against a stand-in of rclpy's API: what is written, read, kept for late joiners, served and closed."""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Callable, Iterator

import pytest

pytest.importorskip("rosbags", reason="needs the extra 'robot'")

import rclpy_standin
from robot_messages import MESSAGES

from spacevln.core import EnvironmentFailure
from spacevln.environments.robot import wire
from spacevln.environments.robot.messages import Message, TFMessage, TriggerReply
from spacevln.environments.robot.transport import Qos, Topic, Transport, open_transport

pytestmark = pytest.mark.slow  # where CI has installed the extra


@pytest.fixture
def pair(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Transport, Transport]]:
    rclpy_standin.install(monkeypatch)
    monkeypatch.delitem(sys.modules, "spacevln.environments.robot.transports.ros", raising=False)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: object())
    a, b = open_transport("rclpy", domain=3), open_transport("rclpy", domain=3)
    yield a, b
    a.close()
    b.close()
    b.close()
    left = list(rclpy_standin.CONTEXTS)
    rclpy_standin.CONTEXTS.clear()
    assert not left


def until(holds: Callable[[], object]) -> None:
    end = time.monotonic() + 5
    while not holds():
        assert time.monotonic() < end
        time.sleep(0.001)


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: type(message).__name__)
def test_every_type_is_taken_by_rclpy_and_comes_back(pair: tuple[Transport, Transport], message: Message) -> None:
    a, b = pair
    topic, got, elsewhere = Topic("/x", type(message)), list[Message](), list[Message]()
    b.subscribe(topic, got.append)
    other = open_transport("rclpy", domain=4)
    other.subscribe(topic, elsewhere.append)
    a.publish(topic, message)
    until(lambda: got)
    assert [wire.encode(found) for found in got] == [wire.encode(message)]  # images compare by identity
    assert elsewhere == []
    assert a.peers(topic) == b.peers(topic) == 1
    other.close()


def test_late_joiners_hear_what_is_latched_and_services_answer(pair: tuple[Transport, Transport]) -> None:
    a, b = pair
    static, got = Topic("/tf_static", TFMessage, Qos.LATCHED), list[TFMessage]()
    a.publish(static, TFMessage(()))
    b.subscribe(static, got.append)
    until(lambda: got)
    asked = threading.Event()

    def stop() -> TriggerReply:
        asked.set()
        return TriggerReply(True, "stopped")

    a.serve_trigger("/spacevln/stop", stop)
    assert b.call_trigger("/spacevln/stop") == TriggerReply(True, "stopped")
    assert asked.is_set()
    assert b.call_trigger("/nobody", 0.1) is None


def test_a_reliable_reader_does_not_hear_a_best_effort_writer(pair: tuple[Transport, Transport]) -> None:
    """Why images and odometry are read best effort: such a reader hears both kinds of writers."""
    a, b = pair
    got: list[TFMessage] = []
    b.subscribe(Topic("/tf", TFMessage, Qos.RELIABLE), got.append)
    a.publish(Topic("/tf", TFMessage, Qos.SENSOR), TFMessage(()))
    assert a.peers(Topic("/tf", TFMessage)) == 0
    b.subscribe(Topic("/odom", TFMessage, Qos.SENSOR), got.append)
    a.publish(Topic("/odom", TFMessage, Qos.RELIABLE), TFMessage(()))
    until(lambda: got)
    assert len(got) == 1


def test_a_closed_transport_says_so(pair: tuple[Transport, Transport]) -> None:
    a, _ = pair
    a.close()
    with pytest.raises(EnvironmentFailure, match="closed"):
        a.publish(Topic("/tf", TFMessage), TFMessage(()))
