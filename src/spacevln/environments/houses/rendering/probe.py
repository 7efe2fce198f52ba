"""Which graphics library can be used here. Asks the library itself, without PyOpenGL, which can be bound to one platform only."""

from __future__ import annotations

import ctypes
import ctypes.util
import os
from dataclasses import dataclass
from typing import Literal

Backend = Literal["egl", "osmesa"]

INSTALL_HINT = "sudo apt-get install --no-install-recommends libegl1 libgl1 (or libosmesa6)"

_EGL_PLATFORM_DEVICE_EXT = 0x313F
_OFF = ("disable", "disabled", "off", "false", "0")


@dataclass(frozen=True, slots=True)
class Probe:
    """What was found.

    Args:
        backend: the library to render with; None when there is none.
        reason: one clause that says why.
    """

    backend: Backend | None
    reason: str


def _egl_problem() -> str:
    """Why EGL cannot be used; empty when a display on a device can be opened."""
    name = ctypes.util.find_library("EGL")
    if name is None:
        return "libEGL is not installed"
    try:
        egl = ctypes.CDLL(name)
    except OSError as error:
        return f"libEGL cannot be loaded ({error})"
    egl.eglGetProcAddress.restype = ctypes.c_void_p
    address = {f: egl.eglGetProcAddress(f) for f in (b"eglQueryDevicesEXT", b"eglGetPlatformDisplayEXT")}
    if not all(address.values()):
        return "libEGL lacks the device platform"
    query_devices = ctypes.CFUNCTYPE(ctypes.c_uint, ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(
        address[b"eglQueryDevicesEXT"] or 0
    )
    platform_display = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_uint, ctypes.c_void_p, ctypes.c_void_p)(
        address[b"eglGetPlatformDisplayEXT"] or 0
    )
    egl.eglInitialize.argtypes = (ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
    devices, count = (ctypes.c_void_p * 16)(), ctypes.c_int(0)
    if not query_devices(16, devices, ctypes.byref(count)) or count.value == 0:
        return "EGL knows no device"
    for device in devices[: count.value]:
        display = platform_display(_EGL_PLATFORM_DEVICE_EXT, device, None)
        if display and egl.eglInitialize(display, None, None):
            return ""
    return "no EGL device can be opened"


def _osmesa_problem() -> str:
    """Why OSMesa cannot be used; empty when a context can be made."""
    name = ctypes.util.find_library("OSMesa")
    if name is None:
        return "libOSMesa is not installed"
    try:
        osmesa = ctypes.CDLL(name)
    except OSError as error:
        return f"libOSMesa cannot be loaded ({error})"
    osmesa.OSMesaCreateContextExt.restype = ctypes.c_void_p
    osmesa.OSMesaDestroyContext.argtypes = (ctypes.c_void_p,)
    rgba, depth_bits, stencil_bits = 0x1908, 24, 8
    context = osmesa.OSMesaCreateContextExt(rgba, depth_bits, stencil_bits, 0, None)
    if not context:
        return "OSMesa makes no context"
    osmesa.OSMesaDestroyContext(context)
    return ""


def probe_gl() -> Probe:
    """The graphics library to render with: EGL, else OSMesa, else none. ``MUJOCO_GL`` set by the user is obeyed."""
    wish = os.environ.get("MUJOCO_GL", "").strip().lower()
    if wish in _OFF:
        return Probe(None, f"MUJOCO_GL={wish} switches it off")
    order: tuple[Backend, ...] = ("osmesa",) if wish == "osmesa" else ("egl",) if wish == "egl" else ("egl", "osmesa")
    problems = []
    for backend in order:
        problem = _egl_problem() if backend == "egl" else _osmesa_problem()
        if not problem:
            return Probe(backend, f"{'EGL' if backend == 'egl' else 'OSMesa'} works")
        problems.append(problem)
    return Probe(None, " and ".join(problems))
