"""Shelves, racks, boxes and bins."""

from __future__ import annotations

import numpy as np

from spacevln.environments.houses.furniture.kit import Kit, Look, kind, looks, woods


@kind("bookshelf", (*woods("oak", "walnut", "white", "black"), *looks(("brown wooden tall", "wood-cherry", "wood-cherry"))))
def _bookshelf(k: Kit, look: Look) -> None:
    w, d, h = float(k.rng.choice([0.8, 1.0, 1.2])), 0.32, 1.9
    for s in (-1, 1):
        k.box(look.main, 0.03, d, h, x=s * (w / 2 - 0.015))
    k.box(look.main, w, 0.015, h, y=-d / 2 + 0.008)
    for i in range(6):
        z = 0.06 + i * (h - 0.09) / 5
        k.box(look.main, w - 0.05, d - 0.01, 0.03, z=z)
        if i < 5:
            span = (w - 0.1) * (1.0 if i % 2 else 0.78)
            k.box(
                f"books-{(i + look.variant + int(k.rng.integers(4))) % 4}",
                span,
                d - 0.1,
                0.25,
                x=-(w - 0.1 - span) / 2,
                y=-0.01,
                z=z + 0.03,
            )
            if i % 2 == 0:
                k.mesh("vase", ("gloss-teal", "gloss-orange", "gloss-white")[i // 2], 0.11, 0.11, 0.2, x=w / 2 - 0.13, z=z + 0.03)
    k.box(look.main, w, d - 0.02, 0.06)


@kind("cabinet", (*woods("oak", "white", "walnut", "gray"), *looks(("green", "plain-sage", "plain-sage"))), top_m=0.9)
def _cabinet(k: Kit, look: Look) -> None:
    w, d = 0.9, 0.42
    k.box("plain-black", w - 0.06, d - 0.06, 0.06)
    k.box(look.main, w, d - 0.03, 0.8, y=-0.015, z=0.06)
    k.box(look.main, w + 0.03, d, 0.04, z=0.86)
    k.fronts(look.main, "gloss-silver", w - 0.03, 0.76, d / 2 - 0.02, 0.08, 2, 1)


@kind(
    "filing cabinet",
    looks(
        ("gray metal", "plain-gray", "gloss-steel"),
        ("black metal", "plain-charcoal", "gloss-steel"),
        ("beige metal", "plain-beige", "gloss-steel"),
    ),
    top_m=1.1,
)
def _filing_cabinet(k: Kit, look: Look) -> None:
    w, d, h = 0.44, 0.55, 1.1
    k.box(look.main, w, d - 0.03, h, y=-0.015)
    k.fronts(look.main, look.trim, w - 0.02, h - 0.06, d / 2 - 0.02, 0.03, 1, 4, 0.02)
    for j in range(4):
        k.box("plain-white", 0.1, 0.01, 0.04, y=d / 2, z=0.2 + j * 0.26)


@kind(
    "storage rack",
    looks(
        ("gray metal", "plain-steel", "plain-charcoal"),
        ("black metal", "plain-charcoal", "plain-charcoal"),
        ("brown wooden", "wood-pine", "wood-pine"),
    ),
)
def _storage_rack(k: Kit, look: Look) -> None:
    w, d, h = 1.1, 0.42, 1.8
    k.legs(look.trim, w - 0.006, d - 0.006, h, 0.04)
    boxes = (
        ("cardboard-tan", 0.34, 0.3, 0.24), ("plain-blue", 0.3, 0.28, 0.18),
        ("plain-red", 0.22, 0.22, 0.26), ("plain-green", 0.3, 0.26, 0.2)
    )  # fmt: skip
    for i in range(4):
        z = 0.12 + i * 0.54
        k.box(look.main, w, d, 0.03, z=z)
        if i < 3:
            for j in range(3):
                stuff, bw, bd, bh = boxes[(i + j * 2 + int(k.rng.integers(3))) % 4]
                k.box(stuff, bw, bd, bh, x=(j - 1) * 0.35, z=z + 0.03)


@kind("shoe rack", woods("oak", "white", "black"), top_m=0.5)
def _shoe_rack(k: Kit, look: Look) -> None:
    w, d = 0.8, 0.3
    shoes = ("plain-red", "plain-black", "plain-white", "plain-brown", "plain-blue")
    for s in (-1, 1):
        k.box(look.main, 0.03, d, 0.5, x=s * (w / 2 - 0.015))
    for i, z in enumerate((0.06, 0.27, 0.47)):
        k.box(look.main, w, d, 0.025, z=z)
        for j in range(3 if i < 2 else 0):
            stuff = shoes[(i * 3 + j + int(k.rng.integers(5))) % 5]
            for s in (-1, 1):
                x = (j - 1) * 0.25 + s * 0.05
                k.mesh("small cushion", stuff, 0.085, 0.26, 0.07, x=x, z=z + 0.025)
                k.mesh("small cushion", stuff, 0.08, 0.11, 0.11, x=x, y=-0.07, z=z + 0.03)


@kind("coat rack", (*woods("oak", "black", "white"), *looks(("black metal", "gloss-black", "gloss-black"))))
def _coat_rack(k: Kit, look: Look) -> None:
    k.rod(look.main, 0.2, 0.04)
    k.rod(look.main, 0.025, 1.72, z=0.04)
    for i in range(6):
        a = i * np.pi / 3
        k.rod(
            look.main,
            0.012,
            0.2,
            x=0.09 * np.cos(a),
            y=0.09 * np.sin(a),
            z=1.58,
            turn=(-0.8 * float(np.sin(a)), 0.8 * float(np.cos(a)), 0),
        )
    k.mesh("cushion", "fabric-navy", 0.36, 0.16, 0.9, x=-0.06, y=0.13, z=0.74)
    k.mesh("cushion", "fabric-burgundy", 0.14, 0.32, 0.78, x=0.14, y=-0.02, z=0.84)
    k.rod("fabric-tan", 0.16, 0.015, z=1.74)
    k.mesh("pillow", "fabric-tan", 0.2, 0.2, 0.16, z=1.72)


@kind(
    "trash can",
    looks(
        ("gray metal", "brushed-silver", "plain-charcoal"),
        ("black", "plain-black", "plain-charcoal"),
        ("white", "plain-white", "plain-silver"),
        ("green", "plain-green", "plain-charcoal"),
    ),
)
def _trash_can(k: Kit, look: Look) -> None:
    k.rod(look.main, 0.15, 0.5, z=0.02)
    k.rod(look.trim, 0.155, 0.03)
    k.rod(look.trim, 0.156, 0.05, z=0.5)
    k.mesh("pillow", look.trim, 0.3, 0.3, 0.12, z=0.5)
    k.box(look.trim, 0.1, 0.06, 0.02, y=0.16, z=0.02)


@kind(
    "suitcase",
    looks(
        ("blue", "gloss-blue", "plain-silver"),
        ("red", "gloss-red", "plain-charcoal"),
        ("black", "gloss-black", "plain-silver"),
        ("yellow", "gloss-yellow", "plain-charcoal"),
    ),
)
def _suitcase(k: Kit, look: Look) -> None:
    k.mesh("cushion", look.main, 0.44, 0.26, 0.64, z=0.05)
    for i in range(4):
        k.box(look.main, 0.02, 0.27, 0.5, x=(i - 1.5) * 0.09, z=0.12)
    for s in (-1, 1):
        k.rod("plain-black", 0.03, 0.04, x=s * 0.17, y=0.08)
        k.rod("plain-black", 0.03, 0.04, x=s * 0.17, y=-0.08)
        k.rod(look.trim, 0.01, 0.34, x=s * 0.1, y=-0.08, z=0.66)
    k.box("plain-black", 0.24, 0.03, 0.035, y=-0.08, z=0.98)


@kind("cardboard box", looks(("brown", "cardboard-tan", "plain-beige")), top_m=0.4)
def _cardboard_box(k: Kit, look: Look) -> None:
    w, d, h = 0.5, 0.42, 0.4
    k.box(look.main, w, d, h)
    k.box(look.trim, w + 0.004, 0.06, h + 0.004, z=-0.002)
    k.box("plain-brown", 0.12, 0.004, 0.08, x=-0.12, y=d / 2, z=0.12)
    if k.rng.random() < 0.6:
        k.box(look.main, 0.36, 0.32, 0.26, x=0.03, z=h, turn=(0, 0, 0.25))
        k.box(look.trim, 0.364, 0.05, 0.262, x=0.03, z=h, turn=(0, 0, 0.25))


@kind(
    "laundry basket",
    (
        *looks(("brown wicker", "wicker-tan", "fabric-white"), ("white wicker", "wicker-white", "fabric-blue")),
        *looks(("blue", "plain-blue", "fabric-white")),
    ),
)
def _laundry_basket(k: Kit, look: Look) -> None:
    k.mesh("bucket", look.main, 0.5, 0.42, 0.5)
    for i, stuff in enumerate((look.trim, "fabric-red", "fabric-sky")):
        a = i * 2.1
        k.mesh("pillow", stuff, 0.28, 0.24, 0.22, x=0.08 * np.cos(a), y=0.07 * np.sin(a), z=0.36 + 0.03 * i)
    k.mesh("thinring", look.main, 0.52, 0.05, 0.44, z=0.28, turn=(np.pi / 2, 0, 0))


@kind(
    "toy box",
    looks(
        ("red", "plain-red", "plain-yellow"), ("blue", "plain-blue", "plain-orange"), ("brown wooden", "wood-pine", "plain-teal")
    ),
)
def _toy_box(k: Kit, look: Look) -> None:
    w, d, h = 0.8, 0.46, 0.42
    for s in (-1, 1):
        k.box(look.main, w, 0.025, h, y=s * (d / 2 - 0.012))
        k.box(look.main, 0.025, d, h, x=s * (w / 2 - 0.012))
    k.box(look.main, w, d, 0.28)
    k.box(look.trim, w, 0.03, 0.4, y=-d / 2 + 0.0, z=h, turn=(0.12, 0, 0))
    k.ball("gloss-red", 0.22, 0.22, 0.22, x=-0.24, z=0.3)
    k.box("plain-green", 0.16, 0.16, 0.16, x=0.02, z=0.32, turn=(0.3, 0.2, 0.4))
    k.box("plain-yellow", 0.14, 0.14, 0.14, x=0.26, y=0.05, z=0.34, turn=(0.1, 0.4, 0.7))
    k.ball("gloss-blue", 0.15, 0.15, 0.15, x=0.15, y=-0.1, z=0.38)
    for i, stuff in enumerate(("plain-yellow", "plain-green", "plain-white", "plain-orange")):
        k.rod(stuff, 0.06, 0.012, x=(i - 1.5) * 0.18, y=d / 2 - 0.002, z=0.2, turn=(np.pi / 2, 0, 0))


@kind("umbrella stand", looks(("gold metal", "gloss-brass", "fabric-red"), ("black metal", "plain-black", "fabric-blue")))
def _umbrella_stand(k: Kit, look: Look) -> None:
    k.mesh("bucket", look.main, 0.26, 0.26, 0.55)
    for i, stuff in enumerate((look.trim, "fabric-black", "fabric-green")):
        a = i * 2.1 + 0.4
        k.mesh("cone", stuff, 0.11, 0.11, 0.6, x=0.05 * np.cos(a), y=0.05 * np.sin(a), z=0.22, turn=(np.pi + 0.06, 0.05, 0))
        k.rod("wood-walnut", 0.012, 0.16, x=0.06 * np.cos(a), y=0.06 * np.sin(a), z=0.8)
        k.mesh("ring", "wood-walnut", 0.09, 0.03, 0.09, x=0.06 * np.cos(a) + 0.03, y=0.06 * np.sin(a), z=0.92)


@kind("wine rack", woods("walnut", "oak", "black"))
def _wine_rack(k: Kit, look: Look) -> None:
    w, d, h = 0.64, 0.32, 1.1
    k.box(look.main, w, 0.02, h, y=-d / 2 + 0.01)
    for i in range(5):
        k.box(look.main, 0.025, d, h, x=(i - 2) * (w - 0.03) / 4)
    for j in range(6):
        z = j * (h - 0.03) / 5
        k.box(look.main, w, d, 0.025, z=z)
        for i in range(4 if j < 5 else 0):
            if (i * 3 + j * 5) % 7 < 5:
                stuff = ("gloss-green", "gloss-burgundy", "gloss-olive")[(i + j) % 3]
                k.bar(stuff, 0.04, 0.26, x=(i - 1.5) * (w - 0.03) / 4, y=0.0, z=z + 0.075, along="y")
                k.bar("gloss-gold", 0.016, 0.1, x=(i - 1.5) * (w - 0.03) / 4, y=0.18, z=z + 0.075, along="y")


@kind(
    "clothes rack",
    looks(
        ("black metal", "gloss-black", "plain-charcoal"),
        ("silver metal", "gloss-silver", "plain-gray"),
        ("gold metal", "gloss-brass", "plain-black"),
    ),
)
def _clothes_rack(k: Kit, look: Look) -> None:
    w, h = 1.2, 1.6
    for s in (-1, 1):
        k.rod(look.main, 0.018, h, x=s * w / 2)
        k.box(look.main, 0.04, 0.5, 0.04, x=s * w / 2)
    k.bar(look.main, 0.018, w, z=h)
    k.bar(look.main, 0.014, w, z=0.2)
    clothes = ("red", "white", "navy", "yellow", "green", "black", "pink", "sky", "brown", "purple")
    for i, colour in enumerate(clothes):
        x, length = (i - 4.5) * 0.11, 0.75 + 0.12 * (i * 7 % 5)
        k.mesh("garment", f"fabric-{colour}", 0.06, 0.42, length + 0.04, x=x, z=h - 0.12 - length)
        k.box("plain-silver", 0.01, 0.01, 0.1, x=x, z=h - 0.09)
    k.box("cardboard-tan", 0.36, 0.3, 0.18, x=0.25, z=0.21)
