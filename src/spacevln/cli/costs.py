"""One line about what chat models were asked and what that cost."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spacevln.recording import CallUsage


def usage_line(usage: Mapping[str, CallUsage]) -> str:
    """Calls by role, tokens, cached share, seconds per call, USD."""
    parts = [f"{part.calls} {role} calls of {part.latency_s / max(part.calls, 1):.1f} s" for role, part in usage.items()]
    read = sum(part.tokens.input_tokens for part in usage.values())
    cached = sum(part.tokens.cached_tokens for part in usage.values())
    written = sum(part.tokens.output_tokens for part in usage.values())
    parts.append(f"{read:,} tokens in ({100 * cached / max(read, 1):.0f} % cached), {written:,} out")
    usd, unpriced = sum(part.usd for part in usage.values()), sum(part.unpriced for part in usage.values())
    parts.append(f"{usd:.4f} USD" + (f", {unpriced} of unknown price" if unpriced else ""))
    return "models   " + ", ".join(parts)
