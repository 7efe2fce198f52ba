"""No fallback is silent: those of a reply become events, whether the reply is then used or refused."""

from __future__ import annotations

from collections.abc import Callable

from spacevln.core import Event, ExecutorReply, FallbackUsed, PlannerReply, ReplyRejected


def tell_fallbacks(
    reply: PlannerReply | ExecutorReply | ReplyRejected, stage: int, role: str, emit: Callable[[Event], None]
) -> None:
    """Emit one :class:`FallbackUsed` for every fallback of a reply."""
    for kind in reply.fallbacks:
        emit(FallbackUsed(stage, kind, role))
