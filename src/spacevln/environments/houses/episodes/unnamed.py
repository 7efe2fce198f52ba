"""Categories that no instruction names."""

NEVER_LANDMARKS = frozenset(
    (
        "ceiling lamp",
        "ceiling fan",
        "chandelier",
        "curtain",
        "exit sign",
        "light switch",
        "pillow",
        "range hood",
        "candle",
        "vase",
    )
)
