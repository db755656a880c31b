"""The quad network in torch: a U-Net on a small grid, equivariant under the eight relabellings of a quad.

Around a body the same layers go round along xi, where a quad's see zeros outside the grid.

Ronneberger, Fischer, Brox, U-Net, MICCAI 2015, with residual blocks and group convolutions
(`meshonet.solvers.neural.quad.symmetry`). Inference in numpy is `meshonet.solvers.neural.quad.network`.
"""

from collections.abc import Sequence
from itertools import pairwise

import torch
from torch import Tensor, nn
from torch.nn import functional

from meshonet.solvers.neural.quad import symmetry
from meshonet.solvers.neural.quad.encoding import FEATURES, HEADS
from meshonet.solvers.neural.quad.symmetry import ELEMENTS, ORDER, SEEN


class GroupConvolution(nn.Module):
    """A convolution of `into` sets of channels to `out`, zero outside the grid.

    `gain`: of the random weights at the start, over He's; `around`: the grid goes round along xi.
    """

    places: Tensor

    def __init__(
        self, into: int, out: int, size: int = 3, stride: int = 1, gain: float = 1.0, around: bool = False
    ) -> None:
        super().__init__()
        spread = gain * (2.0 / (into * ORDER * size * size)) ** 0.5
        self.weight = nn.Parameter(spread * torch.randn(out, into, ORDER, size, size))
        self.bias = nn.Parameter(torch.zeros(out))
        self.stride, self.padding, self.around = stride, size // 2, around
        self.register_buffer("places", torch.from_numpy(symmetry.table(size)), persistent=False)

    def forward(self, x: Tensor) -> Tensor:
        """Return (batch, 8 out, ...) for `x` (batch, 8 in, m, n)."""
        kernel = symmetry.convolution(self.weight, self.places, torch)
        bias = self.bias.repeat_interleave(ORDER)
        along = self.padding
        if self.around and self.padding:
            x, along = functional.pad(x, (0, 0, self.padding, self.padding), mode="circular"), 0
        return functional.conv2d(x, kernel, bias, stride=self.stride, padding=(along, self.padding))


class ResidualBlock(nn.Module):
    """x + b(silu(a(silu(x))))."""

    def __init__(self, width: int, around: bool = False) -> None:
        super().__init__()
        self.a = GroupConvolution(width, width, around=around)
        self.b = GroupConvolution(width, width, gain=0.3, around=around)

    def forward(self, x: Tensor) -> Tensor:
        """Return as many channels as `x` has."""
        more: Tensor = self.b(functional.silu(self.a(functional.silu(x))))
        return x + more


class QuadUNet(nn.Module):
    """Features of a grid to displacements of its nodes.

    `widths` are sets of eight channels on each level, the finest first, each with every second node; `blocks`
    residual blocks on each, on the way down and on the way up; `around`, O grids go round along xi.
    """

    seen: Tensor
    elements: Tensor

    def __init__(self, widths: Sequence[int], blocks: Sequence[int], around: bool = False) -> None:
        super().__init__()
        count, self.around = len(widths), around
        self.lift = nn.Parameter(FEATURES**-0.5 * torch.randn(widths[0], FEATURES))
        self.lift_bias = nn.Parameter(torch.zeros(widths[0]))
        pairs = list(pairwise(widths))
        self.down = nn.ModuleList(GroupConvolution(a, b, stride=2, around=around) for a, b in pairs)
        self.up = nn.ModuleList(GroupConvolution(b, a, size=1) for a, b in pairs)
        self.before = nn.ModuleList(_blocks(widths[k], blocks[k], around) for k in range(count))
        self.after = nn.ModuleList(_blocks(widths[k], blocks[k], around) for k in range(count - 1))
        self.project = nn.Parameter(0.1 * widths[0] ** -0.5 * torch.randn(len(HEADS), 2, widths[0]))
        self.register_buffer("seen", torch.tensor(SEEN, dtype=torch.float32), persistent=False)
        self.register_buffer("elements", torch.tensor(ELEMENTS, dtype=torch.float32), persistent=False)

    def forward(self, features: Tensor) -> Tensor:
        """Return (batch, heads, m, n), complex, for `features` (batch, m, n, FEATURES); zero on the rim.

        m is n, or around a body a multiple of 2 for each level but the coarsest.
        """
        x = features.movedim(-1, 1)  # channels last in memory, where convolutions are fastest
        lift = symmetry.lift(self.lift, self.seen)
        x = functional.conv2d(x, lift[:, :, None, None], self.lift_bias.repeat_interleave(ORDER))
        skipped = []
        for before, down in zip(self.before, self.down, strict=False):
            x = before(x)
            skipped.append(x)
            x = down(functional.silu(x))
        x = self.before[-1](x)
        for k in range(len(skipped) - 1, -1, -1):
            x = self.after[k](self._finer(self.up[k](x), skipped[k]) + skipped[k])
        project = symmetry.projection(self.project, self.elements, torch)
        answer = functional.conv2d(functional.silu(x), project[:, :, None, None]) * self._bubble(x)
        return torch.complex(answer[:, 0::2].contiguous(), answer[:, 1::2].contiguous())

    def _finer(self, x: Tensor, like: Tensor) -> Tensor:
        """Return `x` linear between its nodes, with as many as `like` has."""
        m, n = like.shape[-2:]
        if self.around:
            x, m = torch.cat([x, x[:, :, :1]], 2), m + 1
        fine = functional.interpolate(x, size=(m, n), mode="bilinear", align_corners=True)
        return fine[:, :, :-1] if self.around else fine

    def _bubble(self, like: Tensor) -> Tensor:
        """Return (m, n): 0 on the rim, rising to nearly 1 over a few nodes."""
        along, across = (_rise(n, like) for n in like.shape[-2:])
        return across if self.around else along[:, None] * across


def _blocks(width: int, count: int, around: bool) -> nn.Sequential:
    return nn.Sequential(*(ResidualBlock(width, around) for _ in range(count)))


def _rise(n: int, like: Tensor) -> Tensor:
    steps = torch.arange(n, dtype=like.dtype, device=like.device)
    away = torch.minimum(steps, n - 1 - steps)
    return away / (away + 2.0)
