"""Rendering with OpenGL: MuJoCo's classic renderer on EGL or OSMesa (software is enough)."""

from __future__ import annotations

import atexit
import math
import os
from typing import Any

import mujoco
import numpy as np

from spacevln.core.errors import EnvironmentFailure, PrerequisiteError
from spacevln.core.geometry import Float
from spacevln.core.sensing import Camera
from spacevln.environments.houses.rendering.culling import Visibility, geom_bounds
from spacevln.environments.houses.rendering.pixels import depth_from_buffer, ids_from_buffer
from spacevln.environments.houses.rendering.probe import INSTALL_HINT, Backend
from spacevln.environments.houses.rendering.protocol import NEAR_M, RANGE_M, Drawable, Frame

_FAR_M = 60.0
_HIDDEN_GROUP = 5


class _Context:
    """The GL context of this process, shared by its renderers; a forked child makes an own one."""

    def __init__(self, backend: Backend) -> None:
        if backend == "egl":
            from mujoco.egl import GLContext
        else:
            from mujoco.osmesa import GLContext
        self.process = os.getpid()
        self._gl = GLContext(64, 64)
        self.make_current()

    def make_current(self) -> None:
        self._gl.make_current()

    def free(self) -> None:
        if self.process == os.getpid():
            self._gl.free()


_contexts: list[_Context] = []
_renderers: list[GLRenderer] = []


def _free_all() -> None:
    """At exit, before the display goes: else MuJoCo and EGL complain."""
    for renderer in _renderers:
        renderer.close()
    while _contexts:
        _contexts.pop().free()


def _unusable(backend: Backend, error: Exception) -> PrerequisiteError:
    return PrerequisiteError(
        f"The graphics library {backend!r} cannot be used ({error}): install it with `{INSTALL_HINT}`, "
        "or set SPACEVLN_RENDERER=raycast."
    )


def try_backend(backend: Backend) -> None:
    """Make the context and draw nothing with it.

    Raises:
        PrerequisiteError: it does not work.
    """
    _context(backend).make_current()
    model = mujoco.MjSpec().compile()
    try:
        mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50.value).free()
    except mujoco.FatalError as error:
        raise _unusable(backend, error) from error


def _context(backend: Backend) -> _Context:
    if _contexts and _contexts[-1].process != os.getpid():
        _contexts.clear()
        _renderers.clear()
    if not _contexts:
        try:
            _contexts.append(_Context(backend))
        except (ImportError, AttributeError, OSError, RuntimeError) as error:
            raise _unusable(backend, error) from error
        atexit.register(_free_all)
    return _contexts[-1]


