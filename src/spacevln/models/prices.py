"""What a call costs: the price table (``data/prices.toml``), or a rule for a server of one's own."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, NonNegativeFloat, PositiveFloat, PositiveInt

from spacevln.core import Usage
from spacevln.models.profiles import data

MILLION = 1_000_000


class _Price(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class TokenPrice(_Price):
    """USD per million tokens.

    Args:
        input, output: of fresh input and of everything written.
        cached, cache_write: of input found in, or written into, the provider's cache; None = as ``input``.
    """

    kind: Literal["tokens"] = "tokens"
    input: NonNegativeFloat
    output: NonNegativeFloat
    cached: NonNegativeFloat | None = None
    cache_write: NonNegativeFloat | None = None

    def usd(self, usage: Usage, latency_s: float) -> float:
        """Cost of one call."""
        del latency_s
        fresh = max(usage.input_tokens - usage.cached_tokens - usage.cache_write_tokens, 0)
        cached = self.input if self.cached is None else self.cached
        written = self.input if self.cache_write is None else self.cache_write
        total = fresh * self.input + usage.cached_tokens * cached + usage.cache_write_tokens * written
        return (total + usage.output_tokens * self.output) / MILLION

    def __str__(self) -> str:
        return f"{self.input:g} in, {self.output:g} out USD per million tokens"


class HourlyPrice(_Price):
    """A server of one's own: what it costs to keep it, shared by the calls that it answers side by side.

    Args:
        usd_per_hour: of the machine.
        parallel: calls it answers at a time when it is busy.
    """

    kind: Literal["hourly"] = "hourly"
    usd_per_hour: PositiveFloat
    parallel: PositiveInt = 1

    def usd(self, usage: Usage, latency_s: float) -> float:
        """Cost of the time that one call took."""
        del usage
        return self.usd_per_hour * latency_s / 3600 / self.parallel

    def __str__(self) -> str:
        return f"{self.usd_per_hour:g} USD per hour over {self.parallel} calls side by side"


PriceRule = Annotated[TokenPrice | HourlyPrice, Field(discriminator="kind")]


class PriceRow(_Price):
    """A row of the table; prices per million tokens in its currency."""

    profile: str
    model: str
    currency: Literal["USD", "CNY"]
    input: NonNegativeFloat
    output: NonNegativeFloat
    cached: NonNegativeFloat | None = None
    cache_write: NonNegativeFloat | None = None
    up_to: PositiveInt
    seen: str
    source: str

    def in_usd(self, usd: float) -> TokenPrice:
        """The row at an exchange rate."""

        def converted(value: float | None) -> float | None:
            return None if value is None else value * usd

        return TokenPrice(
            input=self.input * usd,
            output=self.output * usd,
            cached=converted(self.cached),
            cache_write=converted(self.cache_write),
        )


class ListPrice:
    """Price of a model in the table, by the size of a call's input.

    Args:
        rows: of one model, ascending in ``up_to``; larger inputs than the last row's are priced by that row.
    """

    def __init__(self, rows: Sequence[PriceRow]) -> None:
        self.rows = tuple(rows)
        self._tiers = [(row.up_to, row.in_usd(_rate(row.currency))) for row in rows]

    def usd(self, usage: Usage, latency_s: float) -> float:
        """Cost of one call."""
        tier = next((price for up_to, price in self._tiers if usage.input_tokens <= up_to), self._tiers[-1][1])
        return tier.usd(usage, latency_s)

    def __str__(self) -> str:
        row = self.rows[0]
        return f"{row.input:g} in, {row.output:g} out {row.currency} per million tokens ({row.source}, {row.seen})"


AnyPrice = TokenPrice | HourlyPrice | ListPrice


@cache
def table() -> tuple[PriceRow, ...]:
    """Every row."""
    return tuple(PriceRow.model_validate(row) for row in data("prices.toml")["price"])


@cache
def list_price(profile: str, model: str) -> ListPrice | None:
    """The table's price of a model at a provider; None when it is in no row."""
    rows = [row for row in table() if (row.profile, row.model) == (profile, model)]
    return ListPrice(rows) if rows else None


def _rate(currency: str) -> float:
    return 1.0 if currency == "USD" else float(data("prices.toml")["exchange"][currency]["usd"])
