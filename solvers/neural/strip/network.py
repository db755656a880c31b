"""The strip network's forward pass in NumPy, float64, and in torch, which trains it."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import functions_of, product, tanh

TAPS = 5  # width of conv5's kernel, in columns
GATE = 0.3  # factor of b tanh(a)


class StripNetwork:
    """A Fourier neural operator on functions of theta, the periodic coordinate around a body.

    W, E and P are linear maps at each point along theta. conv5 is a convolution over 5 points. K and K'
    multiply each low Fourier mode by a matrix. a and b are halves of the channels::

        h <- a * b + gelu(a)                                  [a, b] = W (input)
        h <- h + E gelu(a + K h) + 0.3 b tanh(a)              three times, [a, b] = conv5(h)
        out = P h + K' h

    `weights` has arrays of `xp`, numpy or torch, by name (see `shapes`). Li et al., arXiv 2010.08895.
    """

    def __init__(self, weights: Mapping[str, Any], xp: Any = np) -> None:
        self._xp = xp
        self._lift, self._project = (_Convolution(weights, name, xp) for name in ("lift", "project"))
        self._layers = []
        for n in range(_depth(weights)):
            convolution, expand = (_Convolution(weights, f"{name}.{n}", xp) for name in ("conv", "expand"))
            self._layers.append((convolution, _mixing(weights, f"spectral.{n}", xp), expand))
        self._spectral_out = _mixing(weights, "spectral_out", xp)

    def __call__(self, channels: Any, scalars: Any) -> Any:
        """Return (batch, outputs, columns) for `channels` (batch, inputs, columns), `scalars` (batch, k)."""
        xp = self._xp
        constant = scalars[:, :, None] + xp.zeros_like(channels[:, :1])
        h = self._lift(xp.concatenate([channels, constant], 1).swapaxes(0, 1))
        width = len(h) // 2
        h = h[:width] * h[width:] + gelu(h[:width], xp)
        for convolution, mixing, expand in self._layers:
            both = convolution(h)
            a, b = both[:width], both[width:]
            gate = functions_of(xp).tanh(a) * b * GATE
            h = h + (gate + expand(gelu(a + spectral(mixing, h, xp), xp)))
        return (self._project(h) + spectral(self._spectral_out, h, xp)).swapaxes(0, 1)


def shapes(inputs: int, outputs: int, width: int, modes: Sequence[int]) -> dict[str, tuple[int, ...]]:
    """Return the shapes of a network's weights by name.

    `modes` has the numbers of Fourier modes of the hidden layers, then of the output layer.
    """
    dense = {"lift": (2 * width, inputs, 1), "project": (outputs, width, 1)}
    mixing = {"spectral_out": (modes[-1], width, outputs, 2)}
    for n, count in enumerate(modes[:-1]):
        dense |= {f"conv.{n}": (2 * width, width, TAPS), f"expand.{n}": (width, width, 1)}
        mixing[f"spectral.{n}"] = (count, width, width, 2)
    arrays: dict[str, tuple[int, ...]] = {f"{name}.weight": shape for name, shape in (dense | mixing).items()}
    return arrays | {f"{name}.bias": shape[:1] for name, shape in dense.items()}


def check_shapes(weights: Mapping[str, Floats]) -> None:
    """Raise ValueError or KeyError unless `weights` have the names and shapes of a network's weights."""
    width, inputs = weights["lift.weight"].shape[0] // 2, weights["lift.weight"].shape[1]
    spectral = [*(f"spectral.{n}.weight" for n in range(_depth(weights))), "spectral_out.weight"]
    modes = [weights[name].shape[0] for name in spectral]
    wanted = shapes(inputs, weights["project.weight"].shape[0], width, modes)
    for name in [*wanted, *weights]:
        had = weights[name].shape if name in weights else None
        if had != wanted.get(name) or not width:
            raise ValueError(f"array {name!r:.60} has shape {had} in place of {wanted.get(name)}")


def _depth(weights: Mapping[str, Any]) -> int:
    return sum(name.startswith("conv.") for name in weights) // 2


def gelu(x: Any, xp: Any) -> Any:
    """Return the Gaussian error linear unit in its tanh form. Hendrycks & Gimpel, arXiv 1606.08415."""
    if xp is not np:
        return xp.nn.functional.gelu(x, approximate="tanh")
    y = x * x
    y *= 0.044715 * 0.7978845608028654
    y += 0.7978845608028654
    y *= x
    y = tanh(y)
    y += 1.0
    y *= 0.5 * x
    return y


def spectral(mixing: Any, h: Any, xp: Any) -> Any:
    """Multiply the channels of each Fourier mode of `h` (c, batch, n) by a matrix; return (d, batch, n).

    `mixing` (modes, 2 c, 2 d) has a complex matrix (c, d) for each of the lowest modes, written with real
    numbers: each entry p + i q is the block [[p, q], [-q, p]]. Higher modes become 0.
    """
    spectrum = xp.fft.rfft(h)[..., : len(mixing)].swapaxes(0, 2)
    parts = xp.stack([spectrum.real, spectrum.imag], -1).reshape(len(mixing), h.shape[1], -1)
    if xp is np:
        mixed = np.stack([product(mode, matrix) for mode, matrix in zip(parts, mixing, strict=True)])
    else:
        mixed = xp.bmm(parts, mixing)
    return xp.fft.irfft((mixed[..., ::2] + 1j * mixed[..., 1::2]).swapaxes(0, 2), h.shape[2])


class _Convolution:
    """A circular convolution over one column or over `TAPS` of them, of h (c, batch, n), as one product."""

    def __init__(self, weights: Mapping[str, Any], name: str, xp: Any) -> None:
        weight, self._xp = weights[f"{name}.weight"], xp
        self._taps = weight.shape[2]
        self._matrix = xp.concatenate([weight[:, :, t] for t in range(self._taps)], 1)
        self._bias = weights[f"{name}.bias"][:, None]

    def __call__(self, h: Any) -> Any:
        width, batch, n = h.shape
        if half := self._taps // 2:
            around = self._xp.concatenate([h[..., -half:], h, h[..., :half]], 2)
            h = self._xp.stack([around[..., t : t + n] for t in range(self._taps)])
        out = functions_of(self._xp).matmul(self._matrix, h.reshape(self._taps * width, -1)) + self._bias
        return out.reshape(-1, batch, n)


def _mixing(weights: Mapping[str, Any], name: str, xp: Any) -> Any:
    """Return complex matrices (modes, c, d) as real (modes, 2 c, 2 d), with alternating parts."""
    weight = weights[f"{name}.weight"]
    turned = xp.stack([-weight[..., 1], weight[..., 0]], -1)  # i times it
    modes, c, d, _ = weight.shape
    return xp.stack([weight, turned], 2).reshape(modes, 2 * c, 2 * d)
