"""Fetching a model's files: into ``.part`` files that a broken transfer resumes, checked before they get their names.

Called by ``spacevln models download`` only; nothing else in the program reaches for the network.
"""

from __future__ import annotations

import os
import re
import shutil
import urllib.error
import urllib.request
from collections.abc import Callable
from dataclasses import dataclass
from http.client import HTTPException
from typing import Any
from urllib.parse import urlsplit

from spacevln.core import PrerequisiteError, UsageError
from spacevln.perception.weights.catalogue import PublishedFile, PublishedModel
from spacevln.perception.weights.store import CHUNK, FileState, WeightStore, checksum, partial_of

MIRROR_VARIABLE = "SPACEVLN_MODELS_MIRROR"
"""Environment variable with an address that replaces the publishers' sites, e.g. ``https://mirror.example/huggingface``."""

OFFLINE_VARIABLE = "SPACEVLN_OFFLINE"
"""Environment variable that forbids every download when it is set to anything but ``0``."""

STATED = "X-Linked-Etag"
"""Header in which a model hub states the SHA-256 of a large file."""

TIMEOUT_S = 30.0
RANGE_NOT_SATISFIABLE = 416
_SHA256 = re.compile(r'^"?([0-9a-f]{64})"?$')

Progress = Callable[[str, int, int | None], None]
"""Told of a file: name, bytes so far, bytes in all where that is known."""


@dataclass(frozen=True, slots=True)
class Source:
    """Where files come from.

    Args:
        mirror: replaces scheme and host of every address; None = the publishers.
    """

    mirror: str | None = None

    @classmethod
    def default(cls, mirror: str | None = None) -> Source:
        """As the environment says, where no mirror is given.

        Raises:
            PrerequisiteError: downloads are forbidden.
        """
        if os.environ.get(OFFLINE_VARIABLE, "0") not in ("", "0"):
            raise PrerequisiteError(f"{OFFLINE_VARIABLE} is set, so nothing is downloaded: unset it, or copy the files by hand.")
        return cls(mirror or os.environ.get(MIRROR_VARIABLE) or None)

    def address(self, file: PublishedFile) -> str:
        """Of a file."""
        if self.mirror is None:
            return file.url
        return self.mirror.rstrip("/") + urlsplit(file.url).path


def download(model: PublishedModel, store: WeightStore, progress: Progress, source: Source | None = None) -> None:
    """Fetch what is missing of a model; what is there and sound stays.

    Raises:
        PrerequisiteError: downloads are forbidden, the server cannot be reached, refuses, or breaks off; a later call goes on.
        UsageError: a file is not what was published; it is removed.
    """
    source = source or Source.default()
    store.folder(model).mkdir(parents=True, exist_ok=True)
    states = store.verify(model).files
    for file in model.files:
        if states[file.name] in (FileState.PRESENT, FileState.UNSEALED):
            continue
        stated = _fetch(source.address(file), file, store, model, progress)
        _accept(file, stated, store, model)


def _fetch(address: str, file: PublishedFile, store: WeightStore, model: PublishedModel, progress: Progress) -> str | None:
    """Bring the partial file to its end; the checksum that the server states, where it does."""
    partial = partial_of(store.path(model, file))
    have = partial.stat().st_size if partial.exists() else 0
    if file.size is not None and have > file.size:
        partial.unlink()
        have = 0
    if urlsplit(address).scheme not in ("http", "https"):
        raise UsageError(f"{address!r} is no web address: give a mirror that begins with https://.")
    request = urllib.request.Request(address, headers={"User-Agent": "spacevln"} | ({"Range": f"bytes={have}-"} if have else {}))  # noqa: S310
    redirects = _Redirects()
    try:
        with urllib.request.build_opener(redirects).open(request, timeout=TIMEOUT_S) as response:
            resumed = response.status == 206
            have = have if resumed else 0
            rest = response.headers.get("Content-Length")
            total = have + int(rest) if rest else file.size
            _check_space(file, store, None if total is None else total - have)
            with partial.open("ab" if resumed else "wb") as grown:
                progress(file.name, have, total)
                while block := response.read(CHUNK):
                    grown.write(block)
                    have += len(block)
                    progress(file.name, have, total)
            stated = response.headers.get(STATED) or redirects.stated
    except urllib.error.HTTPError as error:
        if error.code == RANGE_NOT_SATISFIABLE and have:  # the file was complete but not yet named
            return None
        raise PrerequisiteError(
            f"The server refuses {address} ({error.code} {error.reason}): try a mirror with --mirror, or fetch it by hand."
        ) from error
    except (OSError, HTTPException) as error:
        raise PrerequisiteError(
            f"The download of {address} broke off ({_reason(error)}): run the same command again to go on, or give --mirror."
        ) from error
    if total is not None and have != total:
        raise PrerequisiteError(
            f"The download of {address} ended after {have:,} of {total:,} bytes: run the same command again to go on."
        )
    match = _SHA256.match(stated or "")
    return match.group(1) if match else None


def _accept(file: PublishedFile, stated: str | None, store: WeightStore, model: PublishedModel) -> None:
    """Check a complete partial file, seal it and give it its name."""
    path = store.path(model, file)
    partial = partial_of(path)
    found, size, wanted = checksum(partial), partial.stat().st_size, file.sha256 or stated
    if (wanted is not None and found != wanted) or (file.size is not None and size != file.size):
        partial.unlink()
        raise UsageError(
            f"{file.name} of {model.name} is not what was published (SHA-256 {found[:12]}..., {size:,} bytes): it was removed; "
            "run the same command again, or try another --mirror."
        )
    store.seal(model, file, found, size)
    partial.replace(path)


def _check_space(file: PublishedFile, store: WeightStore, needed: int | None) -> None:
    free = shutil.disk_usage(store.root).free
    if needed is not None and free < needed:
        raise PrerequisiteError(
            f"{file.name} needs {needed:,} bytes and {str(store.root)!r} has {free:,}: free space, or name another folder by "
            "SPACEVLN_MODELS."
        )


def _reason(error: BaseException) -> str:
    reason = getattr(error, "reason", None) or error
    return str(reason) or type(reason).__name__


class _Redirects(urllib.request.HTTPRedirectHandler):
    """Follows redirects to storage, and keeps the checksum that a server on the way stated."""

    stated: str | None = None

    def redirect_request(self, *arguments: Any) -> urllib.request.Request | None:
        """The next request."""
        headers = arguments[4]
        self.stated = headers.get(STATED) or self.stated
        return super().redirect_request(*arguments)
