"""One HTTP request to an OpenAI-compatible server through the official client; every way it can fail has a kind."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from email.utils import parsedate_to_datetime
from typing import TYPE_CHECKING, Any

from spacevln.core import PrerequisiteError
from spacevln.models.secret import Secret

if TYPE_CHECKING:
    import openai

MAX_BODY_BYTES = 8_000_000
"""A larger body is not read to its end."""

CONNECT_S = 10.0
RETRIED_STATUS = frozenset({408, 409, 425, 429, 500, 502, 503, 504, 520, 522, 524, 529})
QUOTA_CODES = ("insufficient_quota", "exceeded_current_quota", "arrearage", "allocationquota", "insufficient_balance", "billing")
"""Codes of a 429 or 403 that waiting does not mend."""


class CallFailed(Exception):  # noqa: N818 - one attempt; the call may still succeed
    """One request brought no reply.

    Args:
        kind: ``connection``, ``reset``, ``timeout``, ``rate_limit``, ``server``, ``broken_reply``, ``quota``, ``authentication``,
            ``not_found`` or ``bad_request``.
        detail: what happened, keys masked.
        retryable: whether the same request may succeed later.
        retry_after_s: how long the server asks to wait.
    """

    def __init__(self, kind: str, detail: str, *, retryable: bool, retry_after_s: float | None = None) -> None:
        super().__init__(detail)
        self.kind = kind
        self.detail = detail
        self.retryable = retryable
        self.retry_after_s = retry_after_s


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A server and the key for it.

    Args:
        client: with its own retries switched off.
        key: masked in every message.
        clock: seconds, monotonic.
    """

    client: openai.OpenAI
    key: Secret
    clock: Callable[[], float] = time.monotonic

    @classmethod
    def open(cls, base_url: str, key: Secret) -> Endpoint:
        """Prepare, without connecting.

        Raises:
            PrerequisiteError: the client library is not installed.
        """
        try:
            import openai
        except ImportError as error:
            raise PrerequisiteError("Asking a model server needs the openai client: pip install 'spacevln[vlm]'.") from error
        # the client takes no empty key, and must not fall back to a variable that belongs to another provider
        return cls(openai.OpenAI(base_url=base_url, api_key=key.reveal() or "none", max_retries=0), key)

    def close(self) -> None:
        """Free the connections."""
        self.client.close()

    def ask(self, body: Mapping[str, Any], timeout_s: float) -> Any:
        """Send one request and read the whole reply.

        Args:
            body: as :func:`~spacevln.models.dialect.request_body` makes it.
            timeout_s: for all of it, a server that sends a byte now and then included.

        Returns:
            The JSON of the reply.

        Raises:
            CallFailed: there is none.
        """
        import httpx2
        import openai

        deadline = self.clock() + timeout_s
        limits = openai.Timeout(timeout_s, connect=min(CONNECT_S, timeout_s))
        standard = {"model": body["model"], "messages": body["messages"]}
        extra = {name: value for name, value in body.items() if name not in standard}
        try:
            with self.client.chat.completions.with_streaming_response.create(
                **standard, extra_body=extra, timeout=limits
            ) as response:
                raw = self._read(response.iter_bytes(), deadline, timeout_s)
        except openai.APITimeoutError as error:
            raise self._failed("timeout", f"no reply within {round(timeout_s, 1):g} s", retryable=True) from error
        except openai.APIStatusError as error:
            raise self._refused(error) from None  # its text is the server's and may repeat the key
        except openai.APIConnectionError as error:
            raise self._failed("connection", f"no connection ({_root(error)})", retryable=True) from error
        except httpx2.TimeoutException as error:
            raise self._failed("timeout", f"the reply stopped and {round(timeout_s, 1):g} s passed", retryable=True) from error
        except httpx2.HTTPError as error:
            raise self._failed("reset", f"the connection broke in mid-reply ({_root(error)})", retryable=True) from error
        return self._json(raw)

    def models(self, timeout_s: float = 10.0) -> tuple[str, ...]:
        """Names of the models that the server offers.

        Raises:
            CallFailed: it does not say.
        """
        import openai

        try:
            return tuple(model.id for model in self.client.models.list(timeout=timeout_s).data or ())
        except openai.APITimeoutError as error:
            raise self._failed("timeout", f"no reply within {round(timeout_s, 1):g} s", retryable=True) from error
        except openai.APIStatusError as error:
            raise self._refused(error) from None  # its text is the server's and may repeat the key
        except openai.APIConnectionError as error:
            raise self._failed("connection", f"no connection ({_root(error)})", retryable=True) from error
        except (openai.OpenAIError, ValueError) as error:
            raise self._failed("broken_reply", f"no list of models ({_root(error)})", retryable=False) from error

    def _read(self, chunks: Any, deadline: float, timeout_s: float) -> bytes:
        raw = bytearray()
        for chunk in chunks:
            raw += chunk
            if len(raw) > MAX_BODY_BYTES:
                raise self._failed("broken_reply", f"a body of over {MAX_BODY_BYTES:,} bytes", retryable=True)
            if self.clock() > deadline:
                raise self._failed("timeout", f"the reply was still coming after {round(timeout_s, 1):g} s", retryable=True)
        return bytes(raw)

    def _json(self, raw: bytes) -> Any:
        try:
            return json.loads(raw.decode("utf-8"))
        except UnicodeDecodeError as error:
            raise self._failed("broken_reply", f"invalid UTF-8 at byte {error.start}", retryable=True) from error
        except (json.JSONDecodeError, RecursionError) as error:
            shown = raw[:80].decode("utf-8", "replace")
            raise self._failed(
                "broken_reply", f"{len(raw):,} bytes that are no JSON, beginning {shown!r}", retryable=True
            ) from error

    def _refused(self, error: openai.APIStatusError) -> CallFailed:
        status = error.status_code
        text = f"HTTP {status}: {_told(error)}"
        code = str(error.code or "").lower() + str(error.type or "").lower()
        if status in (402, 403, 429) and any(word in code for word in QUOTA_CODES):
            return self._failed("quota", text, retryable=False)
        if status in RETRIED_STATUS:
            kind = "rate_limit" if status == 429 else "server"
            return self._failed(kind, text, retryable=True, retry_after_s=retry_after_s(error.response.headers, time.time()))
        kinds = {401: "authentication", 402: "quota", 403: "authentication", 404: "not_found"}
        return self._failed(kinds.get(status, "bad_request" if status < 500 else "server"), text, retryable=False)

    def _failed(self, kind: str, detail: str, *, retryable: bool, retry_after_s: float | None = None) -> CallFailed:
        return CallFailed(kind, self.key.scrub(detail), retryable=retryable, retry_after_s=retry_after_s)


def retry_after_s(headers: Mapping[str, str], now_s: float) -> float | None:
    """How long ``Retry-After`` (or ``retry-after-ms``) asks to wait; None when it is absent or no time.

    Args:
        headers: of the reply; names in any case.
        now_s: seconds since the epoch, for a date.
    """
    exact = headers.get("retry-after-ms")
    if exact is not None and exact.strip().isdigit():
        return int(exact) / 1000
    told = headers.get("retry-after")
    if told is None:
        return None
    try:
        seconds = float(told)
    except ValueError:
        try:
            seconds = parsedate_to_datetime(told).timestamp() - now_s
        except ValueError:
            return None
    return max(seconds, 0.0) if seconds == seconds and seconds < 1e9 else None


def _told(error: openai.APIStatusError) -> str:
    body = error.body
    message = body.get("message") if isinstance(body, dict) else body
    return " ".join(str(message or error.response.reason_phrase).split())[:300]


def _root(error: BaseException) -> str:
    while error.__cause__ is not None:
        error = error.__cause__
    return " ".join((str(error) or type(error).__name__).split())[:200]
