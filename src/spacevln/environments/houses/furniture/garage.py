"""Vehicles, tools and what stands outdoors."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, kind, looks

HALF_PI = np.pi / 2


@kind(
    "bicycle",
    looks(
        ("red", "gloss-red", "plain-black"),
        ("blue", "gloss-blue", "plain-black"),
        ("green", "gloss-green", "plain-black"),
        ("white", "gloss-white", "plain-black"),
    ),
)
def _bicycle(k: Kit, look: Look) -> None:
    m = look.main
    for x in (-0.54, 0.54):
        k.mesh("thinring", look.trim, 0.66, 0.05, 0.66, x=x)
        k.bar("gloss-silver", 0.04, 0.08, x=x, z=0.33, along="y")
        for i in range(3):
            k.rod("plain-silver", 0.004, 0.6, x=x, z=0.03, turn=(0, i * np.pi / 3, 0))

    def tube(x0: float, z0: float, x1: float, z1: float, stuff: str = m, r: float = 0.02) -> None:
        length = float(np.hypot(x1 - x0, z1 - z0))
        k.rod(stuff, r, length, x=(x0 + x1) / 2, z=(z0 + z1) / 2 - length / 2, turn=(0, float(np.arctan2(x1 - x0, z1 - z0)), 0))

    tube(-0.1, 0.3, -0.2, 0.82)
    tube(-0.1, 0.3, 0.36, 0.78)
    tube(-0.18, 0.74, 0.34, 0.84)
    tube(-0.54, 0.33, -0.1, 0.3)
    tube(-0.54, 0.33, -0.18, 0.72)
    tube(0.54, 0.33, 0.32, 0.98)
    k.mesh("pillow", "plain-black", 0.26, 0.14, 0.07, x=-0.22, z=0.82)
    k.bar("plain-charcoal", 0.016, 0.5, x=0.32, z=0.98, along="y")
    k.bar("gloss-silver", 0.09, 0.02, x=-0.1, z=0.3, along="y")
    for s in (-1, 1):
        k.box("plain-black", 0.12, 0.07, 0.02, x=-0.1 + s * 0.1, y=s * 0.1, z=0.3 - s * 0.12)
        k.bar("plain-black", 0.02, 0.1, x=0.32, y=s * 0.22, z=0.98, along="y")


@kind(
    "car",
    looks(
        ("red", "gloss-red", "gloss-silver"),
        ("blue", "gloss-blue", "gloss-silver"),
        ("white", "gloss-white", "gloss-black"),
        ("black", "gloss-black", "gloss-silver"),
        ("yellow", "gloss-yellow", "gloss-black"),
    ),
)
def _car(k: Kit, look: Look) -> None:
    w, d = 1.62, 3.3
    glass = "gloss-navy" if look.main != "gloss-black" else "gloss-gray"
    k.mesh("car", look.main, w, d, 0.66, z=0.2)
    k.box("plain-black", w - 0.42, d - 0.5, 0.44, z=0.22)
    k.mesh("cabin", look.main, 1.9, w - 0.16, 0.56, y=-0.15, z=0.8, turn=(0, 0, HALF_PI))
    k.mesh("cabin", glass, 1.94, w - 0.28, 0.545, y=-0.15, z=0.8, turn=(0, 0, HALF_PI))
    k.mesh("cabin", glass, 1.56, w - 0.15, 0.42, y=-0.16, z=0.86, turn=(0, 0, HALF_PI))
    k.box(look.main, w - 0.16, 1.01, 0.05, y=-0.23, z=1.34)
    for s in (-1, 1):
        k.box(look.main, 0.04, 0.07, 0.5, x=s * (w / 2 - 0.09), y=-0.2, z=0.84)
        for t in (-1, 1):
            k.bar("plain-black", 0.3, 0.2, x=s * (w / 2 - 0.1), y=t * 1.0, z=0.3)
            k.bar("gloss-silver", 0.18, 0.21, x=s * (w / 2 - 0.1), y=t * 1.0, z=0.3)
        k.ball("glow-lamp", 0.3, 0.12, 0.16, x=s * 0.56, y=d / 2 - 0.046, z=0.48)
        k.box("glow-red", 0.2, 0.06, 0.16, x=s * 0.64, y=-d / 2 + 0.04, z=0.5)
        k.box(look.main, 0.14, 0.1, 0.1, x=s * (w / 2 + 0.02), y=0.5, z=0.86)
    k.box("plain-black", 0.7, 0.05, 0.16, y=d / 2 - 0.016, z=0.44)
    k.box("plain-white", 0.4, 0.04, 0.1, y=d / 2 - 0.005, z=0.34)
    k.box("plain-white", 0.4, 0.06, 0.1, y=-d / 2 + 0.04, z=0.52)
    k.box(look.trim, w - 0.1, 0.1, 0.08, y=d / 2 - 0.06, z=0.27)
    k.box(look.trim, w - 0.1, 0.1, 0.08, y=-d / 2 + 0.06, z=0.27)


@kind(
    "workbench",
    looks(
        ("brown wooden", "wood-oak", "plain-red"),
        ("gray metal", "plain-gray", "plain-blue"),
        ("red", "plain-red", "plain-charcoal"),
    ),
    top_m=0.88,
)
def _workbench(k: Kit, look: Look) -> None:
    w, d = 1.5, 0.62
    k.legs(look.main, w - 0.06, d - 0.06, 0.82, 0.09)
    k.box(look.main, w, d, 0.06, z=0.82)
    k.box(look.main, w - 0.1, d - 0.1, 0.04, z=0.2)
    k.box("wood-pine", w, 0.03, 0.7, y=-d / 2 + 0.015, z=0.88)
    k.box(look.trim, 0.44, 0.22, 0.2, x=-0.4, z=0.24)
    k.box(look.trim, 0.3, 0.26, 0.28, x=0.3, z=0.24)
    y = -d / 2 + 0.045
    for i, stuff in enumerate(("plain-red", "plain-yellow", "plain-blue", "plain-black", "plain-red")):
        x = -0.56 + i * 0.26
        k.box(stuff, 0.035, 0.03, 0.17, x=x, y=y, z=1.06)
        k.box("gloss-silver", 0.02 if i % 2 else 0.14, 0.025, 0.18 if i % 2 else 0.05, x=x, y=y, z=1.23)
    k.box("gloss-charcoal", 0.14, 0.2, 0.16, x=0.58, y=0.16, z=0.88)
    k.bar("gloss-silver", 0.015, 0.2, x=0.58, y=0.3, z=0.98)
    k.box("plain-red", 0.36, 0.18, 0.16, x=-0.4, y=0.05, z=0.88)
    k.bar("plain-black", 0.014, 0.2, x=-0.4, y=0.05, z=1.07)


@kind(
    "ladder",
    looks(
        ("silver metal", "gloss-silver", "plain-red"),
        ("yellow", "plain-yellow", "plain-charcoal"),
        ("brown wooden", "wood-pine", "wood-pine"),
    ),
)
def _ladder(k: Kit, look: Look) -> None:
    for t in (-1, 1):
        for s in (-1, 1):
            k.box(look.main, 0.05, 0.03, 1.66, x=s * 0.22, y=t * 0.2, z=0.0, turn=(t * 0.24, 0, 0))
    for i in range(5):
        z = 0.28 + i * 0.28
        k.box(look.main, 0.44, 0.08, 0.03, y=0.405 - 0.245 * z, z=z)
    k.box(look.trim, 0.46, 0.16, 0.04, z=1.61)


@kind(
    "lawn mower",
    looks(
        ("red", "gloss-red", "plain-black"), ("green", "gloss-green", "plain-black"), ("orange", "gloss-orange", "plain-black")
    ),
)
def _lawn_mower(k: Kit, look: Look) -> None:
    k.mesh("cushion", look.main, 0.52, 0.66, 0.24, y=0.14, z=0.1)
    k.rod("plain-black", 0.16, 0.16, y=0.16, z=0.32)
    k.rod("gloss-silver", 0.1, 0.04, y=0.16, z=0.48)
    for s in (-1, 1):
        for y in (-0.1, 0.38):
            k.bar("plain-black", 0.12, 0.07, x=s * 0.27, y=y, z=0.12)
            k.bar("gloss-silver", 0.05, 0.08, x=s * 0.27, y=y, z=0.12)
        k.rod(look.trim, 0.016, 0.92, x=s * 0.22, y=-0.36, z=0.16, turn=(0.7, 0, 0))
    k.bar("plain-charcoal", 0.02, 0.46, y=-0.65, z=0.96)
    k.mesh("cushion", "fabric-charcoal", 0.42, 0.4, 0.32, y=-0.34, z=0.12)


@kind(
    "grill",
    looks(
        ("black", "gloss-black", "gloss-silver"),
        ("red", "gloss-red", "gloss-silver"),
        ("silver metal", "gloss-silver", "plain-black"),
    ),
)
def _grill(k: Kit, look: Look) -> None:
    k.mesh("bowl", look.main, 0.56, 0.56, 0.26, z=0.6)
    k.mesh("pillow", look.main, 0.57, 0.57, 0.4, z=0.68)
    k.rod(look.trim, 0.288, 0.02, z=0.865)
    k.box("plain-black", 0.2, 0.03, 0.03, y=0.26, z=1.0)
    k.ball("plain-black", 0.06, 0.06, 0.06, z=1.07)
    for i in range(3):
        a = i * 2 * np.pi / 3 + 0.5
        k.rod(
            look.trim,
            0.014,
            0.68,
            x=0.2 * np.cos(a),
            y=0.2 * np.sin(a),
            turn=(-0.2 * float(np.sin(a)), 0.2 * float(np.cos(a)), 0),
        )
    k.rod(look.trim, 0.2, 0.015, z=0.22)
    for s in (-1, 1):
        k.box("wood-oak", 0.2, 0.34, 0.03, x=s * 0.38, z=0.82)
