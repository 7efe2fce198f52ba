"""What ``spacevln doctor --model`` says about chat models."""

from __future__ import annotations

import os
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from spacevln.cli.findings import Finding

if TYPE_CHECKING:
    from spacevln.models import ModelChoice
    from spacevln.models.probe import ProbeReport


def keys() -> Iterator[Finding]:
    """Which providers' keys are set; never what they are."""
    from spacevln.models import profiles

    names = sorted({profile.key_env for profile in profiles().values()})
    found = [name for name in names if os.environ.get(name, "").strip()]
    yield Finding("ok", f"model keys in the environment: {', '.join(found) or 'none'} (known: {', '.join(names)})")


def model_findings(options: dict[str, Any]) -> Iterator[Finding]:
    """Ask every model that the options name one small question, and tell what came back."""
    from spacevln.cli.model_options import models_from

    pair = models_from(options)
    if pair is None:
        return
    for choice in dict.fromkeys(pair.choices.values()):
        yield from _one(choice)


def _one(choice: ModelChoice) -> Iterator[Finding]:
    from pathlib import Path

    from spacevln.core import PrerequisiteError
    from spacevln.models.choice import RELAY
    from spacevln.models.probe import probe

    if choice.profile == RELAY:
        yield Finding("ok", f"{choice}: requests are written to {Path(choice.model).resolve()}, replies are read there")
        return
    try:
        report = probe(choice)
    except PrerequisiteError as error:
        yield Finding("missing", f"{choice}: {error}")
        return
    yield from _reply(report)
    yield from _price(choice)


def _reply(report: ProbeReport) -> Iterator[Finding]:
    choice, reply = report.choice, report.reply
    if reply is None:
        yield Finding("missing", f"{choice} at {choice.url}: {report.problem}", _mend(report))
        return
    thought = f", {reply.usage.reasoning_tokens} of thought" if reply.usage.reasoning_tokens else ""
    tokens = f"{reply.usage.input_tokens} tokens in, {reply.usage.output_tokens} out{thought}"
    yield Finding("ok", f"{choice} at {choice.url}: answered as {reply.model} in {reply.latency_s:.1f} s, {tokens}")
    yield Finding("ok", f"  reply shape: {reply.mode} (found out now, remembered on this machine)")
    if not report.parsed:
        yield Finding("note", f"  its reply was not the JSON object that was asked for: {report.problem or reply.text[:80]!r}")
    if report.sees:
        yield Finding("ok", "  sees pictures: it named the colour of the test picture")
    else:
        yield Finding("note", "  does not see pictures, or not well: it did not name the colour of the test picture", "use a VLM")
    if report.offered and choice.model not in report.offered:
        yield Finding("note", f"  the server lists other models: {', '.join(report.offered[:5])}")


def _price(choice: ModelChoice) -> Iterator[Finding]:
    from spacevln.models import price_of, profile

    price = price_of(choice)
    if price is not None:
        yield Finding("ok", f"  price: {price}")
    elif profile(choice.profile).tells_usd:
        yield Finding("ok", "  price: told by the server with every reply")
    else:
        yield Finding("note", "  price: not known, so costs are not counted", "give --price IN/OUT or --usd-per-hour")


def _mend(report: ProbeReport) -> str:
    from spacevln.models import profile

    if "connection" in report.problem:
        return f"start the server at {report.choice.url}, or give another --base-url"
    if "authentication" in report.problem:
        return f"check the key in {profile(report.choice.profile).key_env}"
    if "not_found" in report.problem and report.offered:
        return f"use one of {', '.join(report.offered[:5])}"
    return ""
