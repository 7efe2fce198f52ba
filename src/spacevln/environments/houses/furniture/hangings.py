"""What hangs on walls."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, fabrics, kind, looks, woods

HALF_PI = np.pi / 2


@kind(
    "mirror",
    looks(
        ("gold", "gloss-gold"),
        ("black", "plain-black"),
        ("white", "plain-white"),
        ("brown wooden", "wood-walnut"),
        ("round gold", "gloss-gold", "plain-black", 1),
    ),
    stand="wall",
)
def _mirror(k: Kit, look: Look) -> None:
    if look.variant:
        k.bar(look.main, 0.36, 0.04, z=0.36, along="y")
        k.mesh("face", "mirror-1", 0.66, 0.036, 0.66, z=0.03, y=0.0055)
        return
    w, h = 0.62, 0.95
    k.box(look.main, w, 0.03, h)
    k.box(look.main, w - 0.04, 0.04, h - 0.04, z=0.02)
    k.box("mirror-0", w - 0.1, 0.046, h - 0.1, z=0.05)


def _paintings() -> tuple[Look, ...]:
    frames = (("gold", "gloss-gold"), ("black", "plain-black"), ("white", "plain-white"), ("brown wooden", "wood-walnut"))
    return tuple(
        Look((word,) if " " not in word else tuple(word.split()), stuff, f"painting-{i * 4 + j}", i * 4 + j)
        for i in range(3)
        for j, (word, stuff) in enumerate(frames)
    )


@kind("painting", _paintings(), stand="wall")
def _painting(k: Kit, look: Look) -> None:
    upright = look.variant % 6 >= 4
    square = look.variant % 6 in (2, 3)
    w, h = (0.58, 0.74) if upright else (0.78, 0.78) if square else (1.0, 0.76)
    k.box(look.main, w, 0.03, h)
    k.box("plain-ivory", w - 0.07, 0.036, h - 0.07, z=0.035)
    k.box(look.trim, w - 0.12, 0.042, h - 0.12, z=0.06)


@kind("poster", looks(("blue", "poster-0"), ("red", "poster-1"), ("green", "poster-2")), stand="wall")
def _poster(k: Kit, look: Look) -> None:
    k.box(look.main, 0.6, 0.01, 0.85)


@kind(
    "clock",
    looks(
        ("black", "plain-black", "clock-0"),
        ("white", "plain-white", "clock-3"),
        ("gold", "gloss-gold", "clock-5"),
        ("red", "gloss-red", "clock-7"),
    ),
    stand="wall",
)
def _clock(k: Kit, look: Look) -> None:
    k.bar(look.main, 0.21, 0.0534, y=0.0025, z=0.21, along="y")
    k.mesh("face", look.trim, 0.37, 0.054, 0.37, y=0.0073, z=0.025)


@kind("calendar", looks(("white", "calendar-0"), ("white", "calendar-1")), stand="wall")
def _calendar(k: Kit, look: Look) -> None:
    k.box(look.main, 0.34, 0.01, 0.48)
    k.box("gloss-charcoal", 0.3, 0.016, 0.015, z=0.47)


@kind("exit sign", looks(("red", "exitsign-0")), stand="wall")
def _exit_sign(k: Kit, look: Look) -> None:
    k.box("plain-white", 0.46, 0.06, 0.25)
    k.box(look.main, 0.44, 0.07, 0.23, z=0.01)


@kind("dartboard", looks(("black", "dartboard-0")), stand="wall")
def _dartboard(k: Kit, look: Look) -> None:
    k.bar("plain-black", 0.25, 0.0534, y=0.0025, z=0.25, along="y")
    k.mesh("face", look.main, 0.49, 0.054, 0.49, y=0.0073, z=0.005)
    for x, z in ((0.05, 0.31), (-0.08, 0.2)):
        k.bar("gloss-yellow", 0.008, 0.14, x=x, y=0.09, z=z, along="y")


@kind("wall shelf", woods("oak", "white", "walnut", "black"), stand="wall")
def _wall_shelf(k: Kit, look: Look) -> None:
    w = 0.9
    k.box(look.main, w, 0.22, 0.03)
    for s in (-1, 1):
        k.box(look.main, 0.03, 0.16, 0.1, x=s * (w / 2 - 0.12), y=-0.03, z=-0.1)
    k.box("books-2", 0.4, 0.15, 0.22, x=-0.2, z=0.03)
    k.mesh("pot", "plain-terracotta", 0.13, 0.13, 0.12, x=0.22, z=0.03)
    k.mesh("plant", "foliage-leaf", 0.24, 0.2, 0.22, x=0.22, z=0.13)
    k.mesh("vase", "gloss-teal", 0.09, 0.09, 0.17, x=0.38, z=0.03)


@kind(
    "curtain",
    fabrics("white", "blue", "red", "beige", "gray", "green", "burgundy", trim="gloss-brass", material="fabric"),
    stand="wall",
)
def _curtain(k: Kit, look: Look) -> None:
    w, h = 1.9, 2.2
    k.bar(look.trim, 0.016, w + 0.06, y=0.0625, z=h)
    for s in (-1, 1):
        k.ball(look.trim, 0.06, 0.045, 0.06, x=s * (w / 2 + 0.03), y=0.0625, z=h - 0.03)
        k.box(look.trim, 0.02, 0.065, 0.02, x=s * (w / 2 - 0.36), y=0.0275, z=h - 0.01)
        # hangs clear of the window's sill
        k.mesh("curtain", look.main, 0.34, 0.05, h - 0.05, x=s * (w / 2 - 0.17), y=0.0625, z=0.02)
