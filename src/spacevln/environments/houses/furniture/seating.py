"""Sofas, chairs, benches, stools."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, fabrics, kind, looks, woods

_SOFAS = (
    *looks(
        ("white leather", "leather-white", "plain-steel"),
        ("black leather", "leather-black", "plain-steel"),
        ("brown leather", "leather-brown", "wood-walnut"),
    ),
    *fabrics("red", "blue", "gray", "green", "beige", "yellow"),
)


@kind("sofa", _SOFAS)
def _sofa(k: Kit, look: Look) -> None:
    w, d = float(k.rng.choice([1.7, 1.95, 2.2])), 0.9
    seats = 2 if w < 1.8 else 3
    inner = w - 0.4
    k.legs(look.trim, w - 0.1, d - 0.1, 0.1, 0.06)
    k.box(look.main, w - 0.06, d - 0.04, 0.2, z=0.1)
    k.box(look.main, w - 0.1, 0.2, 0.52, y=-d / 2 + 0.1, z=0.28)
    for s in (-1, 1):
        k.mesh("cushion", look.main, 0.22, d, 0.5, x=s * (w / 2 - 0.11), z=0.12)
    for i in range(seats):
        x = (i - (seats - 1) / 2) * inner / seats
        k.mesh("cushion", look.main, inner / seats, d - 0.2, 0.2, x=x, y=0.08, z=0.27)
        k.mesh("cushion", look.main, inner / seats - 0.01, 0.24, 0.48, x=x, y=-d / 2 + 0.25, z=0.42, turn=(0.15, 0, 0))
    accent = "fabric-orange" if look.words[0] in {"blue", "gray", "black"} else "fabric-navy"
    for s in (-1, 1):
        k.mesh("pillow", accent, 0.4, 0.16, 0.4, x=s * (inner / 2 - 0.2), y=-0.06, z=0.46, turn=(0.3, 0, s * 0.15))


@kind(
    "armchair",
    (
        *fabrics("blue", "red", "gray", "green", "cream", "orange"),
        *looks(("brown leather", "leather-brown", "wood-walnut"), ("black leather", "leather-black", "plain-steel")),
    ),
)
def _armchair(k: Kit, look: Look) -> None:
    w, d = 0.82, 0.8
    k.legs(look.trim, w - 0.08, d - 0.08, 0.12, 0.06)
    k.box(look.main, w - 0.06, d - 0.06, 0.18, z=0.12)
    k.mesh("cushion", look.main, w - 0.3, d - 0.14, 0.2, y=0.06, z=0.28)
    k.mesh("cushion", look.main, w - 0.08, 0.22, 0.7, y=-d / 2 + 0.14, z=0.25, turn=(0.12, 0, 0))
    for s in (-1, 1):
        k.mesh("cushion", look.main, 0.18, d, 0.46, x=s * (w / 2 - 0.09), z=0.14)


@kind("dining chair", (*woods("oak", "walnut", "white", "black"), *fabrics("red", "blue", "gray")))
def _dining_chair(k: Kit, look: Look) -> None:
    w, d, frame = 0.44, 0.46, look.trim
    k.legs(frame, w, d, 0.43, 0.04)
    k.box(look.main, w, d, 0.05, z=0.43)
    for s in (-1, 1):
        k.box(frame, 0.04, 0.04, 0.46, x=s * (w / 2 - 0.02), y=-d / 2 + 0.02, z=0.48)
    k.box(look.main, w - 0.06, 0.03, 0.115, y=-d / 2 + 0.02, z=0.82)
    for x in (-0.1, 0.0, 0.1):
        k.box(look.main if look.main.startswith("fabric") else frame, 0.05, 0.02, 0.34, x=x, y=-d / 2 + 0.02, z=0.48)


@kind(
    "office chair",
    (*fabrics("black", "blue", "red", "gray", trim="plain-charcoal"), *looks(("white leather", "leather-white", "plain-silver"))),
)
def _office_chair(k: Kit, look: Look) -> None:
    for i in range(5):
        a = i * 2 * np.pi / 5
        k.box(look.trim, 0.28, 0.05, 0.04, x=0.14 * np.cos(a), y=0.14 * np.sin(a), z=0.06, turn=(0, 0, float(a)))
        k.rod("plain-black", 0.03, 0.06, x=0.27 * np.cos(a), y=0.27 * np.sin(a))
    k.rod("plain-steel", 0.03, 0.34, z=0.09)
    k.mesh("cushion", look.main, 0.5, 0.48, 0.1, z=0.43)
    k.box(look.trim, 0.06, 0.03, 0.3, y=-0.24, z=0.44)
    k.mesh("cushion", look.main, 0.46, 0.1, 0.56, y=-0.25, z=0.58)
    for s in (-1, 1):
        k.box(look.trim, 0.04, 0.05, 0.18, x=s * 0.26, z=0.48)
        k.box(look.trim, 0.06, 0.28, 0.03, x=s * 0.26, z=0.66)


@kind("stool", (*woods("oak", "white", "black", "red"), *looks(("blue", "plain-blue", "wood-oak"))))
def _stool(k: Kit, look: Look) -> None:
    for s in (-1, 1):
        for t in (-1, 1):
            k.rod(look.trim, 0.018, 0.44, x=s * 0.12, y=t * 0.12, turn=(-t * 0.1, s * 0.1, 0))
    k.rod(look.main, 0.18, 0.05, z=0.43)


@kind(
    "bar stool",
    looks(
        ("black leather", "leather-black", "gloss-steel"),
        ("red leather", "leather-red", "gloss-steel"),
        ("white leather", "leather-white", "gloss-steel"),
        ("brown wooden", "wood-oak", "wood-oak"),
    ),
)
def _bar_stool(k: Kit, look: Look) -> None:
    k.rod(look.trim, 0.2, 0.03)
    k.rod(look.trim, 0.03, 0.66, z=0.03)
    k.mesh("thinring", look.trim, 0.32, 0.03, 0.32, z=0.08, turn=(np.pi / 2, 0, 0))
    k.rod(look.main, 0.19, 0.09, z=0.68)
    k.box(look.main, 0.34, 0.05, 0.2, y=-0.15, z=0.76)


@kind("bench", (*woods("oak", "walnut", "white"), *looks(("black metal", "plain-black", "plain-black"))), top_m=0.46)
def _bench(k: Kit, look: Look) -> None:
    w = float(k.rng.choice([1.1, 1.3]))
    for i in range(3):
        k.box(look.main, w, 0.11, 0.04, y=(i - 1) * 0.13, z=0.42)
    for s in (-1, 1):
        k.box(look.trim, 0.06, 0.36, 0.42, x=s * (w / 2 - 0.12))
    k.box(look.trim, w - 0.24, 0.05, 0.06, z=0.14)


@kind("ottoman", fabrics("gray", "blue", "red", "cream", "green", "purple", trim="plain-brown"))
def _ottoman(k: Kit, look: Look) -> None:
    k.rod("wood-walnut", 0.24, 0.05)
    k.rod(look.main, 0.29, 0.3, z=0.05)
    k.mesh("pillow", look.main, 0.58, 0.58, 0.16, z=0.29)
    k.mesh("thinring", "plain-brown", 0.585, 0.03, 0.585, z=0.02, turn=(np.pi / 2, 0, 0))


@kind("rocking chair", woods("walnut", "oak", "white"))
def _rocking_chair(k: Kit, look: Look) -> None:
    m = look.main
    for s in (-1, 1):
        k.mesh("rocker", m, 0.05, 0.95, 0.16, x=s * 0.26, z=0.0)
        k.rod(m, 0.02, 0.56, x=s * 0.26, y=0.2, z=0.08)
        k.rod(m, 0.02, 0.98, x=s * 0.24, y=-0.26, z=0.1, turn=(0.16, 0, 0))
        k.box(m, 0.06, 0.56, 0.03, x=s * 0.26, y=-0.02, z=0.62)
    k.box(m, 0.52, 0.5, 0.04, z=0.4)
    for i in range(5):
        k.rod(m, 0.012, 0.6, x=(i - 2) * 0.09, y=-0.27, z=0.44, turn=(0.16, 0, 0))
    k.box(m, 0.54, 0.03, 0.13, y=-0.33, z=0.98, turn=(0.16, 0, 0))
    k.mesh("pillow", "fabric-burgundy", 0.46, 0.44, 0.09, z=0.43)


@kind(
    "patio chair",
    looks(
        ("white wicker", "wicker-white", "fabric-teal"),
        ("brown wicker", "wicker-tan", "fabric-white"),
        ("black wicker", "wicker-charcoal", "fabric-red"),
    ),
)
def _patio_chair(k: Kit, look: Look) -> None:
    k.box(look.main, 0.68, 0.66, 0.36, z=0.02)
    k.box(look.main, 0.68, 0.1, 0.4, y=-0.28, z=0.36)
    for s in (-1, 1):
        k.box(look.main, 0.09, 0.6, 0.24, x=s * 0.295, z=0.36)
    k.mesh("cushion", look.trim, 0.5, 0.5, 0.12, y=0.06, z=0.37)
    k.mesh("cushion", look.trim, 0.48, 0.12, 0.36, y=-0.2, z=0.44, turn=(0.15, 0, 0))