class GLRenderer:
    """MuJoCo's classic renderer: RGB and depth in one pass, instance ids in a second, only of what can be seen.

    Args:
        drawable: what to draw. Its model's rendering settings (buffer size, clip planes, geom groups) become this renderer's.
        backend: as found by :func:`probe.probe_gl`.
        width_px, height_px: largest image.

    Raises:
        PrerequisiteError: the graphics library cannot be used.
    """

    name = "gl"

    def __init__(self, drawable: Drawable, backend: Backend, width_px: int, height_px: int) -> None:
        self._model = model = drawable.model
        model.vis.global_.offwidth, model.vis.global_.offheight = width_px, height_px
        model.vis.quality.offsamples = 0
        model.stat.extent = 1.0
        model.vis.map.znear, model.vis.map.zfar = NEAR_M, _FAR_M
        self._data = mujoco.MjData(model)
        mujoco.mj_forward(model, self._data)
        self._instance = drawable.geom_instance
        self._visibility = Visibility(drawable.house, *geom_bounds(model))
        self._drawn = model.geom_rgba[:, 3] > 0
        self._scene = mujoco.MjvScene(model, maxgeom=model.ngeom + 16)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
        self._scene.flags[mujoco.mjtRndFlag.mjRND_REFLECTION] = False
        self._option = mujoco.MjvOption()
        self._option.geomgroup[:] = 1
        self._option.geomgroup[_HIDDEN_GROUP] = 0
        self._view = mujoco.MjvCamera()
        self._gl: _Context | None = _context(backend)
        self._gl.make_current()
        try:
            self._mjr: Any = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_50.value)
        except mujoco.FatalError as error:
            raise _unusable(backend, error) from error
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._mjr)
        self._mjr.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
        _renderers.append(self)

    def render(self, T_world_camera: Float, camera: Camera) -> Frame:
        """See :class:`protocol.Renderer`."""
        if self._gl is None:
            raise EnvironmentFailure("The renderer was closed: make a new one.")
        self._gl.make_current()
        geoms = self._update_scene(T_world_camera, camera)
        size = (camera.height_px, camera.width_px)
        rect = mujoco.MjrRect(0, 0, camera.width_px, camera.height_px)
        colours, depths = np.empty((*size, 3), np.uint8), np.empty(size, np.float32)
        mujoco.mjr_render(rect, self._scene, self._mjr)
        mujoco.mjr_readPixels(colours, depths, rect, self._mjr)
        rgb = np.ascontiguousarray(colours[::-1])
        depth_m = np.empty(size, np.float32)
        depth_from_buffer(depths, NEAR_M, _FAR_M, RANGE_M, depth_m)
        flags = self._scene.flags
        flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = True
        mujoco.mjr_render(rect, self._scene, self._mjr)
        mujoco.mjr_readPixels(colours, None, rect, self._mjr)
        flags[mujoco.mjtRndFlag.mjRND_SEGMENT] = flags[mujoco.mjtRndFlag.mjRND_IDCOLOR] = False
        table = np.zeros(len(geoms) + 1, np.int32)
        table[1:] = self._instance[geoms]
        instance_ids = np.empty(size, np.int32)
        ids_from_buffer(colours, table, instance_ids)
        return Frame(rgb, depth_m, instance_ids)

    def _update_scene(self, T_world_camera: Float, camera: Camera) -> np.ndarray[Any, Any]:
        """Put what can be seen into the scene and set its camera; returns the geoms' ids in the scene's order."""
        x, y, z = (float(v) for v in T_world_camera[:3, 3])
        forward, up = T_world_camera[:3, 0], T_world_camera[:3, 2]
        half_fov = math.atan(max(camera.cx_px, camera.width_px - camera.cx_px) / camera.fx_px)
        if abs(float(forward[2])) > 1e-6:  # a tilted camera sees to all sides of its feet
            half_fov = math.pi
        shown = self._visibility.visible(x, y, z, math.atan2(forward[1], forward[0]), half_fov) & self._drawn
        self._model.geom_group[:] = np.where(shown, 0, _HIDDEN_GROUP)
        category = mujoco.mjtCatBit.mjCAT_ALL.value
        mujoco.mjv_updateScene(self._model, self._data, self._option, None, self._view, category, self._scene)
        for eye in self._scene.camera:
            eye.pos[:], eye.forward[:], eye.up[:] = (x, y, z), forward, up
            eye.frustum_near, eye.frustum_far = NEAR_M, _FAR_M
            eye.frustum_top = NEAR_M * camera.cy_px / camera.fy_px
            eye.frustum_bottom = -NEAR_M * (camera.height_px - camera.cy_px) / camera.fy_px
            # The horizontal extent follows from the image's aspect; only its centre is given.
            eye.frustum_center = NEAR_M * (camera.width_px / 2 - camera.cx_px) / camera.fx_px
        for light in self._scene.lights[: self._scene.nlight]:
            if light.headlight:
                light.pos[:], light.dir[:] = (x, y, z), forward
        return np.flatnonzero(shown)

    def close(self) -> None:
        """Free the context's share of this house."""
        if self._gl is None:
            return
        if self._gl.process == os.getpid():
            self._gl.make_current()
            self._mjr.free()
        self._gl = None
        if self in _renderers:
            _renderers.remove(self)
