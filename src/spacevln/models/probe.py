"""Asks a model one small question with a picture, and tells what its server can do (``spacevln doctor --model``)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from spacevln.core import (
    ChatReply,
    ChatRequest,
    ImagePart,
    Message,
    ModelError,
    ReplyRejected,
    ReplySchema,
    Role,
    Speaker,
    TextPart,
    read_object,
)
from spacevln.models.choice import ModelChoice, RetrySettings
from spacevln.models.endpoint import CallFailed, Endpoint
from spacevln.models.ledger import RunLedger
from spacevln.models.modes import ModeMemory
from spacevln.models.openai_compatible import OpenAICompatibleModel
from spacevln.models.opening import price_of
from spacevln.models.profiles import profile
from spacevln.models.secret import key_from_environment

COLOURS = ("red", "green", "blue", "yellow")
PATIENCE = RetrySettings(attempts=1, attempt_s=60.0, total_s=60.0)


@dataclass(frozen=True, slots=True)
class ProbeReport:
    """What a probe found.

    Args:
        choice: the model that was asked.
        offered: models that the server names; empty when it names none.
        reply: to the question; None when there was none.
        sees: whether it named the colour of the picture.
        parsed: whether the reply is the JSON object that was asked for.
        problem: why there is no usable reply; ``""`` when there is one.
    """

    choice: ModelChoice
    offered: tuple[str, ...]
    reply: ChatReply | None
    sees: bool
    parsed: bool
    problem: str


def probe(choice: ModelChoice, memory: ModeMemory | None = None) -> ProbeReport:
    """Ask one model; finds out its server's reply shape anew and remembers it.

    Raises:
        PrerequisiteError: the key or the client library is missing.
    """
    known = profile(choice.profile)
    key = key_from_environment(known.key_env, optional=known.key_optional, purpose=known.title)
    endpoint = Endpoint.open(choice.url, key)
    ledger, memory = RunLedger(), memory or ModeMemory()
    memory.forget(choice.url, choice.model)
    patient = choice.model_copy(update={"retry": PATIENCE})
    model = OpenAICompatibleModel(patient, endpoint, price_of(choice), ledger, memory)
    try:
        offered = endpoint.models()
    except CallFailed:  # many servers have no list; the question below tells whether they answer
        offered = ()
    try:
        reply = model.complete(question())
    except (ModelError, ReplyRejected) as error:
        return ProbeReport(choice, offered, None, sees=False, parsed=False, problem=str(error))
    finally:
        endpoint.close()
        ledger.close()
    try:
        named = read_object(reply.text).value.get("colour")
    except ReplyRejected as error:
        return ProbeReport(choice, offered, reply, sees=False, parsed=False, problem=str(error))
    return ProbeReport(choice, offered, reply, sees=named == COLOURS[0], parsed=named in COLOURS, problem="")


def question() -> ChatRequest:
    """Which colour a small red picture has."""
    picture = np.zeros((64, 64, 3), dtype=np.uint8)
    picture[..., 2] = 220  # OpenCV writes blue, green, red
    _, data = cv2.imencode(".jpg", picture)
    words = "Which colour is this picture? Answer with one JSON object with the field colour: red, green, blue or yellow."
    schema = {
        "type": "object",
        "properties": {"colour": {"type": "string", "enum": list(COLOURS)}},
        "required": ["colour"],
        "additionalProperties": False,
    }
    message = Message(Speaker.USER, (TextPart(words), ImagePart(data.tobytes(), "red")))
    return ChatRequest(Role.PLANNER, (message,), ReplySchema("colour", schema), max_tokens=200)
