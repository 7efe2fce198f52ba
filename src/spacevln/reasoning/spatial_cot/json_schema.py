"""The JSON Schema that a server is asked to keep to, made from the reply models.

Only what constrained decoders understand everywhere is kept: no references, no length bounds (a decoder may expand those into
enormous grammars), every property required and no other allowed. Parsing checks the bounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from spacevln.core import ReplySchema
from spacevln.reasoning.spatial_cot.replies import (
    DirectExecutorReply,
    DirectPlannerReply,
    SpatialCoTExecutorReply,
    SpatialCoTPlannerReply,
)

_KEPT = ("type", "properties", "required", "additionalProperties", "items", "anyOf", "enum")


def planner_schema(directions: Sequence[str], *, scot: bool) -> ReplySchema:
    """Of a planner's reply; ``direction`` is one of the views' labels, or null when the task is complete."""
    model = SpatialCoTPlannerReply if scot else DirectPlannerReply
    schema = _plain(model.model_json_schema())
    schema["properties"]["direction"] = {"anyOf": [{"type": "string", "enum": list(directions)}, {"type": "null"}]}
    return ReplySchema("planner_reply" if scot else "planner_decision", schema)


def executor_schema(choices: Sequence[str], *, scot: bool) -> ReplySchema:
    """Of an executor's reply; the action is one of all choices of the body.

    The admissible ones among them are told in the prompt: a schema that changed with every call would miss every cache.
    """
    choice = {"type": "string", "enum": list(choices)}
    if not scot:
        schema = _plain(DirectExecutorReply.model_json_schema())
        schema["properties"]["action"] = choice
        return ReplySchema("executor_decision", schema)
    schema = _plain(SpatialCoTExecutorReply.model_json_schema())
    schema["properties"]["action"]["properties"]["choice"] = choice
    return ReplySchema("executor_reply", schema)


def _plain(schema: dict[str, Any]) -> dict[str, Any]:
    return _inlined(schema, schema.get("$defs", {}))


def _inlined(node: dict[str, Any], definitions: dict[str, Any]) -> dict[str, Any]:
    if "$ref" in node:
        return _inlined(definitions[node["$ref"].rpartition("/")[2]], definitions)
    plain: dict[str, Any] = {key: node[key] for key in _KEPT if key in node}
    if "properties" in plain:
        plain["properties"] = {name: _inlined(value, definitions) for name, value in plain["properties"].items()}
    if "items" in plain:
        plain["items"] = _inlined(plain["items"], definitions)
    if "anyOf" in plain:
        plain["anyOf"] = [_inlined(value, definitions) for value in plain["anyOf"]]
    return plain
