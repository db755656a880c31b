"""The strip network in torch: the layers of `meshonet.solvers.neural.strip.network`, differentiable."""

from __future__ import annotations

import torch
from torch import Tensor, nn

from meshonet.solvers.neural.strip.network import GATE, TAPS


class Spectral(nn.Module):
    """Mix the channels of the first `modes` Fourier modes, a complex matrix each."""

    def __init__(self, inputs: int, outputs: int, modes: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.randn(modes, inputs, outputs, 2) / inputs)

    def forward(self, h: Tensor) -> Tensor:
        """(batch, inputs, columns) to (batch, outputs, columns)."""
        spectrum = torch.fft.rfft(h)[..., : len(self.weight)]
        mixed = torch.einsum("bcm,mcd->bdm", spectrum, torch.view_as_complex(self.weight))
        out: Tensor = torch.fft.irfft(mixed, h.shape[-1])
        return out


class StripFNO(nn.Module):
    """Channels and scalars of `meshonet.solvers.neural.strip.encoding` to `outputs` channels.

    `inputs`, `scalars`, `outputs`: channel counts; `width`, `modes`, `layers`: of the hidden state.
    """

    def __init__(
        self, inputs: int, scalars: int, outputs: int, width: int = 32, modes: int = 32, layers: int = 3
    ) -> None:
        super().__init__()
        self.lift = nn.Conv1d(inputs + scalars, 2 * width, 1)
        self.conv = nn.ModuleList(
            nn.Conv1d(width, 2 * width, TAPS, padding=TAPS // 2, padding_mode="circular")
            for _ in range(layers)
        )
        self.spectral = nn.ModuleList(Spectral(width, width, modes) for _ in range(layers))
        self.expand = nn.ModuleList(nn.Conv1d(width, width, 1) for _ in range(layers))
        self.project = nn.Conv1d(width, outputs, 1)
        self.spectral_out = Spectral(width, outputs, modes)

    def forward(self, channels: Tensor, scalars: Tensor) -> Tensor:
        """(batch, inputs, columns), (batch, scalars) to (batch, outputs, columns)."""
        gelu = nn.functional.gelu
        constant = scalars[:, :, None].expand(-1, -1, channels.shape[-1])
        a, b = self.lift(torch.cat([channels, constant], 1)).chunk(2, 1)
        h = a * b + gelu(a, approximate="tanh")
        for conv, spectral, expand in zip(self.conv, self.spectral, self.expand, strict=True):
            a, b = conv(h).chunk(2, 1)
            h = h + expand(gelu(a + spectral(h), approximate="tanh")) + GATE * b * torch.tanh(a)
        out: Tensor = self.project(h) + self.spectral_out(h)
        return out
