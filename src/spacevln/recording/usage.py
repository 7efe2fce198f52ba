"""What the calls of an episode, or of a stage, came to: numbers, tokens, time and money, by role."""

from __future__ import annotations

from collections.abc import Iterable

from spacevln.core import Role, Usage
from spacevln.recording.calls import CallRetriedLine, ModelCalledLine
from spacevln.recording.record import Record


class CallUsage(Record):
    """Sums over calls.

    Args:
        calls: all, those of refused replies and failures included.
        unusable: whose reply could not be used as it was.
        failed: that brought no reply.
        retries: requests that failed and were sent again.
        kept: answered by the reply cache or a replay.
        tokens: of the replies that a model gave now.
        latency_s: summed.
        usd: of the calls whose price is known.
        unpriced: calls to a model whose price is not known.
    """

    calls: int = 0
    unusable: int = 0
    failed: int = 0
    retries: int = 0
    kept: int = 0
    tokens: Usage = Usage()
    latency_s: float = 0.0
    usd: float = 0.0
    unpriced: int = 0

    def __add__(self, other: CallUsage) -> CallUsage:
        return CallUsage(
            calls=self.calls + other.calls,
            unusable=self.unusable + other.unusable,
            failed=self.failed + other.failed,
            retries=self.retries + other.retries,
            kept=self.kept + other.kept,
            tokens=self.tokens + other.tokens,
            latency_s=round(self.latency_s + other.latency_s, 3),
            usd=round(self.usd + other.usd, 9),
            unpriced=self.unpriced + other.unpriced,
        )


def usage_of(lines: Iterable[object], stage: int | None = None) -> dict[str, CallUsage]:
    """Usage by role of an episode's lines, or of one stage's; other lines are passed over."""
    sums: dict[str, CallUsage] = {}
    for line in lines:
        match line:
            case ModelCalledLine():
                if stage is None or line.stage == stage:
                    sums[line.role.value] = sums.get(line.role.value, CallUsage()) + _one(line)
            case CallRetriedLine():
                if stage is None:
                    sums[line.role.value] = sums.get(line.role.value, CallUsage()) + CallUsage(retries=1)
            case _:
                pass
    return dict(sorted(sums.items()))


def total(usages: Iterable[dict[str, CallUsage]]) -> dict[str, CallUsage]:
    """Usage by role over many episodes."""
    sums = {role.value: CallUsage() for role in Role}
    for usage in usages:
        for role, part in usage.items():
            sums[role] = sums[role] + part
    return {role: part for role, part in sorted(sums.items()) if part.calls or part.retries}


def _one(line: ModelCalledLine) -> CallUsage:
    reply = line.reply
    if reply is None:
        return CallUsage(calls=1, failed=1)
    fresh = reply.source == "model"
    return CallUsage(
        calls=1,
        unusable=int(bool(line.problem)),
        kept=int(not fresh),
        tokens=reply.usage if fresh else Usage(),
        latency_s=round(reply.latency_s, 3),
        usd=round(reply.usd or 0.0, 9),
        unpriced=int(fresh and reply.usd is None),
    )
