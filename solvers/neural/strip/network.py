"""The strip network's forward pass in numpy, float64.

A one-dimensional Fourier neural operator along theta, so that it commutes with shifts of theta::

    h <- a * b + gelu(a)                                  lifting, [a, b] = W channels
    h <- h + E gelu(a + K h) + 0.3 b tanh(a)              three times, [a, b] = conv5(h), K spectral
    out = P h + K' h

Li et al., Fourier Neural Operator for Parametric Partial Differential Equations (2020). The same layers in
torch are `meshonet.solvers.neural.differentiable.strip_fno`.
"""

from collections.abc import Mapping

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import product, tanh

TAPS = 5  # columns that conv5 sees
GATE = 0.3  # factor of b tanh(a)


class StripNetwork:
    """The network of one set of weights, its arrays laid out once for the products below.

    `weights`: arrays by torch's names.
    """

    def __init__(self, weights: Mapping[str, Floats]) -> None:
        self._lift, self._project = (_Convolution(weights, name) for name in ("lift", "project"))
        self._layers = []
        for n in range(_depth(weights)):
            convolution, expand = (_Convolution(weights, f"{name}.{n}") for name in ("conv", "expand"))
            self._layers.append((convolution, _mixing(weights, f"spectral.{n}"), expand))
        self._spectral_out = _mixing(weights, "spectral_out")

    def __call__(self, channels: Floats, scalars: Floats) -> Floats:
        """Return (batch, outputs, columns) for `channels` (batch, inputs, columns), `scalars` (batch, k)."""
        constant = np.repeat(scalars[:, :, None], channels.shape[2], axis=2)
        h = self._lift(np.concatenate([channels, constant], axis=1).swapaxes(0, 1))
        width = len(h) // 2
        h = h[:width] * h[width:] + gelu(h[:width])
        for convolution, mixing, expand in self._layers:
            both = convolution(h)
            a, b = both[:width], both[width:]
            gate = tanh(a)
            gate *= b
            gate *= GATE
            gate += expand(gelu(a + spectral(mixing, h)))
            h = h + gate
        return np.asarray(self._project(h) + spectral(self._spectral_out, h)).swapaxes(0, 1)


def check_shapes(weights: Mapping[str, Floats]) -> None:
    """Raise ValueError or KeyError unless `weights` are those of a network, by names and shapes."""
    width, inputs = weights["lift.weight"].shape[0] // 2, weights["lift.weight"].shape[1]
    outputs = weights["project.weight"].shape[0]
    dense = {"lift": (2 * width, inputs, 1), "project": (outputs, width, 1)}
    mixing = {"spectral_out": (width, outputs, 2)}
    for n in range(_depth(weights)):
        dense |= {f"conv.{n}": (2 * width, width, TAPS), f"expand.{n}": (width, width, 1)}
        mixing[f"spectral.{n}"] = (width, width, 2)
    wanted: dict[str, tuple[int, ...]] = {f"{name}.weight": shape for name, shape in dense.items()}
    wanted |= {f"{name}.bias": shape[:1] for name, shape in dense.items()}
    for name, shape in mixing.items():
        wanted[f"{name}.weight"] = (weights[f"{name}.weight"].shape[0], *shape)
    for name in [*wanted, *weights]:
        had = weights[name].shape if name in weights else None
        if had != wanted.get(name) or not width:
            raise ValueError(f"array {name!r:.60} has shape {had} in place of {wanted.get(name)}")


def _depth(weights: Mapping[str, Floats]) -> int:
    return sum(name.startswith("conv.") for name in weights) // 2


def gelu(x: Floats) -> Floats:
    """Return the Gaussian error linear unit in its tanh form. Hendrycks & Gimpel, arXiv 1606.08415."""
    y = x * x
    y *= 0.044715 * 0.7978845608028654
    y += 0.7978845608028654
    y *= x
    y = tanh(y)
    y += 1.0
    y *= 0.5 * x
    return y


def spectral(mixing: Floats, h: Floats) -> Floats:
    """Return (d, batch, n): the first modes of h (c, batch, n), mixed by a matrix of `_mixing` each."""
    count, n = len(mixing), h.shape[2]
    spectrum = np.ascontiguousarray(np.fft.rfft(h)[..., :count].T).view(np.float64)
    mixed = np.stack([product(mode, matrix) for mode, matrix in zip(spectrum, mixing, strict=True)])
    out = np.zeros((mixing.shape[2] // 2, h.shape[1], n // 2 + 1), complex)
    out[..., :count] = mixed.view(np.complex128).T
    return np.fft.irfft(out, n)


class _Convolution:
    """A circular convolution over one column or over `TAPS` of them, of h (c, batch, n), as one product."""

    def __init__(self, weights: Mapping[str, Floats], name: str) -> None:
        weight = weights[f"{name}.weight"]
        self._taps = weight.shape[2]
        self._matrix = np.concatenate([weight[:, :, t] for t in range(self._taps)], axis=1)
        self._bias = weights[f"{name}.bias"][:, None]

    def __call__(self, h: Floats) -> Floats:
        width, batch, n = h.shape
        if half := self._taps // 2:
            around = np.concatenate([h[..., -half:], h, h[..., :half]], axis=2)
            h = np.empty((self._taps, width, batch, n))
            for t in range(self._taps):
                h[t] = around[..., t : t + n]
        out = product(self._matrix, h.reshape(self._taps * width, -1))
        out += self._bias
        return out.reshape(-1, batch, n)


def _mixing(weights: Mapping[str, Floats], name: str) -> Floats:
    """Return complex matrices (modes, c, d) as real ones (modes, 2 c, 2 d), parts of numbers in turn."""
    weight = weights[f"{name}.weight"]
    turned = np.stack([-weight[..., 1], weight[..., 0]], axis=-1)  # i times it
    modes, c, d, _ = weight.shape
    return np.stack([weight, turned], axis=2).reshape(modes, 2 * c, 2 * d)
