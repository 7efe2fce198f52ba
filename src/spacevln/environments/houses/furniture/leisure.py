"""Sport, music, play and the garage."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, kind, looks

HALF_PI = np.pi / 2


@kind(
    "treadmill",
    looks(
        ("black", "plain-charcoal", "plain-black"), ("gray", "plain-gray", "plain-black"), ("white", "plain-white", "plain-black")
    ),
)
def _treadmill(k: Kit, look: Look) -> None:
    w, d = 0.78, 1.62
    k.box(look.main, w, d, 0.12, z=0.02)
    k.box(look.trim, w - 0.24, d - 0.1, 0.02, z=0.135)
    k.box(look.main, w, 0.3, 0.2, y=-d / 2 + 0.15, z=0.06)
    for s in (-1, 1):
        k.box("plain-silver", 0.06, d - 0.1, 0.02, x=s * (w / 2 - 0.06), z=0.14)
        k.box(look.main, 0.06, 0.08, 1.1, x=s * (w / 2 - 0.05), y=-d / 2 + 0.16, z=0.2)
        k.box(look.trim, 0.05, 0.5, 0.05, x=s * (w / 2 - 0.05), y=-d / 2 + 0.4, z=1.0)
    k.box(look.main, w, 0.1, 0.26, y=-d / 2 + 0.16, z=1.16, turn=(0.5, 0, 0))
    k.box("screen-1", 0.34, 0.02, 0.18, y=-d / 2 + 0.215, z=1.21, turn=(0.5, 0, 0))
    k.box("plain-red", 0.06, 0.02, 0.03, y=-d / 2 + 0.24, z=1.12, turn=(0.5, 0, 0))


@kind(
    "exercise bike",
    looks(("black", "plain-charcoal", "gloss-red"), ("white", "plain-white", "gloss-blue"), ("red", "gloss-red", "gloss-silver")),
)
def _exercise_bike(k: Kit, look: Look) -> None:
    for s in (-1, 1):
        k.box(look.main, 0.5, 0.08, 0.06, y=s * 0.42)
    k.box(look.main, 0.08, 0.9, 0.07, z=0.05)
    k.bar("plain-black", 0.25, 0.07, y=0.24, z=0.34)
    k.bar(look.trim, 0.2, 0.09, y=0.24, z=0.34)
    k.bar("plain-silver", 0.06, 0.12, y=0.24, z=0.34)
    k.box(look.main, 0.06, 0.08, 0.74, y=-0.24, z=0.08, turn=(0.22, 0, 0))
    k.mesh("pillow", "plain-black", 0.26, 0.3, 0.1, y=-0.33, z=0.82)
    k.box(look.main, 0.06, 0.08, 0.86, y=0.24, z=0.3, turn=(-0.18, 0, 0))
    k.bar("plain-black", 0.02, 0.5, y=0.32, z=1.12)
    for s in (-1, 1):
        k.bar("plain-black", 0.022, 0.2, x=s * 0.24, y=0.24, z=1.12, along="y")
        k.box("plain-black", 0.1, 0.16, 0.03, x=s * 0.14, y=-0.02 + s * 0.14, z=0.28 + s * 0.1)
        k.bar("plain-silver", 0.014, 0.18, x=s * 0.08, y=-0.02 + s * 0.07, z=0.3 + s * 0.05, along="y")
    k.box("screen-0", 0.2, 0.03, 0.14, y=0.36, z=1.14, turn=(0.4, 0, 0))


@kind(
    "weight bench",
    looks(
        ("black leather", "leather-black", "gloss-silver"),
        ("red leather", "leather-red", "plain-charcoal"),
        ("blue leather", "leather-blue", "plain-charcoal"),
    ),
)
def _weight_bench(k: Kit, look: Look) -> None:
    w = 1.5
    k.box(look.main, 0.32, 1.0, 0.1, y=0.06, z=0.4)
    for y in (0.45, -0.35):
        k.box(look.trim, 0.08, 0.06, 0.4, y=y)
        k.box(look.trim, 0.44, 0.07, 0.05, y=y)
    for s in (-1, 1):
        k.box(look.trim, 0.06, 0.06, 1.0, x=s * 0.42, y=-0.46)
        k.box(look.trim, 0.06, 0.4, 0.05, x=s * 0.42, y=-0.38)
        for i, r in enumerate((0.2, 0.2, 0.15)):
            k.bar("plain-black" if i != 1 else "plain-red", r, 0.035, x=s * (0.56 + i * 0.045), y=-0.44, z=1.03)
    k.box(look.trim, 0.84, 0.05, 0.05, y=-0.46, z=0.3)
    k.bar("gloss-silver", 0.016, w, y=-0.44, z=1.03)


@kind(
    "dumbbell rack",
    looks(
        ("black metal", "plain-charcoal", "plain-black"),
        ("gray metal", "plain-gray", "plain-black"),
        ("red metal", "plain-red", "plain-black"),
    ),
)
def _dumbbell_rack(k: Kit, look: Look) -> None:
    w, d = 1.2, 0.46
    for s in (-1, 1):
        k.box(look.main, 0.06, d, 0.06, x=s * (w / 2 - 0.03))
        k.box(look.main, 0.06, 0.06, 0.86, x=s * (w / 2 - 0.03), y=-0.16)
    colours = ("plain-black", "plain-charcoal", "plain-blue", "plain-red")
    for j, z in enumerate((0.24, 0.52, 0.8)):
        k.box(look.main, w, 0.3, 0.03, y=-0.02, z=z, turn=(-0.25, 0, 0))
        for i in range(5):
            x = (i - 2) * 0.22
            for s in (-1, 1):
                k.bar(colours[(i + j) % 4], 0.065 - 0.01 * j, 0.09, x=x, y=-0.01 + s * 0.085, z=z + 0.11 - s * 0.02, along="y")
            k.bar("gloss-silver", 0.016, 0.2, x=x, y=-0.01, z=z + 0.11, along="y")


@kind(
    "yoga mat",
    looks(
        ("purple", "rubber-purple", "plain-lavender"),
        ("blue", "rubber-blue", "plain-sky"),
        ("green", "rubber-teal", "plain-mint"),
        ("pink", "rubber-pink", "plain-white"),
    ),
    stand="flat",
)
def _yoga_mat(k: Kit, look: Look) -> None:
    k.box(look.main, 0.62, 1.6, 0.012)
    k.bar(look.main, 0.06, 0.62, y=-0.82, z=0.06)
    k.bar(look.trim, 0.03, 0.625, y=-0.82, z=0.06)


@kind(
    "exercise ball",
    looks(
        ("blue", "gloss-blue", "gloss-navy"),
        ("red", "gloss-red", "gloss-burgundy"),
        ("green", "gloss-green", "gloss-green"),
        ("purple", "gloss-purple", "gloss-purple"),
    ),
)
def _exercise_ball(k: Kit, look: Look) -> None:
    k.ball(look.main, 0.628, 0.628, 0.62)
    for z in (0.16, 0.3, 0.44):
        r = 0.32 * (1 - ((z - 0.31) / 0.31) ** 2) ** 0.5 * 2 + 0.006
        k.mesh("thinring", look.trim, r, 0.02, r, z=z - r / 2, turn=(HALF_PI, 0, 0))


@kind(
    "piano",
    looks(
        ("black", "gloss-black", "gloss-black"),
        ("brown wooden", "wood-mahogany", "wood-mahogany"),
        ("white", "gloss-white", "gloss-white"),
    ),
)
def _piano(k: Kit, look: Look) -> None:
    w = 1.46
    k.box(look.main, w, 0.36, 1.2, y=-0.32)
    k.box(look.main, w + 0.04, 0.42, 0.04, y=-0.31, z=1.2)
    k.box(look.main, w, 0.36, 0.1, y=0.0, z=0.58)
    k.box("pianokeys-0", w - 0.16, 0.17, 0.03, y=0.07, z=0.68)
    k.box("plain-red", w - 0.16, 0.02, 0.035, y=-0.03, z=0.68)
    for s in (-1, 1):
        k.box(look.main, 0.08, 0.34, 0.16, x=s * (w / 2 - 0.04), y=0.01, z=0.6)
        k.box(look.main, 0.08, 0.08, 0.58, x=s * (w / 2 - 0.06), y=0.12)
        k.rod("gloss-gold", 0.02, 0.02, x=s * 0.06, y=-0.1, z=0.06)
    k.box(look.main, 0.6, 0.03, 0.26, y=-0.12, z=0.8, turn=(0.2, 0, 0))
    k.box("plain-white", 0.4, 0.012, 0.24, y=-0.095, z=0.82, turn=(0.2, 0, 0))
    for i in range(4):
        k.box("plain-charcoal", 0.34, 0.014, 0.012, y=-0.09, z=0.86 + i * 0.045, turn=(0.2, 0, 0))
    k.legs(look.main, 0.6, 0.28, 0.44, 0.05, y=0.36)
    k.mesh("cushion", "leather-black", 0.64, 0.3, 0.1, y=0.36, z=0.42)


@kind(
    "drum set",
    looks(("red", "gloss-red", "gloss-silver"), ("blue", "gloss-blue", "gloss-silver"), ("black", "gloss-black", "gloss-silver")),
)
def _drum_set(k: Kit, look: Look) -> None:
    k.bar(look.main, 0.28, 0.4, y=0.12, z=0.3, along="y")
    k.bar("plain-white", 0.26, 0.42, y=0.12, z=0.3, along="y")
    for x, y, r, h, z in (
        (-0.2, 0.14, 0.17, 0.2, 0.66),
        (0.2, 0.14, 0.17, 0.2, 0.66),
        (0.52, -0.2, 0.22, 0.36, 0.22),
        (-0.5, -0.22, 0.19, 0.16, 0.5),
    ):
        k.rod(look.main, r, h, x=x, y=y, z=z)
        k.rod("plain-white", r - 0.015, h + 0.01, x=x, y=y, z=z)
        k.rod(look.trim, r + 0.006, 0.02, x=x, y=y, z=z + h - 0.015)
        k.rod(look.trim, 0.014, z, x=x, y=y)
    for x, y, z in ((-0.56, 0.22, 1.02), (0.56, 0.22, 1.1), (-0.66, -0.1, 0.8)):
        k.rod("plain-charcoal", 0.012, z, x=x, y=y)
        k.mesh("cone", "gloss-gold", 0.42, 0.42, 0.04, x=x, y=y, z=z)
    k.rod("leather-black", 0.16, 0.08, y=-0.52, z=0.42)
    k.rod("plain-charcoal", 0.02, 0.42, y=-0.52)
    k.rod("plain-charcoal", 0.16, 0.02, y=-0.52)


@kind(
    "guitar",
    looks(
        ("brown wooden", "wood-cherry", "wood-maple"),
        ("red", "gloss-red", "wood-maple"),
        ("black", "gloss-black", "wood-maple"),
        ("yellow wooden", "wood-pine", "wood-walnut"),
    ),
)
def _guitar(k: Kit, look: Look) -> None:
    lean = (0.16, 0.0, 0.0)
    k.mesh("guitar", look.main, 0.4, 0.1, 0.5, y=0.05, z=0.12, turn=lean)
    k.rod("plain-black", 0.055, 0.11, y=0.04, z=0.35, turn=(HALF_PI + 0.16, 0, 0))
    k.box(look.trim, 0.055, 0.03, 0.56, y=-0.02, z=0.52, turn=lean)
    k.box("plain-black", 0.08, 0.03, 0.16, y=-0.08, z=1.04, turn=lean)
    k.box("plain-black", 0.14, 0.03, 0.03, y=0.12, z=0.22, turn=lean)
    k.box("plain-silver", 0.02, 0.004, 0.8, y=0.055, z=0.26, turn=lean)
    for s in (-1, 1):
        k.rod("plain-charcoal", 0.012, 0.44, x=s * 0.12, y=-0.04, z=-0.01, turn=(0.4, s * 0.1, 0))
        k.bar("plain-charcoal", 0.014, 0.3, x=s * 0.13, y=0.08, z=0.1, along="y")
        for i in range(3):
            k.box("plain-silver", 0.03, 0.02, 0.02, x=s * 0.05, y=-0.075 - 0.006 * i, z=1.06 + i * 0.04)


@kind("globe", looks(("blue", "globe-0", "wood-walnut"), ("blue gold", "globe-1", "gloss-gold")))
def _globe(k: Kit, look: Look) -> None:
    k.rod(look.trim, 0.2, 0.04)
    k.mesh("turned", look.trim, 0.12, 0.12, 0.5, z=0.04)
    k.ball(look.main, 0.46, 0.46, 0.46, z=0.56)
    k.mesh("thinring", "gloss-brass", 0.54, 0.05, 0.54, z=0.52, turn=(0, 0.4, 0))


@kind(
    "teddy bear",
    looks(
        ("brown", "fabric-brown", "fabric-tan"), ("white", "fabric-white", "fabric-pink"), ("tan", "fabric-tan", "fabric-cream")
    ),
)
def _teddy_bear(k: Kit, look: Look) -> None:
    m, t = look.main, look.trim
    k.ball(m, 0.4, 0.36, 0.44, z=0.02)
    k.ball(t, 0.26, 0.2, 0.3, y=0.1, z=0.08)
    k.ball(m, 0.34, 0.32, 0.32, z=0.4)
    k.ball(t, 0.16, 0.14, 0.12, y=0.13, z=0.46)
    k.ball("gloss-black", 0.05, 0.04, 0.035, y=0.2, z=0.535)
    for s in (-1, 1):
        k.ball(m, 0.14, 0.08, 0.14, x=s * 0.14, z=0.64)
        k.ball(t, 0.08, 0.05, 0.08, x=s * 0.14, y=0.03, z=0.67)
        k.ball("gloss-black", 0.035, 0.03, 0.035, x=s * 0.07, y=0.15, z=0.59)
        k.ball(m, 0.13, 0.18, 0.3, x=s * 0.21, y=0.04, z=0.16, turn=(0.5, s * 0.5, 0))
        k.ball(m, 0.17, 0.34, 0.17, x=s * 0.15, y=0.22, z=0.0)
        k.ball(t, 0.13, 0.04, 0.13, x=s * 0.15, y=0.38, z=0.02)
    k.box("gloss-red", 0.16, 0.03, 0.06, y=0.16, z=0.38)


@kind("rocking horse", looks(("brown wooden", "wood-oak", "plain-red"), ("white", "plain-white", "plain-blue")))
def _rocking_horse(k: Kit, look: Look) -> None:
    m = look.main
    for s in (-1, 1):
        k.mesh("rocker", "wood-walnut", 0.05, 0.95, 0.16, x=s * 0.15)
        for t in (-1, 1):
            k.rod(m, 0.028, 0.36, x=s * 0.12, y=t * 0.22, z=0.08, turn=(-t * 0.2, s * 0.1, 0))
    k.mesh("cushion", m, 0.22, 0.62, 0.24, z=0.4)
    k.box(look.trim, 0.24, 0.24, 0.05, z=0.61)
    k.box(m, 0.13, 0.2, 0.4, y=0.3, z=0.52, turn=(-0.5, 0, 0))
    k.mesh("cushion", m, 0.14, 0.34, 0.17, y=0.46, z=0.8, turn=(-0.5, 0, 0))
    k.box("plain-chocolate", 0.05, 0.1, 0.4, y=0.24, z=0.6, turn=(-0.5, 0, 0))
    k.bar("plain-red", 0.018, 0.34, y=0.34, z=0.78)
    k.mesh("cone", "plain-chocolate", 0.08, 0.1, 0.4, y=-0.36, z=0.3, turn=(-0.4, 0, 0))
    for s in (-1, 1):
        k.mesh("cone", m, 0.04, 0.04, 0.1, x=s * 0.05, y=0.36, z=0.96)
        k.ball("gloss-black", 0.03, 0.03, 0.03, x=s * 0.07, y=0.46, z=0.9)
