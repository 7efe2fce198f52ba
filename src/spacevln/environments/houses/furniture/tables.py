"""Tables and desks."""

from __future__ import annotations

from spacevln.environments.houses.furniture.kit import Kit, Look, kind, looks, woods


@kind(
    "dining table",
    (
        *woods("oak", "walnut", "white", "black"),
        *looks(("glass", "gloss-glass", "gloss-steel"), ("white marble", "marble-white", "plain-charcoal")),
    ),
    top_m=0.75,
)
def _dining_table(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.5, 1.8])), 0.9
    k.legs(look.trim, w - 0.1, d - 0.1, 0.71, 0.07)
    k.box(look.trim, w - 0.16, d - 0.16, 0.07, z=0.64)
    k.box(look.main, w, d, 0.04, z=0.71)


@kind("round table", (*woods("oak", "walnut", "white"), *looks(("round glass", "gloss-glass", "gloss-steel"))), top_m=0.74)
def _round_table(k: Kit, look: Look) -> None:
    r = 0.5
    k.rod(look.trim, 0.26, 0.04)
    k.mesh("turned", look.trim, 0.16, 0.16, 0.66, z=0.04)
    k.rod(look.main, r, 0.04, z=0.7)


@kind(
    "coffee table",
    (
        *woods("oak", "walnut", "white", "black"),
        *looks(("glass", "gloss-glass", "gloss-black"), ("white marble", "marble-white", "gloss-gold")),
    ),
    top_m=0.42,
)
def _coffee_table(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([0.95, 1.15])), 0.56
    k.legs(look.trim, w - 0.04, d - 0.04, 0.38, 0.05)
    k.box(look.main, w - 0.1, d - 0.1, 0.025, z=0.14)
    k.box(look.main, w, d, 0.04, z=0.38)
    k.box("plain-red", 0.22, 0.16, 0.03, x=-0.15, z=0.165)


@kind("end table", (*woods("walnut", "oak", "white", "black"), *looks(("round metal", "gloss-brass", "gloss-brass"))), top_m=0.56)
def _end_table(k: Kit, look: Look) -> None:
    if "round" in look.words:
        k.rod(look.main, 0.2, 0.02)
        k.rod(look.main, 0.02, 0.52, z=0.02)
        k.rod(look.main, 0.24, 0.025, z=0.535)
        return
    k.legs(look.trim, 0.44, 0.44, 0.53, 0.045)
    k.box(look.main, 0.4, 0.4, 0.02, z=0.15)
    k.box(look.main, 0.48, 0.48, 0.03, z=0.53)


@kind(
    "console table", (*woods("walnut", "oak", "white", "black"), *looks(("gold metal", "gloss-glass", "gloss-gold"))), top_m=0.8
)
def _console_table(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([0.9, 1.1])), 0.3
    k.legs(look.trim, w - 0.02, d - 0.02, 0.77, 0.04)
    k.box(look.main, w, d, 0.03, z=0.77)
    k.box(look.main, w - 0.06, d - 0.04, 0.02, z=0.2)
    k.box(look.trim, w - 0.06, d - 0.05, 0.1, z=0.67)


@kind(
    "desk",
    (*woods("oak", "walnut", "white", "black", "cherry"), *looks(("gray metal", "plain-gray", "plain-charcoal"))),
    top_m=0.75,
)
def _desk(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.25, 1.45])), 0.66
    k.box(look.main, w, d, 0.04, z=0.71)
    k.box(look.trim, 0.42, d - 0.06, 0.69, x=w / 2 - 0.23, z=0.02)
    for j in range(3):
        k.box(look.main, 0.38, 0.016, 0.21, x=w / 2 - 0.23, y=d / 2 - 0.025, z=0.05 + j * 0.22)
        k.box("gloss-silver", 0.12, 0.03, 0.018, x=w / 2 - 0.23, y=d / 2 - 0.01, z=0.15 + j * 0.22)
    k.box(look.trim, 0.05, d - 0.06, 0.71, x=-w / 2 + 0.04)
    k.box(look.trim, w - 0.5, 0.02, 0.4, x=-0.2, y=-d / 2 + 0.05, z=0.3)


@kind("patio table", looks(("round glass", "gloss-glass", "plain-charcoal"), ("white", "plain-white", "plain-white")), top_m=0.7)
def _patio_table(k: Kit, look: Look) -> None:
    k.rod(look.trim, 0.24, 0.03)
    k.rod(look.trim, 0.03, 0.64, z=0.03)
    k.mesh("disc", look.trim, 0.78, 0.7682, 0.034, z=0.66)
    k.mesh("disc", look.main, 0.73, 0.72, 0.03, z=0.67)


