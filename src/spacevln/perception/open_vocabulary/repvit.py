"""RepViT-M2.3 as RepViT-SAM's image encoder (Wang et al., "RepViT-SAM", arXiv 2312.05760), in its training form.

Names follow the published checkpoint, so that it loads as it is: ``features.0`` is the stem, ``features.N`` a block of a token
mixer and a channel mixer, ``neck`` brings the last width to the decoder's.
"""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass
from typing import Any

import torch
from torch import nn

EPS = 1e-6


@dataclass(frozen=True, slots=True)
class EncoderShape:
    """Widths and depths.

    Args:
        widths: channels of the four stages.
        depths: plain blocks of the four stages; before the last three stages stands a down block.
        last_stride: of the last down block; 1 in RepViT-SAM (2 in the classifier), so that 1024 pixels give 64 cells.
        out_width: channels of the embedding.
    """

    widths: tuple[int, int, int, int] = (80, 160, 320, 640)
    depths: tuple[int, int, int, int] = (7, 7, 35, 2)
    last_stride: int = 1
    out_width: int = 256


class ConvNorm(nn.Sequential):
    """A convolution without bias and its batch norm."""

    def __init__(self, width_in: int, width_out: int, size: int = 1, stride: int = 1, groups: int = 1) -> None:
        convolution = nn.Conv2d(width_in, width_out, size, stride, size // 2, groups=groups, bias=False)
        super().__init__(OrderedDict(c=convolution, bn=nn.BatchNorm2d(width_out)))


class ThreeBranches(nn.Module):
    """A depthwise 3x3, a depthwise 1x1 and the identity, added up and normalised."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.conv = ConvNorm(width, width, 3, groups=width)
        self.conv1 = nn.Conv2d(width, width, 1, groups=width)
        self.bn = nn.BatchNorm2d(width)

    def forward(self, x: Any) -> Any:
        """(B, C, H, W) to the same."""
        return self.bn(self.conv(x) + self.conv1(x) + x)


class SqueezeExcite(nn.Module):
    """Channels weighed by their mean over the image."""

    def __init__(self, width: int) -> None:
        super().__init__()
        squeezed = _multiple_of_8(width / 4)
        self.fc1 = nn.Conv2d(width, squeezed, 1)
        self.fc2 = nn.Conv2d(squeezed, width, 1)

    def forward(self, x: Any) -> Any:
        """(B, C, H, W) to the same."""
        mean = x.mean((2, 3), keepdim=True)
        return x * self.fc2(self.fc1(mean).relu()).sigmoid()


class Residual(nn.Module):
    """The input added to what a module makes of it."""

    def __init__(self, module: nn.Module) -> None:
        super().__init__()
        self.m = module

    def forward(self, x: Any) -> Any:
        """(B, C, H, W) to the same."""
        return x + self.m(x)


class Block(nn.Module):
    """A token mixer, then a channel mixer with a residual."""

    def __init__(self, token_mixer: nn.Sequential, width: int) -> None:
        super().__init__()
        self.token_mixer = token_mixer
        self.channel_mixer = Residual(nn.Sequential(ConvNorm(width, 2 * width), nn.GELU(), ConvNorm(2 * width, width)))

    def forward(self, x: Any) -> Any:
        """(B, C, H, W) to (B, C', H', W')."""
        return self.channel_mixer(self.token_mixer(x))


class ChannelNorm(nn.Module):
    """Layer norm over the channels of each pixel."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.ones(width))
        self.bias = nn.Parameter(torch.zeros(width))

    def forward(self, x: Any) -> Any:
        """(B, C, H, W) to the same."""
        mean = x.mean(1, keepdim=True)
        variance = (x - mean).pow(2).mean(1, keepdim=True)
        return (x - mean) / (variance + EPS).sqrt() * self.weight[:, None, None] + self.bias[:, None, None]


class RepViTEncoder(nn.Module):
    """An image (B, 3, S, S) to its embedding (B, 256, S / 16, S / 16)."""

    def __init__(self, shape: EncoderShape | None = None) -> None:
        super().__init__()
        shape = shape or EncoderShape()
        first = shape.widths[0]
        blocks: list[nn.Module] = [
            nn.Sequential(ConvNorm(3, first // 2, 3, stride=2), nn.GELU(), ConvNorm(first // 2, first, 3, stride=2))
        ]
        for stage, (width, depth) in enumerate(zip(shape.widths, shape.depths, strict=True)):
            if stage:
                blocks.append(_down(shape.widths[stage - 1], width, shape.last_stride if stage == 3 else 2))
            # every second block weighs its channels, but never a stage's last one
            blocks += [_plain(width, excite=n % 2 == 0 and n < depth - 1) for n in range(depth)]
        self.features = nn.ModuleList(blocks)
        self.neck = nn.Sequential(
            nn.Conv2d(shape.widths[-1], shape.out_width, 1, bias=False),
            ChannelNorm(shape.out_width),
            nn.Conv2d(shape.out_width, shape.out_width, 3, padding=1, bias=False),
            ChannelNorm(shape.out_width),
        )

    def forward(self, x: Any) -> Any:
        """See the class."""
        for block in self.features:
            x = block(x)
        return self.neck(x)


def _plain(width: int, *, excite: bool) -> Block:
    return Block(nn.Sequential(ThreeBranches(width), SqueezeExcite(width) if excite else nn.Identity()), width)


def _down(width_in: int, width_out: int, stride: int) -> Block:
    mixer = nn.Sequential(
        ConvNorm(width_in, width_in, 3, stride=stride, groups=width_in), nn.Identity(), ConvNorm(width_in, width_out)
    )
    return Block(mixer, width_out)


def _multiple_of_8(width: float) -> int:
    """The nearest multiple, but never more than a tenth below."""
    nearest = max(8, int(width + 4) // 8 * 8)
    return nearest + 8 if nearest < 0.9 * width else nearest
