"""Options about chat models: which, how they are asked, and what they may cost."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from spacevln.cli.option_groups import option_group

if TYPE_CHECKING:
    from spacevln.assembly import ModelPair
    from spacevln.models import ModelChoice, RunAccess
    from spacevln.models.prices import PriceRule

REASONERS = click.Choice(["rules", "vlm"])
PAIRS_HELP = "PROVIDER:MODEL, a pair of the paper (paper-qwen3.5 ...), relay:FOLDER, or a name with --base-url."


choice_options = option_group(
    click.option("--model", default=None, metavar="NAME", help=PAIRS_HELP),
    click.option("--executor-model", default=None, metavar="NAME", help="Another model for the executor."),
    click.option("--base-url", default=None, metavar="URL", help="Of an OpenAI-compatible endpoint."),
    click.option(
        "--thinking",
        default="0",
        show_default=True,
        metavar="TOKENS",
        help="Budget of thought per call; 0 = none, 'default' = as the provider likes.",
    ),
    click.option("--temperature", type=click.FloatRange(0, 2), default=0.1, show_default=True, help="Of the model's choices."),
    click.option("--price", default=None, metavar="IN/OUT", help="USD per million tokens, where the table has none."),
    click.option(
        "--usd-per-hour", type=click.FloatRange(min=0, min_open=True), default=None, help="Price of a server of your own."
    ),
)
"""Which model, and how it is asked."""


access_options = option_group(
    click.option("--max-usd", type=click.FloatRange(min=0, min_open=True), default=None, help="Stop asking beyond it."),
    click.option(
        "--requests-per-minute",
        type=click.FloatRange(min=0, min_open=True),
        default=None,
        help="Rate limit over all workers.",
    ),
    click.option(
        "--hedge-after",
        type=click.FloatRange(min=0, min_open=True),
        default=None,
        metavar="S",
        help="Send a second request when the first is silent for so long.",
    ),
    click.option(
        "--reply-cache",
        type=click.Path(path_type=Path, file_okay=False),
        default=None,
        help="Keep replies here, and ask only what has changed.",
    ),
)
"""What a run lets its models do."""


def models_from(options: dict[str, Any]) -> ModelPair | None:
    """The models that these options say; None when none is named.

    Raises:
        UsageError, UnknownNameError: the options do not name a model.
    """
    from spacevln.assembly import ModelPair
    from spacevln.core import Role, UsageError
    from spacevln.models import choose

    if options["model"] is None:
        for name in ("executor_model", "base_url", "price", "usd_per_hour"):
            if options.get(name) is not None:
                raise UsageError(f"--{name.replace('_', '-')} needs --model: name the model that it is about.")
        return None
    chosen = choose(options["model"], options["base_url"])
    if options.get("executor_model") is not None:
        chosen[Role.EXECUTOR] = choose(options["executor_model"], options["base_url"])[Role.EXECUTOR]
    return ModelPair(
        planner=_adjusted(chosen[Role.PLANNER], options),
        executor=_adjusted(chosen[Role.EXECUTOR], options),
    )


def access_from(options: dict[str, Any], directory: Path) -> RunAccess:
    """What these options let the models of a run do; its workers share the ledger in ``directory``."""
    from spacevln.models import RunAccess

    return RunAccess(
        ledger=directory / "ledger.sqlite",
        max_usd=options["max_usd"],
        requests_per_minute=options["requests_per_minute"],
        reply_cache=options["reply_cache"],
        hedge_after_s=options["hedge_after"],
    )


def _adjusted(choice: ModelChoice, options: dict[str, Any]) -> ModelChoice:
    return choice.model_copy(
        update={
            "thinking": _thinking(options["thinking"]),
            "temperature": options["temperature"],
            "price": _price(options["price"], options["usd_per_hour"]),
        }
    )


def _thinking(text: str) -> int | None:
    if text == "default":
        return None
    if not text.isdigit():
        raise click.BadParameter(f"--thinking {text!r} is no number of tokens: give 0, a number, or 'default'.")
    return int(text)


def _price(tokens: str | None, usd_per_hour: float | None) -> PriceRule | None:
    from spacevln.models import HourlyPrice, TokenPrice

    if tokens is None:
        return None if usd_per_hour is None else HourlyPrice(usd_per_hour=usd_per_hour)
    if usd_per_hour is not None:
        raise click.UsageError("--price and --usd-per-hour exclude each other: give one.")
    parts = tokens.split("/")
    try:
        given, written, *cached = map(float, parts)
    except ValueError as error:
        raise click.BadParameter(f"--price {tokens!r} is no price: give INPUT/OUTPUT[/CACHED], e.g. 0.4/2.4.") from error
    if len(cached) > 1 or min(given, written, *cached) < 0:
        raise click.BadParameter(f"--price {tokens!r} is no price: give INPUT/OUTPUT[/CACHED], e.g. 0.4/2.4.")
    return TokenPrice(input=given, output=written, cached=cached[0] if cached else None)