@kind(
    "pool table",
    looks(
        ("green", "plain-felt", "wood-mahogany"), ("blue", "plain-blue", "wood-walnut"), ("red", "plain-burgundy", "plain-black")
    ),
)
def _pool_table(k: Kit, look: Look) -> None:
    w, d = 1.95, 1.1
    for sx in (-1, 1):
        for sy in (-1, 1):
            k.mesh("turned", look.trim, 0.16, 0.16, 0.56, x=sx * (w / 2 - 0.2), y=sy * (d / 2 - 0.18))
            k.rod("plain-black", 0.055, 0.012, x=sx * (w / 2 - 0.12), y=sy * (d / 2 - 0.12), z=0.805)
    k.box(look.trim, w - 0.06, d - 0.06, 0.22, z=0.56)
    k.box(look.main, w - 0.2, d - 0.2, 0.02, z=0.78)
    for s in (-1, 1):
        k.box(look.trim, w, 0.11, 0.08, y=s * (d / 2 - 0.055), z=0.74)
        k.box(look.trim, 0.11, d, 0.08, x=s * (w / 2 - 0.055), z=0.74)
        k.rod("plain-black", 0.055, 0.012, y=s * (d / 2 - 0.1), z=0.812)
    balls = ("gloss-yellow", "gloss-red", "gloss-blue", "gloss-orange", "gloss-purple", "gloss-black")
    for i in range(3):
        for j in range(i + 1):
            k.ball(balls[i * (i + 1) // 2 + j], 0.065, 0.065, 0.065, x=0.4 + i * 0.06, y=(j - i / 2) * 0.07, z=0.8)
    k.ball("gloss-white", 0.065, 0.065, 0.065, x=-0.45, z=0.8)
    k.bar("wood-maple", 0.014, 1.3, x=-0.3, y=0.28, z=0.83)


@kind("ping pong table", looks(("green", "plain-green", "plain-charcoal"), ("blue", "plain-blue", "plain-charcoal")))
def _ping_pong_table(k: Kit, look: Look) -> None:
    w, d = 2.3, 1.3
    for s in (-1, 1):
        k.legs(look.trim, 0.5, d - 0.3, 0.72, 0.05, x=s * w / 4)
        k.box("plain-white", 0.03, d - 0.006, 0.006, x=s * (w / 2 - 0.018), z=0.757)
        k.box("plain-white", w - 0.006, 0.03, 0.006, y=s * (d / 2 - 0.018), z=0.757)
    k.box(look.main, w, d, 0.04, z=0.72)
    k.box("plain-white", w - 0.006, 0.015, 0.006, z=0.757)
    k.box("tile-silver", 0.012, d + 0.094, 0.13, z=0.76)
    k.box("plain-white", 0.016, d + 0.1, 0.02, z=0.885)
    k.rod("plain-red", 0.08, 0.015, x=0.7, y=0.2, z=0.765)
    k.box("wood-oak", 0.12, 0.03, 0.012, x=0.83, y=0.2, z=0.765)
    k.ball("gloss-orange", 0.045, 0.045, 0.045, x=-0.5, y=-0.2, z=0.76)


@kind("foosball table", looks(("brown wooden", "wood-oak", "plain-black"), ("black", "plain-black", "plain-charcoal")))
def _foosball_table(k: Kit, look: Look) -> None:
    w, d = 1.25, 0.68
    k.legs(look.trim, w, d, 0.6, 0.09)
    k.box("plain-green", w - 0.06, d - 0.06, 0.1, z=0.62)
    for s in (-1, 1):
        k.box(look.main, w, 0.04, 0.26, y=s * (d / 2 - 0.02), z=0.6)
        k.box(look.main, 0.04, d, 0.26, x=s * (w / 2 - 0.02), z=0.6)
    for i in range(6):
        x = (i - 2.5) * 0.18
        k.bar("gloss-steel", 0.01, d + 0.24, x=x, z=0.82, along="y")
        k.bar("plain-black", 0.02, 0.1, x=x, y=(d / 2 + 0.1) * (1 if i % 2 else -1), z=0.82, along="y")
        for j in range(3):
            k.box("plain-red" if i % 2 else "plain-blue", 0.03, 0.03, 0.11, x=x, y=(j - 1) * 0.18, z=0.73)
