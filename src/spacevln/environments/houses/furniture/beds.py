"""Beds and what stands in bedrooms."""

from __future__ import annotations

from spacevln.environments.houses.furniture.kit import Kit, Look, kind, looks, woods


@kind(
    "bed",
    looks(
        ("white", "fabric-white", "wood-oak"),
        ("blue", "fabric-blue", "wood-walnut"),
        ("red", "fabric-red", "wood-walnut"),
        ("gray", "fabric-gray", "plain-white"),
        ("green", "fabric-sage", "wood-pine"),
        ("pink floral", "floral-pink", "plain-white"),
        ("blue plaid", "plaid-sky", "wood-oak"),
        ("purple", "fabric-purple", "plain-black"),
    ),
)
def _bed(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.4, 1.6])), 2.08
    k.box(look.trim, w + 0.08, 0.07, 1.1, y=-d / 2 + 0.035)
    k.box(look.trim, w + 0.04, d - 0.08, 0.24, y=0.03, z=0.08)
    k.box(look.trim, w + 0.06, 0.05, 0.46, y=d / 2 - 0.025)
    k.box("plain-white", w - 0.04, d - 0.16, 0.18, z=0.3)
    k.box(look.main, w + 0.05, d - 0.64, 0.17, y=0.25, z=0.33)
    k.mesh("cushion", look.main, w + 0.05, d - 0.62, 0.12, y=0.25, z=0.44)
    k.mesh("cushion", "plain-white", w + 0.045, 0.24, 0.12, y=-0.36, z=0.46)
    for s in (-1, 1):
        k.mesh("pillow", "fabric-white", w / 2 - 0.1, 0.42, 0.2, x=s * w / 4, y=-d / 2 + 0.36, z=0.46, turn=(0.35, 0, 0))
        k.mesh("pillow", look.main, w / 2 - 0.28, 0.3, 0.16, x=s * w / 4, y=-d / 2 + 0.55, z=0.48, turn=(0.6, 0, 0))


@kind(
    "bunk bed",
    looks(
        ("brown wooden", "wood-pine", "fabric-blue"),
        ("white", "plain-white", "fabric-red"),
        ("gray metal", "plain-charcoal", "fabric-green"),
    ),
)
def _bunk_bed(k: Kit, look: Look) -> None:
    w, d = 2.0, 0.96
    k.legs(look.main, w, d, 1.72, 0.07)
    for z in (0.3, 1.2):
        k.box(look.main, w, d, 0.12, z=z)
        k.mesh("cushion", look.trim, w - 0.12, d - 0.1, 0.2, z=z + 0.1)
        k.mesh("pillow", "fabric-white", 0.34, 0.6, 0.16, x=-w / 2 + 0.28, z=z + 0.26)
    k.box(look.main, w * 0.64, 0.04, 0.07, x=-w * 0.18, y=d / 2 - 0.02, z=1.6)
    k.box(look.main, w, 0.04, 0.07, y=-d / 2 + 0.02, z=1.6)
    for s in (-1, 1):
        k.box(look.main, 0.04, 0.05, 1.66, x=w / 2 - 0.36 + s * 0.2, y=d / 2 + 0.03)
    for i in range(5):
        k.box(look.main, 0.4, 0.04, 0.04, x=w / 2 - 0.36, y=d / 2 + 0.03, z=0.25 + i * 0.28)


@kind("crib", woods("white", "oak", "gray"))
def _crib(k: Kit, look: Look) -> None:
    w, d = 1.24, 0.68
    k.legs(look.main, w, d, 0.95, 0.05)
    k.box(look.main, w - 0.06, d - 0.06, 0.05, z=0.32)
    k.mesh("cushion", "fabric-sky", w - 0.1, d - 0.1, 0.14, z=0.36)
    for s in (-1, 1):
        k.box(look.main, w, 0.035, 0.05, y=s * (d / 2 - 0.02), z=0.88)
        k.box(look.main, 0.035, d, 0.05, x=s * (w / 2 - 0.02), z=0.88)
        for i in range(9):
            k.box(look.main, 0.022, 0.022, 0.54, x=(i - 4) * w / 9.4, y=s * (d / 2 - 0.02), z=0.35)
        for i in range(4):
            k.box(look.main, 0.022, 0.022, 0.54, x=s * (w / 2 - 0.02), y=(i - 1.5) * d / 4.6, z=0.35)
    k.mesh("pillow", "fabric-yellow", 0.2, 0.3, 0.1, x=-0.4, z=0.48)


@kind("nightstand", woods("oak", "walnut", "white", "black", "cherry"), top_m=0.55)
def _nightstand(k: Kit, look: Look) -> None:
    w, d = 0.46, 0.4
    k.legs(look.trim, w, d, 0.12, 0.05)
    k.box(look.main, w, d - 0.03, 0.4, y=-0.015, z=0.12)
    k.box(look.main, w + 0.03, d, 0.03, z=0.52)
    k.fronts(look.main, "gloss-brass", w - 0.04, 0.36, d / 2 - 0.025, 0.14, 1, 2)


@kind("dresser", woods("oak", "walnut", "white", "black", "cherry", "gray"), top_m=0.86)
def _dresser(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.1, 1.3])), 0.46
    k.legs(look.trim, w, d, 0.1, 0.06)
    k.box(look.main, w, d - 0.04, 0.72, y=-0.02, z=0.1)
    k.box(look.main, w + 0.04, d, 0.04, z=0.82)
    k.fronts(look.main, "gloss-brass", w - 0.06, 0.68, d / 2 - 0.03, 0.12, 2, 3)


@kind("wardrobe", woods("oak", "walnut", "white", "cherry"))
def _wardrobe(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.1, 1.4])), 0.58
    k.box("plain-black", w - 0.06, d - 0.06, 0.08)
    k.box(look.main, w, d - 0.04, 1.86, y=-0.02, z=0.08)
    k.box(look.main, w + 0.06, d, 0.06, z=1.94)
    k.fronts(look.main, "gloss-silver", w - 0.04, 1.8, d / 2 - 0.03, 0.12, 2 if w < 1.3 else 3, 1)


@kind("vanity table", woods("white", "oak", "black"), top_m=0.75)
def _vanity_table(k: Kit, look: Look) -> None:
    w, d = 0.95, 0.42
    k.legs(look.trim, w, d, 0.6, 0.045)
    k.box(look.main, w, d, 0.15, z=0.6)
    k.fronts(look.main, "gloss-gold", w - 0.04, 0.12, d / 2 + 0.004, 0.615, 3, 1)
    k.mesh("thinring", "gloss-gold", 0.58, 0.05, 0.68, y=-d / 2 + 0.06, z=0.8)
    k.mesh("face", "mirror-1", 0.54, 0.02, 0.64, y=-d / 2 + 0.06, z=0.82)
    k.box("gloss-gold", 0.06, 0.05, 0.1, y=-d / 2 + 0.06, z=0.74)
    k.mesh("bottle", "gloss-pink", 0.05, 0.05, 0.14, x=0.32, z=0.75)
    k.mesh("bottle", "gloss-teal", 0.06, 0.06, 0.1, x=0.39, y=0.05, z=0.75)
