"""Screens, machines, heaters."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, kind, looks, woods


@kind("tv stand", (*woods("oak", "walnut", "white", "black"),), top_m=0.5)
def _tv_stand(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.3, 1.6])), 0.42
    k.legs(look.trim, w - 0.1, d - 0.06, 0.1, 0.05)
    k.box(look.main, w, d - 0.02, 0.36, y=-0.01, z=0.1)
    k.box(look.main, w + 0.02, d, 0.04, z=0.46)
    k.box("plain-black", w / 3, 0.02, 0.26, y=d / 2 - 0.025, z=0.14)
    k.box("plain-charcoal", 0.34, 0.05, 0.06, y=d / 2 - 0.03, z=0.15)
    for s in (-1, 1):
        k.box(look.main, w / 3 - 0.02, 0.02, 0.3, x=s * w / 3, y=d / 2 - 0.015, z=0.13)
        k.box("gloss-silver", 0.02, 0.03, 0.1, x=s * (w / 6 + 0.06), y=d / 2, z=0.24)


@kind("tv", looks(("black", "tv-0"), ("black", "tv-1")), stand="top")
def _tv(k: Kit, look: Look) -> None:
    w = 1.1
    k.box("gloss-black", w, 0.04, 0.64, z=0.07)
    k.box(look.main, w - 0.04, 0.046, 0.6, z=0.09)
    k.box("plain-charcoal", 0.06, 0.034, 0.1)
    k.box("plain-charcoal", 0.44, 0.2, 0.015)
    k.box("plain-silver", 0.066, 0.048, 0.008, z=0.075)


@kind("computer monitor", looks(("black", "gloss-black", "screen-0"), ("white", "plain-white", "screen-1")), stand="top")
def _computer_monitor(k: Kit, look: Look) -> None:
    k.box(look.main, 0.58, 0.03, 0.36, y=-0.1, z=0.1)
    k.box(look.trim, 0.55, 0.034, 0.32, y=-0.1, z=0.12)
    k.box(look.main, 0.05, 0.03, 0.16, y=-0.12)
    k.box(look.main, 0.22, 0.16, 0.012, y=-0.11)
    k.box("keyboard-0" if look.variant == 0 else "keyboard-1", 0.42, 0.14, 0.018, y=0.14)
    k.mesh("pillow", look.main, 0.06, 0.1, 0.035, x=-0.28, y=0.14)


@kind("laptop", looks(("gray", "brushed-silver", "screen-2"), ("black", "plain-charcoal", "screen-0")), stand="top")
def _laptop(k: Kit, look: Look) -> None:
    k.box(look.main, 0.36, 0.25, 0.018)
    k.box("keyboard-0", 0.31, 0.12, 0.006, y=-0.03, z=0.017)
    k.box("plain-gray", 0.1, 0.06, 0.004, y=0.08, z=0.017)
    k.box(look.main, 0.36, 0.014, 0.24, y=-0.155, z=0.01, turn=(0.25, 0, 0))
    k.box(look.trim, 0.34, 0.006, 0.215, y=-0.146, z=0.02, turn=(0.25, 0, 0))


@kind(
    "printer",
    looks(
        ("white", "plain-white", "plain-charcoal"),
        ("black", "plain-charcoal", "plain-black"),
        ("gray", "plain-silver", "plain-charcoal"),
    ),
    stand="top",
)
def _printer(k: Kit, look: Look) -> None:
    k.box(look.main, 0.4, 0.26, 0.2, y=-0.05, z=0.01)
    k.box(look.trim, 0.38, 0.22, 0.03, y=-0.05, z=0.21)
    k.box("plain-white", 0.24, 0.02, 0.2, y=-0.14, z=0.22, turn=(0.3, 0, 0))
    k.box("plain-black", 0.3, 0.02, 0.06, y=0.076, z=0.07)
    k.box(look.main, 0.28, 0.1, 0.012, y=0.13, z=0.05)
    k.box("plain-white", 0.22, 0.12, 0.008, y=0.12, z=0.064)
    k.box("gloss-teal", 0.08, 0.02, 0.04, x=-0.13, y=0.076, z=0.155)
    for i in range(3):
        k.box("plain-green" if i == 0 else "plain-silver", 0.02, 0.02, 0.02, x=0.08 + i * 0.035, y=0.076, z=0.165)


@kind(
    "telephone",
    looks(
        ("black", "gloss-black", "plain-white"), ("red", "gloss-red", "plain-white"), ("white", "gloss-white", "plain-charcoal")
    ),
    stand="top",
)
def _telephone(k: Kit, look: Look) -> None:
    k.mesh("prism", look.main, 0.22, 0.24, 0.12)
    k.box(look.main, 0.22, 0.22, 0.05)
    for i in range(12):
        k.box(
            look.trim,
            0.024,
            0.012,
            0.02,
            x=(i % 3 - 1) * 0.036,
            y=0.09 - 0.002 * (i // 3),
            z=0.03 + (i // 3) * 0.026,
            turn=(0.6, 0, 0),
        )
    k.mesh("cushion", look.main, 0.26, 0.055, 0.04, y=-0.01, z=0.14)
    for s in (-1, 1):
        k.mesh("cushion", look.main, 0.07, 0.08, 0.06, x=s * 0.1, y=-0.01, z=0.105)


@kind("radiator", looks(("white", "plain-white"), ("gray metal", "plain-silver")))
def _radiator(k: Kit, look: Look) -> None:
    w = 0.9
    for i in range(12):
        k.mesh("small cushion", look.main, 0.066, 0.11, 0.56, x=(i - 5.5) * 0.072, z=0.1)
    for z in (0.16, 0.6):
        k.bar(look.main, 0.022, w - 0.04, z=z)
    k.bar("gloss-copper", 0.014, 0.06, x=w / 2, z=0.16)
    for s in (-1, 1):
        k.box(look.main, 0.04, 0.1, 0.12, x=s * 0.3)
    k.rod("gloss-silver", 0.025, 0.06, x=w / 2 - 0.01, z=0.62)


@kind(
    "fan",
    looks(
        ("white", "plain-white", "gloss-silver"), ("black", "plain-black", "gloss-silver"), ("blue", "gloss-blue", "gloss-white")
    ),
)
def _fan(k: Kit, look: Look) -> None:
    k.rod(look.main, 0.19, 0.04)
    k.rod(look.main, 0.02, 0.86, z=0.04)
    k.bar(look.main, 0.06, 0.16, y=-0.06, z=1.08, along="y")
    for y in (-0.02, 0.08):
        k.mesh("thinring", look.trim, 0.48, 0.015, 0.48, y=y, z=0.84)
    for i in range(4):
        a = i * np.pi / 2 + 0.3
        k.box(look.main, 0.2, 0.02, 0.12, x=0.11 * np.cos(a), y=0.03, z=1.02 + 0.11 * np.sin(a), turn=(0.3, -float(a), 0))
    k.bar(look.trim, 0.04, 0.03, y=0.09, z=1.08, along="y")
    for i in range(8):
        a = i * np.pi / 8
        k.box(look.trim, 0.47, 0.006, 0.006, y=0.09, z=1.077, turn=(0, -float(a), 0))


@kind("water cooler", looks(("white", "plain-white", "gloss-water"), ("black", "plain-charcoal", "gloss-water")))
def _water_cooler(k: Kit, look: Look) -> None:
    w, d = 0.34, 0.34
    k.box(look.main, w, d - 0.04, 1.0, y=-0.02)
    k.box("plain-charcoal", w - 0.08, 0.02, 0.3, y=d / 2 - 0.045, z=0.58)
    k.box(look.main, w - 0.04, 0.1, 0.03, y=d / 2 - 0.01, z=0.55)
    for s, stuff in ((-1, "gloss-blue"), (1, "gloss-red")):
        k.box(stuff, 0.035, 0.06, 0.05, x=s * 0.07, y=d / 2 - 0.02, z=0.78)
    k.rod(look.trim, 0.06, 0.06, z=1.0)
    k.rod(look.trim, 0.14, 0.3, z=1.06)
    for z in (1.12, 1.24):
        k.mesh("thinring", look.trim, 0.3, 0.02, 0.3, z=z - 0.15, turn=(np.pi / 2, 0, 0))
    k.mesh("pillow", look.trim, 0.28, 0.28, 0.14, z=1.29)


@kind("aquarium", looks(("blue glass", "aquarium-0", "plain-black"), ("blue glass", "aquarium-1", "wood-walnut")))
def _aquarium(k: Kit, look: Look) -> None:
    w, d = 1.1, 0.44
    k.box(look.trim, w, d, 0.62)
    k.fronts(look.trim, "gloss-silver", w - 0.04, 0.56, d / 2, 0.03, 2, 1)
    k.box("plain-black", w, d, 0.04, z=0.62)
    k.box(look.main, w - 0.02, d - 0.02, 0.504, z=0.658)
    k.box("plain-black", w, d, 0.07, z=1.16)
    for sx in (-1, 1):
        for sy in (-1, 1):
            k.box("plain-black", 0.02, 0.02, 0.5, x=sx * (w / 2 - 0.01), y=sy * (d / 2 - 0.01), z=0.66)


@kind(
    "vacuum cleaner",
    looks(
        ("red", "gloss-red", "plain-charcoal"),
        ("blue", "gloss-blue", "plain-charcoal"),
        ("green", "gloss-green", "plain-charcoal"),
    ),
)
def _vacuum_cleaner(k: Kit, look: Look) -> None:
    k.box(look.trim, 0.32, 0.24, 0.08, y=0.12)
    k.bar(look.trim, 0.06, 0.34, y=-0.02, z=0.07)
    k.mesh("pillow", look.main, 0.24, 0.22, 0.62, y=-0.06, z=0.1, turn=(0.2, 0, 0))
    k.rod("gloss-glass", 0.08, 0.26, y=0.03, z=0.24, turn=(0.2, 0, 0))
    k.rod(look.trim, 0.018, 0.52, y=-0.18, z=0.62, turn=(0.2, 0, 0))
    k.mesh("ring", look.trim, 0.14, 0.03, 0.2, y=-0.24, z=1.06)


@kind("speaker", looks(("black", "plain-black", "plain-charcoal"), ("brown wooden", "wood-walnut", "plain-charcoal")))
def _speaker(k: Kit, look: Look) -> None:
    k.box(look.main, 0.3, 0.32, 1.0)
    for z, r in ((0.26, 0.11), (0.56, 0.11), (0.8, 0.06)):
        k.bar("gloss-silver", r + 0.012, 0.02, y=0.158, z=z, along="y")
        k.bar(look.trim, r, 0.03, y=0.16, z=z, along="y")
        k.ball("gloss-black", r * 0.9, 0.04, r * 0.9, y=0.165, z=z - r * 0.45)
