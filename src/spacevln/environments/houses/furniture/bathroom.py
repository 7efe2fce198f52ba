"""Bathrooms and laundry rooms."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, fabrics, kind, looks


@kind("toilet", looks(("white", "gloss-white", "gloss-silver"), ("beige", "gloss-beige", "gloss-gold")))
def _toilet(k: Kit, look: Look) -> None:
    m = look.main
    k.mesh("cushion", m, 0.26, 0.46, 0.36, y=0.0)
    k.mesh("bowlseat", m, 0.38, 0.5, 0.22, y=0.1, z=0.2)
    k.mesh("cushion", m, 0.4, 0.52, 0.05, y=0.09, z=0.4)
    k.rod("plain-gray", 0.12, 0.008, y=0.13, z=0.444)
    k.mesh("cushion", m, 0.38, 0.06, 0.42, y=-0.13, z=0.42, turn=(0.12, 0, 0))
    k.box(m, 0.42, 0.18, 0.4, y=-0.26, z=0.38)
    k.box(m, 0.45, 0.21, 0.04, y=-0.255, z=0.78)
    k.box(look.trim, 0.07, 0.02, 0.025, x=0.13, y=-0.16, z=0.7)


@kind("bathtub", looks(("white", "gloss-white", "gloss-silver"), ("blue", "gloss-sky", "gloss-silver")))
def _bathtub(k: Kit, look: Look) -> None:
    w, d = 1.66, 0.78
    k.mesh("tub", look.main, w, d, 0.56, z=0.02)
    k.mesh("tub", "gloss-water", w * 0.8, d * 0.8, 0.1, z=0.24)
    k.box("gloss-water", w * 0.76, d * 0.6, 0.02, z=0.31)
    k.rod(look.trim, 0.02, 0.2, x=w / 2 - 0.1, z=0.56)
    k.bar(look.trim, 0.018, 0.16, x=w / 2 - 0.17, z=0.75)
    for s in (-1, 1):
        k.rod(look.trim, 0.025, 0.06, x=w / 2 - 0.08, y=s * 0.14, z=0.56)


@kind("shower", looks(("glass", "gloss-white", "gloss-silver"), ("black glass", "plain-charcoal", "gloss-black")))
def _shower(k: Kit, look: Look) -> None:
    w = 0.92 if k.rng.random() < 0.7 else 0.8
    k.box(look.main, w, w, 0.1)
    k.box("plain-gray", 0.1, 0.1, 0.004, z=0.1)
    # the tiles end within the posts and rails around them
    k.box("mosaic-sky", w - 0.01, 0.03, 1.995, y=-w / 2 + 0.02, z=0.1)
    k.box("mosaic-sky", 0.03, w - 0.01, 1.995, x=-w / 2 + 0.02, z=0.1)
    for x, y in ((w / 2 - 0.02, w / 2 - 0.02), (-w / 2 + 0.02, w / 2 - 0.02), (w / 2 - 0.02, -w / 2 + 0.02)):
        k.box(look.trim, 0.04, 0.04, 2.0, x=x, y=y, z=0.1)
    k.box(look.trim, w, 0.04, 0.04, y=w / 2 - 0.02, z=2.06)
    k.box(look.trim, 0.04, w, 0.04, x=w / 2 - 0.02, z=2.06)
    k.box("gloss-glass", 0.44, 0.012, 1.96, x=-0.22, y=w / 2 - 0.02, z=0.1)
    k.box("gloss-glass", 0.012, w - 0.06, 0.9, x=w / 2 - 0.02, z=0.1)
    k.box(look.trim, 0.02, 0.05, 0.3, x=-0.04, y=w / 2, z=0.95)
    k.rod(look.trim, 0.015, 0.9, y=-w / 2 + 0.06, z=1.05)
    k.bar(look.trim, 0.015, 0.2, y=-w / 2 + 0.14, z=1.94, along="y")
    k.rod(look.trim, 0.1, 0.03, y=-w / 2 + 0.24, z=1.9)
    k.box(look.trim, 0.16, 0.04, 0.04, y=-w / 2 + 0.05, z=1.1)


@kind(
    "bathroom sink",
    looks(
        ("white", "plain-white", "marble-white"),
        ("brown wooden", "wood-walnut", "marble-white"),
        ("gray", "plain-gray", "marble-white"),
        ("blue", "plain-navy", "marble-beige"),
    ),
    top_m=0.84,
)
def _bathroom_sink(k: Kit, look: Look) -> None:
    w, d = (0.8 if k.rng.random() < 0.7 else 0.62), 0.48
    k.box("plain-black", w - 0.08, d - 0.08, 0.08)
    k.box(look.main, w, d - 0.03, 0.72, y=-0.015, z=0.08)
    k.fronts(look.main, "gloss-silver", w - 0.02, 0.66, d / 2 - 0.02, 0.1, 2, 1)
    k.box(look.trim, w + 0.02, d, 0.04, z=0.8)
    k.mesh("basin", "gloss-white", 0.46, 0.36, 0.14, y=0.02, z=0.82)
    k.rod("gloss-silver", 0.018, 0.24, y=-0.19, z=0.84)
    k.bar("gloss-silver", 0.016, 0.13, y=-0.13, z=1.07, along="y")
    k.mesh("bottle", "gloss-teal", 0.06, 0.06, 0.16, x=w / 2 - 0.07, y=-0.14, z=0.84)
    k.rod("gloss-white", 0.035, 0.09, x=-w / 2 + 0.07, y=-0.14, z=0.84)
    k.rod("plain-red", 0.007, 0.17, x=-w / 2 + 0.07, y=-0.14, z=0.86, turn=(0.15, 0.15, 0))
    k.rod("plain-blue", 0.007, 0.17, x=-w / 2 + 0.065, y=-0.13, z=0.86, turn=(-0.1, -0.15, 0))


@kind("towel", fabrics("white", "blue", "red", "green", "yellow", "pink", trim="gloss-silver", material="towel"), stand="wall")
def _towel(k: Kit, look: Look) -> None:
    k.bar(look.trim, 0.012, 0.6, y=0.03, z=0.7)
    for s in (-1, 1):
        k.bar(look.trim, 0.016, 0.08, x=s * 0.29, y=0.0, z=0.7, along="y")
    k.box(look.main, 0.42, 0.03, 0.66, y=0.05, z=0.055)
    k.box(look.main, 0.42, 0.06, 0.03, y=0.03, z=0.7)
    k.box("plain-white" if look.words[0] != "white" else "plain-sky", 0.422, 0.032, 0.05, y=0.05, z=0.12)


@kind(
    "washing machine",
    looks(
        ("white", "plain-white", "gloss-silver"),
        ("silver metal", "brushed-silver", "gloss-charcoal"),
        ("black", "plain-charcoal", "gloss-silver"),
    ),
    top_m=0.86,
)
def _washing_machine(k: Kit, look: Look) -> None:
    w, d, h = 0.62, 0.6, 0.86
    k.box(look.main, w, d - 0.04, h, y=-0.02)
    y = d / 2 - 0.04
    k.mesh("ring", look.trim, 0.46, 0.1, 0.46, y=y + 0.01, z=0.17)
    k.ball("gloss-navy", 0.37, 0.1, 0.37, y=y, z=0.215)
    k.ball("gloss-sky", 0.16, 0.106, 0.12, x=0.06, y=y, z=0.4)
    k.box("plain-silver", w - 0.04, 0.012, 0.13, y=y + 0.003, z=0.7)
    k.box("plain-white", 0.18, 0.02, 0.1, x=0.19, y=y + 0.003, z=0.715)
    k.bar("gloss-black", 0.04, 0.04, x=-0.02, y=y + 0.01, z=0.765, along="y")
    k.box("gloss-teal", 0.12, 0.02, 0.05, x=-0.2, y=y + 0.003, z=0.74)


@kind(
    "dryer",
    looks(
        ("white", "plain-white", "gloss-silver"),
        ("silver metal", "brushed-silver", "gloss-charcoal"),
        ("black", "plain-charcoal", "gloss-silver"),
    ),
    top_m=0.86,
)
def _dryer(k: Kit, look: Look) -> None:
    w, d, h = 0.62, 0.6, 0.86
    y = d / 2 - 0.04
    k.box(look.main, w, d - 0.04, h, y=-0.02)
    k.box(look.main, w, 0.08, 0.16, y=-d / 2 + 0.04, z=h)
    k.box("plain-charcoal", w - 0.06, 0.01, 0.12, y=-d / 2 + 0.085, z=h + 0.02)
    for i in range(3):
        k.bar("gloss-silver", 0.035, 0.03, x=(i - 1) * 0.18, y=-d / 2 + 0.1, z=h + 0.08, along="y")
    k.box(look.trim, 0.44, 0.02, 0.44, y=y + 0.006, z=0.26)
    k.box(look.main, 0.4, 0.024, 0.4, y=y + 0.006, z=0.28)
    k.box("gloss-black", 0.03, 0.04, 0.12, x=-0.16, y=y + 0.02, z=0.42)
    for i in range(4):
        k.box("plain-gray", 0.3, 0.008, 0.012, y=y + 0.003, z=0.08 + i * 0.03)


@kind(
    "ironing board",
    looks(
        ("blue", "fabric-blue", "gloss-silver"),
        ("striped", "striped-red", "gloss-silver"),
        ("gray", "fabric-gray", "gloss-silver"),
    ),
)
def _ironing_board(k: Kit, look: Look) -> None:
    w, d = 1.24, 0.38
    k.mesh("cushion", look.main, w, d, 0.06, z=0.84)
    for s in (-1, 1):
        for t in (-1, 1):
            k.rod(look.trim, 0.014, 1.06, y=t * 0.13, z=-0.09, turn=(0, s * 0.66, 0))
        k.bar(look.trim, 0.018, 0.34, x=s * 0.32, z=0.02, along="y")
    k.mesh("prism", "gloss-teal", 0.22, 0.12, 0.1, x=0.36, z=0.9, turn=(0, 0, np.pi / 2))
    k.box("gloss-silver", 0.22, 0.13, 0.02, x=0.36, z=0.89)
    k.box("plain-black", 0.16, 0.03, 0.03, x=0.36, z=1.0)
