"""Rendering with OpenGL on EGL or OSMesa (software is enough): colour, depth and instance ids in one pass."""

from __future__ import annotations

import atexit
import ctypes
import os
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spacevln.core.errors import EnvironmentFailure, PrerequisiteError, UsageError
from spacevln.core.geometry import Float
from spacevln.core.sensing import Camera
from spacevln.environments.houses.rendering.culling import Visibility
from spacevln.environments.houses.rendering.probe import INSTALL_HINT, Backend
from spacevln.environments.houses.rendering.protocol import NEAR_M, RANGE_M, Drawable, Frame
from spacevln.environments.houses.rendering.shaders import ATTRIBUTES, FRAGMENT_SHADER, OUTPUTS, SKY, VERTEX_SHADER
from spacevln.environments.houses.rendering.triangles import LAYER_PX, VERTEX, triangles_of

_FAR_M = 60.0


class _Context:
    """The GL context of this process with the shader, shared by its renderers."""

    def __init__(self, backend: Backend) -> None:
        # Importing one of these binds PyOpenGL to that platform, so OpenGL itself comes after it.
        if backend == "egl":
            from mujoco.egl import GLContext
        else:
            from mujoco.osmesa import GLContext
        from OpenGL import GL, error  # type: ignore[import-untyped]

        self.process = os.getpid()
        self.gl: ModuleType = GL
        self.failure: type[Exception] = error.Error
        try:
            self._context = GLContext(64, 64)
            self.make_current()
            self.program = self._linked()
        except error.Error as failure:
            raise RuntimeError(str(failure)) from failure

    def _linked(self) -> int:
        gl = self.gl
        program = gl.glCreateProgram()
        for kind, source in ((gl.GL_VERTEX_SHADER, VERTEX_SHADER), (gl.GL_FRAGMENT_SHADER, FRAGMENT_SHADER)):
            shader = gl.glCreateShader(kind)
            gl.glShaderSource(shader, source.strip())
            gl.glCompileShader(shader)
            gl.glAttachShader(program, shader)
        for k, name in enumerate(ATTRIBUTES):
            gl.glBindAttribLocation(program, k, name)
        for k, name in enumerate(OUTPUTS):
            gl.glBindFragDataLocation(program, k, name)
        gl.glLinkProgram(program)
        if not gl.glGetProgramiv(program, gl.GL_LINK_STATUS):
            raise RuntimeError(f"its shader compiler says: {gl.glGetProgramInfoLog(program)!r}")
        return int(program)

    def check_process(self) -> None:
        if self.process != os.getpid():
            raise EnvironmentFailure(
                "OpenGL was used before this process was forked off: start worker processes with the 'spawn' method of "
                "multiprocessing, or set SPACEVLN_RENDERER=raycast."
            )

    def make_current(self) -> None:
        self.check_process()
        self._context.make_current()

    def free(self) -> None:
        if self.process == os.getpid():
            self._context.free()


_contexts: list[_Context] = []
_renderers: list[GLRenderer] = []


def _free_all() -> None:
    """At exit, before the display goes: else EGL complains."""
    for renderer in _renderers:
        renderer.close()
    while _contexts:
        _contexts.pop().free()


def shared_context(backend: Backend) -> _Context:
    """The context of this process.

    Raises:
        PrerequisiteError: the graphics library does not work.
        EnvironmentFailure: it was already used before this process was forked off, which graphics libraries do not survive.
    """
    if not _contexts:
        try:
            _contexts.append(_Context(backend))
        except (ImportError, AttributeError, OSError, RuntimeError) as error:
            raise PrerequisiteError(
                f"The graphics library {backend!r} cannot be used ({error}): install it with `{INSTALL_HINT}`, "
                "or set SPACEVLN_RENDERER=raycast."
            ) from error
        atexit.register(_free_all)
    _contexts[-1].check_process()
    return _contexts[-1]


