"""Names and shapes of the published ``repvit_sam.pt``, written down from its description and not from our model."""

from __future__ import annotations

from collections.abc import Iterator

Shape = tuple[int, ...]
Entry = tuple[str, Shape]


def norm(name: str, width: int) -> Iterator[Entry]:
    for part in ("weight", "bias", "running_mean", "running_var"):
        yield f"{name}.{part}", (width,)
    yield f"{name}.num_batches_tracked", ()


def convolution(name: str, shape: Shape) -> Iterator[Entry]:
    yield f"{name}.c.weight", shape
    yield from norm(f"{name}.bn", shape[0])


def channel_mixer(block: str, width: int) -> Iterator[Entry]:
    yield from convolution(f"{block}.channel_mixer.m.0", (2 * width, width, 1, 1))
    yield from convolution(f"{block}.channel_mixer.m.2", (width, 2 * width, 1, 1))


def plain_block(block: str, width: int, squeezed: int | None) -> Iterator[Entry]:
    yield from convolution(f"{block}.token_mixer.0.conv", (width, 1, 3, 3))
    yield from linear(f"{block}.token_mixer.0.conv1", (width, 1, 1, 1))
    yield from norm(f"{block}.token_mixer.0.bn", width)
    if squeezed:
        yield from linear(f"{block}.token_mixer.1.fc1", (squeezed, width, 1, 1))
        yield from linear(f"{block}.token_mixer.1.fc2", (width, squeezed, 1, 1))
    yield from channel_mixer(block, width)


def down_block(block: str, width: int) -> Iterator[Entry]:
    yield from convolution(f"{block}.token_mixer.0", (width, 1, 3, 3))
    yield from convolution(f"{block}.token_mixer.2", (2 * width, width, 1, 1))
    yield from channel_mixer(block, 2 * width)


def image_encoder() -> Iterator[Entry]:
    yield from convolution("features.0.0", (40, 3, 3, 3))
    yield from convolution("features.0.2", (80, 40, 3, 3))
    squeezed = {80: 24, 160: 40, 320: 80, 640: 160}
    excited = {1, 3, 5, 9, 11, 13, *range(17, 50, 2), 53}
    for index in range(1, 55):
        block = f"features.{index}"
        if index in (8, 16, 52):
            yield from down_block(block, {8: 80, 16: 160, 52: 320}[index])
        else:
            width = 80 if index < 8 else 160 if index < 16 else 320 if index < 52 else 640
            yield from plain_block(block, width, squeezed[width] if index in excited else None)
    yield "neck.0.weight", (256, 640, 1, 1)
    yield from linear("neck.1", (256,))
    yield "neck.2.weight", (256, 256, 3, 3)
    yield from linear("neck.3", (256,))


def linear(name: str, shape: Shape) -> Iterator[Entry]:
    yield f"{name}.weight", shape
    yield f"{name}.bias", shape[:1]


def upward(name: str, shape: Shape) -> Iterator[Entry]:
    yield f"{name}.weight", shape
    yield f"{name}.bias", (shape[1],)


def prompt_encoder() -> Iterator[Entry]:
    yield "pe_layer.positional_encoding_gaussian_matrix", (2, 128)
    for index in range(4):
        yield f"point_embeddings.{index}.weight", (1, 256)
    yield "not_a_point_embed.weight", (1, 256)
    yield from linear("mask_downscaling.0", (4, 1, 2, 2))
    yield from linear("mask_downscaling.1", (4,))
    yield from linear("mask_downscaling.3", (16, 4, 2, 2))
    yield from linear("mask_downscaling.4", (16,))
    yield from linear("mask_downscaling.6", (256, 16, 1, 1))
    yield "no_mask_embed.weight", (1, 256)


def attention(name: str, inner: int) -> Iterator[Entry]:
    for part in ("q_proj", "k_proj", "v_proj"):
        yield from linear(f"{name}.{part}", (inner, 256))
    yield from linear(f"{name}.out_proj", (256, inner))


def mask_decoder() -> Iterator[Entry]:
    for index in range(2):
        layer = f"transformer.layers.{index}"
        yield from attention(f"{layer}.self_attn", 256)
        yield from linear(f"{layer}.norm1", (256,))
        yield from attention(f"{layer}.cross_attn_token_to_image", 128)
        yield from linear(f"{layer}.norm2", (256,))
        yield from linear(f"{layer}.mlp.lin1", (2048, 256))
        yield from linear(f"{layer}.mlp.lin2", (256, 2048))
        yield from linear(f"{layer}.norm3", (256,))
        yield from linear(f"{layer}.norm4", (256,))
        yield from attention(f"{layer}.cross_attn_image_to_token", 128)
    yield from attention("transformer.final_attn_token_to_image", 128)
    yield from linear("transformer.norm_final_attn", (256,))
    yield "iou_token.weight", (1, 256)
    yield "mask_tokens.weight", (4, 256)
    yield from upward("output_upscaling.0", (256, 64, 2, 2))
    yield from linear("output_upscaling.1", (64,))
    yield from upward("output_upscaling.3", (64, 32, 2, 2))
    for index in range(4):
        yield from perceptron(f"output_hypernetworks_mlps.{index}", 32)
    yield from perceptron("iou_prediction_head", 4)


def perceptron(name: str, width_out: int) -> Iterator[Entry]:
    yield from linear(f"{name}.layers.0", (256, 256))
    yield from linear(f"{name}.layers.1", (256, 256))
    yield from linear(f"{name}.layers.2", (width_out, 256))


def layout() -> dict[str, Shape]:
    """All 1598 entries."""
    parts = {"image_encoder": image_encoder(), "prompt_encoder": prompt_encoder(), "mask_decoder": mask_decoder()}
    return {f"{part}.{name}": shape for part, entries in parts.items() for name, shape in entries}
