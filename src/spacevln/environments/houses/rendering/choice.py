"""Which renderer is used here, and why: the one place that reads ``SPACEVLN_RENDERER``."""

from __future__ import annotations

import functools
import logging
import os
from dataclasses import dataclass
from typing import Literal, get_args

from spacevln.core.errors import PrerequisiteError, UnknownNameError
from spacevln.environments.houses.rendering.gl import GLRenderer, shared_context
from spacevln.environments.houses.rendering.probe import INSTALL_HINT, Backend, Probe, probe_gl
from spacevln.environments.houses.rendering.protocol import Drawable, Renderer
from spacevln.environments.houses.rendering.raycast import RaycastRenderer

_log = logging.getLogger("spacevln.houses")

RendererName = Literal["auto", "gl", "raycast"]


@dataclass(frozen=True, slots=True)
class RendererInfo:
    """What draws the houses on this machine.

    Args:
        name: ``"gl"`` or ``"raycast"``.
        backend: graphics library, None for ray casting.
        reason: one sentence.
        install: the command that would bring OpenGL; empty when nothing is missing.
    """

    name: Literal["gl", "raycast"]
    backend: Backend | None
    reason: str
    install: str = ""


@functools.cache
def _probe() -> Probe:
    probe = probe_gl()
    if probe.backend is not None:
        try:
            shared_context(probe.backend)
        except PrerequisiteError as error:
            return Probe(None, f"{probe.backend} fails ({error.__cause__})")
    return probe


def renderer_info(wish: str = "auto") -> RendererInfo:
    """The renderer for a wish; the environment variable ``SPACEVLN_RENDERER`` decides where the wish is ``"auto"``.

    Raises:
        UnknownNameError: the wish or the variable names no renderer.
        PrerequisiteError: OpenGL is demanded and there is none.
    """
    source = "asked for"
    if wish == "auto":
        wish, source = os.environ.get("SPACEVLN_RENDERER", "") or "auto", "SPACEVLN_RENDERER asks for it"
    if wish not in get_args(RendererName):
        raise UnknownNameError("renderer", wish, get_args(RendererName))
    if wish == "raycast":
        return RendererInfo("raycast", None, f"Ray casting: {source}.")
    probe = _probe()
    if probe.backend is not None:
        return RendererInfo("gl", probe.backend, f"OpenGL: {probe.reason}.")
    if wish == "gl":
        raise PrerequisiteError(f"OpenGL cannot be used here ({probe.reason}): install it with `{INSTALL_HINT}`.")
    return RendererInfo("raycast", None, f"Ray casting, because {probe.reason}.", INSTALL_HINT)


@functools.cache
def _say_once(info: RendererInfo) -> None:
    _log.warning("%s Pictures are 320x240; to mend it: %s", info.reason, info.install)


def make_renderer(info: RendererInfo, drawable: Drawable, width_px: int, height_px: int) -> Renderer:
    """A renderer for one house.

    Args:
        info: from :func:`renderer_info`.
        drawable: what to draw.
        width_px, height_px: largest image.

    Raises:
        PrerequisiteError: the graphics library cannot be used after all.
    """
    if info.install:
        _say_once(info)
    if info.backend is not None:
        return GLRenderer(drawable, info.backend, width_px, height_px)
    return RaycastRenderer(drawable)