class GLRenderer:
    """All triangles of the house lie in one buffer; of them, the visible geoms are drawn, near ones first, in one call.

    Args:
        drawable: what to draw.
        backend: as found by :func:`probe.probe_gl`.
        width_px, height_px: size of the images.

    Raises:
        PrerequisiteError: the graphics library cannot be used.
    """

    name = "gl"

    def __init__(self, drawable: Drawable, backend: Backend, width_px: int, height_px: int) -> None:
        self._context: _Context | None = shared_context(backend)
        self._context.make_current()
        self._size = (height_px, width_px)
        soup = triangles_of(drawable.model, drawable.geom_instance)
        self._visibility = Visibility.of(drawable)
        self._count, self._offset = soup.count, soup.first.astype(np.uint64) * 4
        self._transparent = soup.transparent
        self._upload(self._context.gl, soup)
        self._make_target(self._context.gl)
        _renderers.append(self)

    def _upload(self, gl: Any, soup: Any) -> None:
        self._arrays = gl.glGenVertexArrays(1)
        gl.glBindVertexArray(self._arrays)
        self._buffers = gl.glGenBuffers(2)
        gl.glBindBuffer(gl.GL_ARRAY_BUFFER, self._buffers[0])
        gl.glBufferData(gl.GL_ARRAY_BUFFER, soup.vertices.nbytes, soup.vertices, gl.GL_STATIC_DRAW)
        gl.glBindBuffer(gl.GL_ELEMENT_ARRAY_BUFFER, self._buffers[1])
        gl.glBufferData(gl.GL_ELEMENT_ARRAY_BUFFER, soup.indices.nbytes, soup.indices, gl.GL_STATIC_DRAW)
        columns = (
            ("position", 3, gl.GL_FLOAT, False),
            ("normal", 3, gl.GL_FLOAT, False),
            ("uv", 2, gl.GL_FLOAT, False),
            ("rgba", 4, gl.GL_UNSIGNED_BYTE, True),
            ("layer", 4, gl.GL_UNSIGNED_BYTE, True),  # layer, emission, shine, padding
        )
        for k, (name, width, kind, normalised) in enumerate(columns):
            gl.glEnableVertexAttribArray(k)
            gl.glVertexAttribPointer(k, width, kind, normalised, VERTEX.itemsize, ctypes.c_void_p(_field(name)))
        last = len(columns)
        gl.glEnableVertexAttribArray(last)
        gl.glVertexAttribIPointer(last, 1, gl.GL_INT, VERTEX.itemsize, ctypes.c_void_p(_field("instance")))
        self._texture = gl.glGenTextures(1)
        gl.glBindTexture(gl.GL_TEXTURE_2D_ARRAY, self._texture)
        gl.glPixelStorei(gl.GL_UNPACK_ALIGNMENT, 1)
        shape = (LAYER_PX, LAYER_PX, len(soup.layers))
        gl.glTexImage3D(gl.GL_TEXTURE_2D_ARRAY, 0, gl.GL_RGB8, *shape, 0, gl.GL_RGB, gl.GL_UNSIGNED_BYTE, soup.layers)
        gl.glTexParameteri(gl.GL_TEXTURE_2D_ARRAY, gl.GL_TEXTURE_MIN_FILTER, gl.GL_LINEAR_MIPMAP_NEAREST)
        gl.glTexParameteri(gl.GL_TEXTURE_2D_ARRAY, gl.GL_TEXTURE_MAG_FILTER, gl.GL_LINEAR)
        gl.glGenerateMipmap(gl.GL_TEXTURE_2D_ARRAY)

    def _make_target(self, gl: Any) -> None:
        height, width = self._size
        self._target = gl.glGenFramebuffers(1)
        self._planes = gl.glGenRenderbuffers(4)
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, self._target)
        attached = [gl.GL_COLOR_ATTACHMENT0 + k for k in range(3)]
        places = [*attached, gl.GL_DEPTH_ATTACHMENT]
        formats = (gl.GL_RGBA8, gl.GL_R32F, gl.GL_R32I, gl.GL_DEPTH_COMPONENT32F)
        for plane, place, layout in zip(self._planes, places, formats, strict=True):
            gl.glBindRenderbuffer(gl.GL_RENDERBUFFER, plane)
            gl.glRenderbufferStorage(gl.GL_RENDERBUFFER, layout, width, height)
            gl.glFramebufferRenderbuffer(gl.GL_FRAMEBUFFER, place, gl.GL_RENDERBUFFER, plane)
        gl.glDrawBuffers(3, attached)
        if gl.glCheckFramebufferStatus(gl.GL_FRAMEBUFFER) != gl.GL_FRAMEBUFFER_COMPLETE:
            raise PrerequisiteError(
                f"The graphics library cannot draw into float and integer buffers: install a newer one with `{INSTALL_HINT}`, "
                "or set SPACEVLN_RENDERER=raycast."
            )

    def render(self, T_world_camera: Float, camera: Camera) -> Frame:
        """See :class:`protocol.Renderer`."""
        if self._context is None:
            raise EnvironmentFailure("The renderer was closed: make a new one.")
        if (camera.height_px, camera.width_px) != self._size:
            height, width = self._size
            raise UsageError(f"This renderer draws {width}x{height} px, the camera has {camera.width_px}x{camera.height_px}.")
        gl = self._context.gl
        try:
            self._context.make_current()
            self._begin(gl, self._context.program, T_world_camera, camera)
            self._draw(gl, self._visibility.near_first(T_world_camera, camera))
            return self._read(gl)
        except self._context.failure as error:
            raise EnvironmentFailure(
                f"OpenGL failed while drawing ({error}): SPACEVLN_RENDERER=raycast does without it."
            ) from error

    def _begin(self, gl: Any, program: int, T_world_camera: Float, camera: Camera) -> None:
        gl.glBindFramebuffer(gl.GL_FRAMEBUFFER, self._target)
        gl.glViewport(0, 0, camera.width_px, camera.height_px)
        gl.glUseProgram(program)
        gl.glBindVertexArray(self._arrays)
        gl.glActiveTexture(gl.GL_TEXTURE0)
        gl.glBindTexture(gl.GL_TEXTURE_2D_ARRAY, self._texture)
        gl.glEnable(gl.GL_DEPTH_TEST)
        gl.glEnable(gl.GL_CULL_FACE)
        gl.glFrontFace(gl.GL_CW)  # the image is drawn upside down, so that its first row is read first
        gl.glDepthMask(gl.GL_TRUE)
        matrix = np.ascontiguousarray(clip_from_scene(T_world_camera, camera), np.float32)
        gl.glUniformMatrix4fv(gl.glGetUniformLocation(program, "clip_from_scene"), 1, gl.GL_TRUE, matrix)
        gl.glUniform3f(gl.glGetUniformLocation(program, "eye"), *(float(v) for v in T_world_camera[:3, 3]))
        gl.glUniform3f(gl.glGetUniformLocation(program, "axis"), *(float(v) for v in T_world_camera[:3, 0]))
        gl.glUniform1f(gl.glGetUniformLocation(program, "range"), RANGE_M)
        gl.glClearBufferfv(gl.GL_COLOR, 0, np.array(SKY, np.float32))
        gl.glClearBufferfv(gl.GL_COLOR, 1, np.zeros(4, np.float32))
        gl.glClearBufferiv(gl.GL_COLOR, 2, np.zeros(4, np.int32))
        gl.glClearBufferfv(gl.GL_DEPTH, 0, np.ones(1, np.float32))

    def _draw(self, gl: Any, shown: NDArray[np.int64]) -> None:
        """Opaque geoms from near to far, then transparent ones from far to near over them."""
        clear = self._transparent[shown]
        self._draw_geoms(gl, shown[~clear])
        if clear.any():
            gl.glEnablei(gl.GL_BLEND, 0)
            gl.glBlendFunc(gl.GL_SRC_ALPHA, gl.GL_ONE_MINUS_SRC_ALPHA)
            self._draw_geoms(gl, shown[clear][::-1])
            gl.glDisablei(gl.GL_BLEND, 0)

    def _draw_geoms(self, gl: Any, geoms: NDArray[np.int64]) -> None:
        if len(geoms) == 0:
            return
        counts, offsets = self._count[geoms], self._offset[geoms]
        pointers = offsets.ctypes.data_as(ctypes.POINTER(ctypes.c_void_p))
        gl.glMultiDrawElements(gl.GL_TRIANGLES, counts, gl.GL_UNSIGNED_INT, pointers, len(geoms))

    def _read(self, gl: Any) -> Frame:
        height, width = self._size
        rgb, depth_m = np.empty((height, width, 3), np.uint8), np.empty((height, width), np.float32)
        instance_ids = np.empty((height, width), np.int32)
        gl.glPixelStorei(gl.GL_PACK_ALIGNMENT, 1)
        planes = (
            (rgb, gl.GL_RGB, gl.GL_UNSIGNED_BYTE),
            (depth_m, gl.GL_RED, gl.GL_FLOAT),
            (instance_ids, gl.GL_RED_INTEGER, gl.GL_INT),
        )
        for k, (plane, layout, kind) in enumerate(planes):
            gl.glReadBuffer(gl.GL_COLOR_ATTACHMENT0 + k)
            gl.glReadPixels(0, 0, width, height, layout, kind, plane)
        return Frame(rgb, depth_m, instance_ids)

    def close(self) -> None:
        """Free this house's buffers."""
        if self._context is None:
            return
        if self._context.process == os.getpid():
            self._context.make_current()
            gl = self._context.gl
            gl.glDeleteVertexArrays(1, [self._arrays])
            gl.glDeleteBuffers(2, self._buffers)
            gl.glDeleteTextures(1, [self._texture])
            gl.glDeleteRenderbuffers(4, self._planes)
            gl.glDeleteFramebuffers(1, [self._target])
        self._context = None
        if self in _renderers:
            _renderers.remove(self)


def _field(name: str) -> int:
    """Byte offset of a vertex attribute."""
    return sum(VERTEX[field].itemsize for field in (VERTEX.names or ())[: (VERTEX.names or ()).index(name)])


def clip_from_scene(T_world_camera: Float, camera: Camera) -> Float:
    """Projection (4, 4) from the scene to clip space, with the image's rows from top to bottom."""
    to_camera = np.linalg.inv(T_world_camera)
    # optical axes: right, down, ahead
    optical = np.array([[0.0, -1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    near, far, w, h = NEAR_M, _FAR_M, camera.width_px, camera.height_px
    project = np.array(
        [
            [2 * camera.fx_px / w, 0.0, 2 * camera.cx_px / w - 1, 0.0],
            [0.0, 2 * camera.fy_px / h, 2 * camera.cy_px / h - 1, 0.0],
            [0.0, 0.0, (far + near) / (far - near), -2 * far * near / (far - near)],
            [0.0, 0.0, 1.0, 0.0],
        ]
    )
    return np.asarray(project @ optical @ to_camera, np.float64)
