"""Kitchens: counters, appliances and what stands on them."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, kind, looks

COUNTERS = looks(
    ("white marble", "plain-white", "marble-white"),
    ("brown wooden", "wood-oak", "marble-beige"),
    ("gray", "plain-gray", "marble-white"),
    ("blue", "plain-navy", "marble-white"),
    ("green", "plain-sage", "wood-oak"),
    ("black", "plain-charcoal", "marble-gray"),
)
"""Cabinets of one kitchen share their look: main is the fronts, trim the worktop."""


def _base(k: Kit, look: Look, w: float, doors: int = 1) -> None:
    k.box("plain-black", w, 0.54, 0.08, y=-0.03)
    k.box(look.main, w, 0.58, 0.78, y=-0.01, z=0.08)
    k.box(look.trim, w, 0.62, 0.04, z=0.86)
    k.fronts(look.main, "gloss-silver", w - 0.01, 0.56, 0.285, 0.1, doors, 1)
    k.fronts(look.main, "gloss-silver", w - 0.01, 0.18, 0.285, 0.67, doors, 1)


@kind("kitchen counter", COUNTERS, top_m=0.9)
def _kitchen_counter(k: Kit, look: Look) -> None:
    _base(k, look, 0.8 if k.rng.random() < 0.7 else 0.56, 2)


@kind("kitchen sink", COUNTERS)
def _kitchen_sink(k: Kit, look: Look) -> None:
    w = 0.8 if k.rng.random() < 0.7 else 0.64
    _base(k, look, w, 2)
    k.box("brushed-silver", 0.58, 0.44, 0.012, y=0.02, z=0.898)
    k.box("plain-charcoal", 0.52, 0.34, 0.004, y=0.04, z=0.91)
    k.box("plain-gray", 0.46, 0.28, 0.004, y=0.04, z=0.913)
    k.rod("plain-black", 0.03, 0.004, y=0.04, z=0.916)
    k.rod("gloss-silver", 0.02, 0.3, y=-0.18, z=0.9)
    k.bar("gloss-silver", 0.016, 0.2, y=-0.09, z=1.2, along="y")
    k.rod("gloss-silver", 0.016, 0.07, y=0.01, z=1.13)
    for s in (-1, 1):
        k.rod("gloss-silver", 0.02, 0.06, x=s * 0.12, y=-0.18, z=0.9)


@kind(
    "stove",
    looks(
        ("white", "plain-white", "plain-charcoal"),
        ("black", "gloss-black", "plain-charcoal"),
        ("silver metal", "brushed-silver", "plain-charcoal"),
    ),
)
def _stove(k: Kit, look: Look) -> None:
    w, d = 0.62, 0.62
    k.box(look.main, w, d - 0.04, 0.88, y=-0.02)
    k.box("cooktop-0", w - 0.02, d - 0.05, 0.02, y=-0.015, z=0.88)
    k.box(look.main, w, 0.06, 0.2, y=-d / 2 + 0.03, z=0.88)
    k.box("gloss-black", w - 0.06, 0.015, 0.44, y=d / 2 - 0.03, z=0.2)
    k.box("plain-orange", w - 0.26, 0.012, 0.22, y=d / 2 - 0.026, z=0.3)
    k.box("gloss-silver", w - 0.1, 0.04, 0.025, y=d / 2 - 0.01, z=0.66)
    for i in range(5):
        k.bar("gloss-silver", 0.026, 0.03, x=(i - 2) * 0.11, y=d / 2 - 0.025, z=0.78, along="y")
    k.box(look.main, w - 0.06, 0.015, 0.12, y=d / 2 - 0.035, z=0.05)
    k.rod("gloss-red", 0.1, 0.14, x=-0.15, y=-0.1, z=0.9)
    k.rod("gloss-black", 0.105, 0.015, x=-0.15, y=-0.1, z=1.04)
    k.ball("gloss-black", 0.03, 0.03, 0.03, x=-0.15, y=-0.1, z=1.05)


@kind(
    "refrigerator",
    looks(
        ("white", "plain-white", "gloss-silver"),
        ("silver metal", "brushed-silver", "gloss-black"),
        ("black", "gloss-black", "gloss-silver"),
        ("red", "gloss-red", "gloss-silver"),
    ),
)
def _refrigerator(k: Kit, look: Look) -> None:
    w, d, h = 0.72, 0.68, 1.78
    k.box("plain-charcoal", w - 0.04, d - 0.106, h - 0.02, y=-0.047, z=0.02)
    k.box(look.main, w, d - 0.09, h - 0.06, y=-0.045, z=0.05)
    k.box(look.main, w, 0.06, 1.1, y=d / 2 - 0.05, z=0.06)
    k.box(look.main, w, 0.06, 0.58, y=d / 2 - 0.05, z=1.18)
    k.box(look.trim, 0.03, 0.05, 0.5, x=-w / 2 + 0.07, y=d / 2, z=0.6)
    k.box(look.trim, 0.03, 0.05, 0.34, x=-w / 2 + 0.07, y=d / 2, z=1.24)
    k.box("plain-yellow", 0.09, 0.006, 0.09, x=0.16, y=d / 2 - 0.018, z=1.5)
    k.box("plain-sky", 0.12, 0.006, 0.15, x=0.02, y=d / 2 - 0.018, z=1.44)
    k.box("plain-red", 0.04, 0.012, 0.04, x=0.02, y=d / 2 - 0.017, z=1.58)


@kind(
    "dishwasher",
    looks(
        ("white", "plain-white", "gloss-silver"),
        ("silver metal", "brushed-silver", "gloss-black"),
        ("black", "gloss-black", "gloss-silver"),
    ),
    top_m=0.9,
)
def _dishwasher(k: Kit, look: Look) -> None:
    w = 0.6
    k.box("plain-black", w - 0.02, 0.54, 0.08, y=-0.03)
    k.box(look.main, w, 0.58, 0.78, y=-0.01, z=0.08)
    k.box("marble-white", w, 0.62, 0.04, z=0.86)
    k.box(look.main, w - 0.03, 0.02, 0.6, y=0.285, z=0.1)
    k.box("plain-charcoal", w - 0.03, 0.022, 0.1, y=0.285, z=0.74)
    k.box("gloss-teal", 0.1, 0.026, 0.035, x=0.12, y=0.285, z=0.77)
    for i in range(4):
        k.bar("gloss-silver", 0.014, 0.036, x=-0.2 + i * 0.06, y=0.29, z=0.79, along="y")
    k.box(look.trim, w - 0.16, 0.04, 0.03, y=0.3, z=0.66)


@kind("kitchen island", COUNTERS, top_m=0.92)
def _kitchen_island(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.4, 1.7])), 0.8
    k.box("plain-black", w - 0.2, d - 0.3, 0.08)
    k.box(look.main, w - 0.1, d - 0.2, 0.8, z=0.08)
    k.box(look.trim, w, d, 0.05, z=0.87)
    for s in (-1, 1):
        for i in range(3):
            k.box(look.main, (w - 0.2) / 3 - 0.03, 0.02, 0.68, x=(i - 1) * (w - 0.16) / 3, y=s * (d / 2 - 0.095), z=0.14)
            k.box("gloss-silver", 0.02, 0.02, 0.16, x=(i - 1) * (w - 0.16) / 3 + 0.14, y=s * (d / 2 - 0.08), z=0.5)


@kind("wall cabinet", COUNTERS, stand="wall")
def _wall_cabinet(k: Kit, look: Look) -> None:
    k.box(look.main, 0.8, 0.3, 0.62)
    k.fronts(look.main, "gloss-silver", 0.79, 0.6, 0.152, 0.01, 2, 1)


@kind(
    "range hood", looks(("silver metal", "brushed-silver", "gloss-black"), ("black", "gloss-black", "gloss-silver")), stand="wall"
)
def _range_hood(k: Kit, look: Look) -> None:
    k.box(look.main, 0.62, 0.42, 0.06)
    k.mesh("wedge", look.main, 0.56, 0.4, 0.2, z=0.06, turn=(0, 0, np.pi))
    k.box(look.main, 0.24, 0.24, 0.56, y=-0.08, z=0.08)
    k.box(look.trim, 0.2, 0.01, 0.02, y=0.212, z=0.02)


@kind(
    "microwave",
    looks(
        ("black", "gloss-black", "gloss-silver"),
        ("white", "plain-white", "gloss-black"),
        ("silver metal", "brushed-silver", "gloss-black"),
    ),
    stand="top",
)
def _microwave(k: Kit, look: Look) -> None:
    k.box(look.main, 0.48, 0.34, 0.28, z=0.01)
    k.box("gloss-black", 0.31, 0.01, 0.2, x=0.07, y=0.17, z=0.05)
    k.box("plain-charcoal", 0.24, 0.018, 0.13, x=0.07, y=0.171, z=0.085)
    k.box(look.trim, 0.018, 0.03, 0.2, x=-0.1, y=0.18, z=0.05)
    k.box("plain-charcoal", 0.1, 0.01, 0.22, x=-0.175, y=0.17, z=0.04)
    k.box("gloss-teal", 0.08, 0.014, 0.035, x=-0.175, y=0.17, z=0.21)
    for i in range(9):
        k.box("plain-silver", 0.018, 0.014, 0.018, x=-0.2 + (i % 3) * 0.025, y=0.17, z=0.07 + (i // 3) * 0.035)


@kind(
    "toaster",
    looks(
        ("silver metal", "brushed-silver", "gloss-black"),
        ("red", "gloss-red", "gloss-silver"),
        ("white", "plain-white", "gloss-black"),
    ),
    stand="top",
)
def _toaster(k: Kit, look: Look) -> None:
    k.mesh("cushion", look.main, 0.3, 0.19, 0.2, z=0.015)
    k.box(look.trim, 0.28, 0.17, 0.02)
    for s in (-1, 1):
        k.box("plain-black", 0.2, 0.032, 0.006, y=s * 0.04, z=0.212)
        k.box("plain-tan", 0.14, 0.02, 0.07, y=s * 0.04, z=0.19)
    k.box(look.trim, 0.02, 0.04, 0.03, x=0.155, z=0.13)
    k.bar(look.trim, 0.018, 0.02, x=0.155, y=0.04, z=0.06)


@kind(
    "kettle",
    looks(
        ("silver metal", "gloss-silver", "gloss-black"),
        ("red", "gloss-red", "gloss-black"),
        ("blue", "gloss-blue", "gloss-black"),
    ),
    stand="top",
)
def _kettle(k: Kit, look: Look) -> None:
    k.rod("plain-black", 0.09, 0.02)
    k.mesh("teapot", look.main, 0.19, 0.19, 0.22, z=0.02)
    k.ball(look.trim, 0.03, 0.03, 0.03, z=0.235)
    k.mesh("cone", look.main, 0.06, 0.06, 0.13, x=0.11, z=0.12, turn=(0, 0.75, 0))
    k.mesh("thinring", look.trim, 0.17, 0.025, 0.17, z=0.17)


@kind(
    "teapot",
    looks(("white", "gloss-white", "gloss-blue"), ("blue", "gloss-blue", "gloss-white"), ("brown", "gloss-brown", "gloss-tan")),
    stand="top",
)
def _teapot(k: Kit, look: Look) -> None:
    k.mesh("teapot", look.main, 0.2, 0.2, 0.17)
    k.ball(look.trim, 0.03, 0.03, 0.03, z=0.165)
    k.mesh("ring", look.main, 0.12, 0.025, 0.12, x=-0.11, z=0.03)
    k.rod(look.main, 0.016, 0.14, x=0.125, z=0.05, turn=(0, 0.8, 0))
    k.mesh("thinring", look.trim, 0.205, 0.03, 0.205, z=-0.02, turn=(np.pi / 2, 0, 0))
    k.mesh("bowl", look.main, 0.08, 0.08, 0.06, x=0.05, y=0.17)


@kind("fruit bowl", looks(("white", "gloss-white"), ("brown wooden", "wood-walnut"), ("blue", "gloss-navy")), stand="top")
def _fruit_bowl(k: Kit, look: Look) -> None:
    k.mesh("bowl", look.main, 0.34, 0.34, 0.12)
    for i, stuff in enumerate(("gloss-red", "gloss-orange", "gloss-green", "gloss-red", "gloss-orange")):
        a = i * 2 * np.pi / 5
        k.ball(stuff, 0.1, 0.1, 0.1, x=0.085 * np.cos(a), y=0.085 * np.sin(a), z=0.075)
    k.ball("gloss-green", 0.1, 0.1, 0.1, z=0.13)
    k.mesh("cushion", "gloss-yellow", 0.05, 0.22, 0.05, x=0.06, y=-0.02, z=0.16, turn=(0, 0.2, 0.6))
    k.mesh("cushion", "gloss-yellow", 0.05, 0.2, 0.05, x=0.01, y=0.05, z=0.165, turn=(0, 0, 0.9))


@kind(
    "coffee machine",
    looks(
        ("black", "gloss-black", "gloss-silver"),
        ("red", "gloss-red", "gloss-silver"),
        ("silver metal", "brushed-silver", "gloss-black"),
    ),
    stand="top",
)
def _coffee_machine(k: Kit, look: Look) -> None:
    k.box(look.main, 0.24, 0.3, 0.04)
    k.box(look.main, 0.24, 0.12, 0.36, y=-0.09)
    k.box(look.main, 0.24, 0.3, 0.1, z=0.28)
    k.rod("gloss-glass", 0.08, 0.15, y=0.05, z=0.05)
    k.rod("gloss-chocolate", 0.083, 0.08, y=0.05, z=0.046)
    k.box("gloss-black", 0.02, 0.08, 0.1, x=0.0, y=0.15, z=0.08)
    k.box(look.trim, 0.14, 0.01, 0.03, y=0.152, z=0.32)
