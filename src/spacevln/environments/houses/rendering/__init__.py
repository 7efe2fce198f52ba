"""Pictures of a house: OpenGL where there is a library for it, ray casting elsewhere."""

from spacevln.environments.houses.rendering.body import DrawnBody
from spacevln.environments.houses.rendering.choice import RendererInfo, RendererName, make_renderer, renderer_info
from spacevln.environments.houses.rendering.gl import GLRenderer
from spacevln.environments.houses.rendering.probe import probe_gl
from spacevln.environments.houses.rendering.protocol import NEAR_M, RANGE_M, Drawable, Frame, Renderer
from spacevln.environments.houses.rendering.raycast import RaycastRenderer

__all__ = [
    "NEAR_M",
    "RANGE_M",
    "Drawable",
    "DrawnBody",
    "Frame",
    "GLRenderer",
    "RaycastRenderer",
    "Renderer",
    "RendererInfo",
    "RendererName",
    "make_renderer",
    "probe_gl",
    "renderer_info",
]
