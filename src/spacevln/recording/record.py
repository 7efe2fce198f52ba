"""Base of every line and file of a record."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict


class Record(BaseModel):
    """Strict and frozen; numbers that are not finite become strings."""

    model_config = ConfigDict(extra="forbid", frozen=True, ser_json_inf_nan="strings", arbitrary_types_allowed=False)
