"""Lamps, plants, pictures, rugs and small things."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, fabrics, kind, looks

HALF_PI = np.pi / 2


@kind(
    "floor lamp",
    looks(
        ("black", "plain-black", "glow-lamp"),
        ("gold metal", "gloss-brass", "glow-lamp"),
        ("white", "plain-white", "glow-lamp"),
        ("brown wooden", "wood-walnut", "glow-lamp"),
    ),
)
def _floor_lamp(k: Kit, look: Look) -> None:
    k.rod(look.main, 0.15, 0.03)
    k.rod(look.main, 0.016, 1.36, z=0.03)
    k.mesh("shade", look.trim, 0.4, 0.4, 0.28, z=1.36)


@kind(
    "table lamp",
    looks(
        ("white", "gloss-white", "glow-lamp"),
        ("blue", "gloss-blue", "glow-lamp"),
        ("gold", "gloss-gold", "glow-lamp"),
        ("green", "gloss-green", "glow-lamp"),
        ("red", "gloss-red", "glow-lamp"),
    ),
    stand="top",
)
def _table_lamp(k: Kit, look: Look) -> None:
    k.rod(look.main, 0.07, 0.02)
    k.mesh("vase", look.main, 0.15, 0.15, 0.22, z=0.02)
    k.rod("gloss-brass", 0.012, 0.08, z=0.22)
    k.mesh("shade", look.trim, 0.3, 0.3, 0.19, z=0.26)


@kind(
    "desk lamp",
    looks(("black", "plain-black", "glow-lamp"), ("red", "gloss-red", "glow-lamp"), ("white", "gloss-white", "glow-lamp")),
    stand="top",
)
def _desk_lamp(k: Kit, look: Look) -> None:
    k.rod(look.main, 0.08, 0.025)
    k.rod(look.main, 0.012, 0.3, y=-0.05, z=0.01, turn=(0.35, 0, 0))
    k.rod(look.main, 0.012, 0.26, y=-0.01, z=0.25, turn=(-1.0, 0, 0))
    k.mesh("cone", look.main, 0.17, 0.17, 0.13, y=0.1, z=0.33, turn=(-0.35, 0, 0))
    k.ball(look.trim, 0.11, 0.11, 0.05, y=0.12, z=0.315)


@kind("ceiling lamp", looks(("white", "glow-lamp", "plain-white"), ("gold", "glow-lamp", "gloss-gold")), stand="ceiling")
def _ceiling_lamp(k: Kit, look: Look) -> None:
    k.rod(look.trim, 0.2, 0.05, z=0.11)
    k.mesh("pillow", look.main, 0.38, 0.38, 0.16, z=0.0)


@kind(
    "chandelier",
    looks(
        ("gold", "gloss-gold", "glow-lamp"), ("black metal", "plain-black", "glow-lamp"), ("silver", "gloss-silver", "glow-lamp")
    ),
    stand="ceiling",
)
def _chandelier(k: Kit, look: Look) -> None:
    k.rod(look.main, 0.07, 0.03, z=0.6)
    k.rod(look.main, 0.012, 0.5, z=0.12)
    k.mesh("turned", look.main, 0.1, 0.1, 0.24, z=0.04)
    for i in range(6):
        a = i * np.pi / 3
        c, s = float(np.cos(a)), float(np.sin(a))
        k.box(look.main, 0.3, 0.018, 0.018, x=0.16 * c, y=0.16 * s, z=0.1, turn=(0, 0, a))
        k.rod("plain-white", 0.018, 0.09, x=0.31 * c, y=0.31 * s, z=0.1)
        k.mesh("cone", look.trim, 0.05, 0.05, 0.09, x=0.31 * c, y=0.31 * s, z=0.18)
    k.mesh("thinring", look.main, 0.5, 0.025, 0.5, z=-0.16, turn=(HALF_PI, 0, 0))


@kind(
    "ceiling fan",
    looks(("brown wooden", "wood-walnut", "gloss-brass"), ("white", "plain-white", "gloss-silver")),
    stand="ceiling",
)
def _ceiling_fan(k: Kit, look: Look) -> None:
    k.rod(look.trim, 0.08, 0.04, z=0.38)
    k.rod(look.trim, 0.016, 0.2, z=0.2)
    k.rod(look.trim, 0.11, 0.1, z=0.12)
    k.ball("glow-lamp", 0.2, 0.2, 0.16, z=0.0)
    for i in range(5):
        a = i * 2 * np.pi / 5
        k.box(look.main, 0.5, 0.13, 0.012, x=0.36 * np.cos(a), y=0.36 * np.sin(a), z=0.16, turn=(0, 0, float(a)))


@kind(
    "potted plant",
    looks(
        ("green", "terracotta", "plant"),
        ("white", "white", "palm"),
        ("blue", "blue", "snakeplant"),
        ("black", "black", "plant"),
        ("tall", "gray", "palm"),
        ("small", "yellow", "snakeplant"),
    ),
)
def _potted_plant(k: Kit, look: Look) -> None:
    tall = look.trim == "palm"
    h = 1.05 if tall else 0.72
    k.mesh("pot", f"plain-{look.main}", 0.36, 0.36, 0.34)
    k.rod("plain-soil", 0.15, 0.02, z=0.29)
    if tall:
        k.rod("wood-walnut", 0.02, 0.36, z=0.3)
    k.mesh(look.trim, "foliage-leaf", 0.9 if tall else 0.66, 0.9 if tall else 0.66, h, z=0.6 if tall else 0.3)


@kind(
    "flowers",
    looks(
        ("red", "gloss-white", "plain-red"),
        ("yellow", "gloss-blue", "plain-yellow"),
        ("white", "gloss-glass", "plain-white"),
        ("pink", "gloss-teal", "plain-pink"),
    ),
    stand="top",
)
def _flowers(k: Kit, look: Look) -> None:
    k.mesh("vase", look.main, 0.14, 0.14, 0.22)
    k.mesh("flowers", "foliage-leaf", 0.3, 0.3, 0.3, z=0.18)
    for i in range(9):
        a, r = 2.4 * i, 0.03 + 0.012 * i
        k.mesh("blossom", look.trim, 0.075, 0.075, 0.06, x=r * np.cos(a), y=r * np.sin(a), z=0.43 - 0.013 * i)


@kind(
    "vase",
    looks(
        ("blue", "gloss-blue"), ("white", "gloss-white"), ("red", "gloss-red"), ("green", "gloss-teal"), ("gold", "gloss-gold")
    ),
    stand="top",
)
def _vase(k: Kit, look: Look) -> None:
    k.mesh("vase", look.main, 0.2, 0.2, 0.36)
    k.mesh("thinring", "gloss-gold", 0.208, 0.03, 0.208, z=0.058, turn=(HALF_PI, 0, 0))


@kind("candle", looks(("white", "plain-ivory", "gloss-brass"), ("red", "plain-red", "gloss-brass")), stand="top")
def _candle(k: Kit, look: Look) -> None:
    for x, h in ((-0.08, 0.16), (0.0, 0.24), (0.08, 0.12)):
        k.rod(look.trim, 0.04, 0.02, x=x)
        k.rod(look.main, 0.026, h, x=x, z=0.02)
        k.rod("plain-black", 0.003, 0.015, x=x, z=h + 0.02)
        k.mesh("pillow", "glow-flame", 0.02, 0.02, 0.045, x=x, z=h + 0.03)


@kind(
    "statue",
    looks(
        ("white marble", "marble-white", "marble-white"),
        ("black", "plain-charcoal", "marble-white"),
        ("gold", "gloss-gold", "marble-gray"),
    ),
)
def _statue(k: Kit, look: Look) -> None:
    k.box(look.trim, 0.38, 0.38, 0.06)
    k.mesh("column", look.trim, 0.34, 0.34, 0.84, z=0.06)
    k.mesh("bust", look.main, 0.36, 0.24, 0.54, z=0.9)
    k.mesh("cone", look.main, 0.05, 0.08, 0.09, y=0.07, z=1.27, turn=(-0.3, 0, 0))


@kind(
    "fireplace",
    looks(
        ("red brick", "brick-terracotta", "wood-walnut"),
        ("white marble", "marble-white", "marble-white"),
        ("gray stone", "stone-gray", "wood-oak"),
    ),
)
def _fireplace(k: Kit, look: Look) -> None:
    w, d = 1.5, 0.46
    for s in (-1, 1):
        k.box(look.main, 0.36, d - 0.06, 1.05, x=s * (w / 2 - 0.2), y=-0.03)
    k.box(look.main, w - 0.04, d - 0.06, 0.34, y=-0.03, z=0.74)
    k.box("plain-black", 0.8, 0.05, 0.74, y=-d / 2 + 0.04)
    k.box("fire-0", 0.62, 0.02, 0.42, y=-0.02, z=0.05)
    k.box(look.trim, w + 0.1, d + 0.04, 0.07, z=1.06)
    k.box(look.main, w, d + 0.02, 0.05)
    for s in (-1, 1):
        k.bar("wood-walnut", 0.045, 0.5, y=0.06 + s * 0.045, z=0.1)
    k.box(look.main, 0.9, 0.28, 1.3, y=-0.08, z=1.12)


@kind(
    "rug",
    looks(
        ("red", "rug-0"),
        ("blue", "rug-1"),
        ("gray", "rug-2"),
        ("green", "rug-3"),
        ("white", "carpet-white", "plain-navy"),
        ("beige", "carpet-beige", "plain-brown"),
    ),
    stand="flat",
)
def _rug(k: Kit, look: Look) -> None:
    if look.main.startswith("rug"):
        k.box(look.main, 2.1, 1.5, 0.014)
    else:
        # a plain rug has a border, else it is lost on a floor of its colour
        k.box(look.trim, 2.1, 1.5, 0.011)
        k.box(look.main, 1.92, 1.32, 0.014)
    for s in (-1, 1):
        k.box("plain-ivory", 0.05, 1.48, 0.008, x=s * 1.07)


@kind("round rug", looks(("blue", "roundrug-0"), ("red", "roundrug-1")), stand="flat")
def _round_rug(k: Kit, look: Look) -> None:
    k.mesh("disc", look.main, 1.6, 1.56, 0.014)


@kind(
    "doormat",
    looks(
        ("brown", "carpet-brown", "plain-chocolate"),
        ("gray", "carpet-gray", "plain-charcoal"),
        ("green", "carpet-olive", "plain-green"),
    ),
    stand="flat",
)
def _doormat(k: Kit, look: Look) -> None:
    k.box(look.trim, 0.8, 0.5, 0.01)
    k.box(look.main, 0.72, 0.42, 0.015)


@kind("bath mat", fabrics("white", "blue", "green", "pink", "gray", material="carpet"), stand="flat")
def _bath_mat(k: Kit, look: Look) -> None:
    k.mesh("cushion", look.main, 0.8, 0.5, 0.03)


@kind("runner rug", looks(("red", "runner-0"), ("blue", "runner-1"), ("gray", "runner-2")), stand="flat")
def _runner_rug(k: Kit, look: Look) -> None:
    k.box(look.main, 1.9, 0.7, 0.012)


@kind("column", looks(("white", "plain-white"), ("gray marble", "marble-silver"), ("beige stone", "stone-beige")))
def _column(k: Kit, look: Look) -> None:
    h = 2.4
    k.box(look.main, 0.36, 0.36, 0.1)
    k.mesh("column", look.main, 0.34, 0.34, h - 0.18, z=0.1)
    k.box(look.main, 0.36, 0.36, 0.08, z=h - 0.08)
