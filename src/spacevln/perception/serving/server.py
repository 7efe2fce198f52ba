"""The server's process: ``python -m spacevln.perception.serving.server SOCKET FACTORY SETTINGS``.

Started by the first client; ends by itself when it had no client for a while.
"""

from __future__ import annotations

import importlib
import json
import logging
import mmap
import os
import selectors
import socket
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from spacevln.core import PrerequisiteError, SpaceVLNError, UsageError
from spacevln.perception.open_vocabulary.detector import Image, ImageDetector
from spacevln.perception.serving.batching import MODEL_ERRORS, Batcher
from spacevln.perception.serving.wire import pack, receive, send

IDLE_S = 30.0
"""Without a client for so long, the server ends."""

log = logging.getLogger(__name__)


class DetectorServer:
    """Serves a detector on a Unix socket.

    Args:
        path: of the socket; its folder belongs to the user alone.
        detector: that does the work.
        max_images: per pass, over all clients.
        idle_s: without a client for so long, :meth:`run` returns.
    """

    def __init__(self, path: Path, detector: ImageDetector, max_images: int = 12, idle_s: float = IDLE_S) -> None:
        self._path, self._idle_s = path, idle_s
        self._batcher = Batcher(detector.detect_images, max_images)
        self._clients = 0
        self._is_retired = False
        self._lock = threading.Lock()
        path.unlink(missing_ok=True)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.bind(str(path))
        self._socket.listen(128)

    def run(self) -> None:
        """Serve until nobody has come for a while."""
        with selectors.DefaultSelector() as selector, self._socket:
            selector.register(self._socket, selectors.EVENT_READ)
            while selector.select(self._idle_s) or self._busy():
                self._socket.setblocking(False)
                try:
                    connection, _ = self._socket.accept()
                except BlockingIOError:
                    continue
                connection.setblocking(True)
                self._count(1)
                threading.Thread(target=self._serve, args=(connection,), daemon=True).start()
            self._path.unlink(missing_ok=True)
        self._batcher.close()

    def _busy(self) -> bool:
        with self._lock:
            return self._clients > 0

    def _count(self, change: int) -> None:
        with self._lock:
            self._clients += change

    def _serve(self, connection: socket.socket) -> None:
        memory: mmap.mmap | None = None
        try:
            with connection:
                while True:
                    header, _, descriptor = receive(connection)
                    if descriptor is not None:
                        memory = _mapped(descriptor)
                    self._answer(connection, header, memory)
        except (ConnectionError, ValueError, KeyError, TypeError) as error:
            log.info("a client left: %s", error)
        finally:
            self._count(-1)

    def _answer(self, connection: socket.socket, header: dict[str, Any], memory: mmap.mmap | None) -> None:
        images = _images(memory, [(int(height), int(width)) for height, width in header["sizes"]])
        try:
            found = self._batcher.submit(images, [str(phrase) for phrase in header["phrases"]]).result()
        except UsageError as error:
            send(connection, {"id": header["id"], "error": "usage", "message": str(error)})
        except PrerequisiteError as error:
            send(connection, {"id": header["id"], "error": "prerequisite", "message": str(error)})
        except MODEL_ERRORS as error:
            log.exception("detection failed")
            is_over = not self._batcher.is_alive
            if is_over:
                self._retire()
            send(connection, {"id": header["id"], "error": "failure", "message": f"{type(error).__name__}: {error}"})
            if is_over:
                os._exit(1)
        else:
            packed, bits = pack(found)
            send(connection, {"id": header["id"], "found": packed}, bits)

    def _retire(self) -> None:
        """A bug ended the detector: whoever connects from now on starts another server."""
        self._batcher.close()
        with self._lock:
            if not self._is_retired:
                self._path.unlink(missing_ok=True)
            self._is_retired = True


def _mapped(descriptor: int) -> mmap.mmap:
    try:
        return mmap.mmap(descriptor, 0, prot=mmap.PROT_READ)
    finally:
        os.close(descriptor)


def _images(memory: mmap.mmap | None, sizes: list[tuple[int, int]]) -> list[Image]:
    """Views of the client's memory; it waits for the answer before it writes again."""
    images, at = [], 0
    for height, width in sizes:
        if memory is None or min(height, width) < 1 or at + height * width * 3 > len(memory):
            raise ValueError("the images are larger than the memory")
        images.append(np.frombuffer(memory, np.uint8, height * width * 3, at).reshape(height, width, 3))
        at += height * width * 3
    return images


def made(factory: str, settings: dict[str, Any]) -> ImageDetector:
    """What a factory, named ``module:function``, makes of settings."""
    module, _, name = factory.partition(":")
    make: Callable[..., ImageDetector] = getattr(importlib.import_module(module), name)
    return make(**settings)


def main(arguments: list[str]) -> int:
    """Open the detector, then the socket: whoever can connect is served."""
    logging.basicConfig(level=logging.WARNING, format="%(message)s", stream=sys.stderr)
    path, factory, settings = arguments
    try:
        detector = made(factory, json.loads(settings))
    except SpaceVLNError as error:
        log.error("%s", error)
        return 3 if isinstance(error, PrerequisiteError) else 2
    DetectorServer(Path(path), detector).run()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
