"""The strip network's forward pass in numpy.

A one-dimensional Fourier neural operator along theta, so that it commutes with shifts of theta::

    h <- a * b + gelu(a)                                  lifting, [a, b] = W channels
    h <- h + E gelu(a + K h) + 0.3 b tanh(a)              three times, [a, b] = conv5(h), K spectral
    out = P h + K' h

Li et al., Fourier Neural Operator for Parametric Partial Differential Equations (2020). The same layers in
torch are `meshonet.solvers.neural.differentiable.strip_fno`; a test holds the two together.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Reals: TypeAlias = NDArray[np.floating[Any]]
"""float32 or float64: the arithmetic is that of the weights."""

TAPS = 5
GATE = 0.3


class StripNetwork:
    """The network of one set of weights, its arrays laid out once for the products below.

    Parameters
    ----------
    weights : arrays by torch's names; float32 or float64 decides the arithmetic.
    """

    def __init__(self, weights: Mapping[str, Reals]) -> None:
        self.dtype = weights["lift.weight"].dtype
        self._lift = _Pointwise(weights, "lift")
        self._layers = [
            (
                _taps(weights, f"conv.{n}"),
                _mixing(weights, f"spectral.{n}"),
                _Pointwise(weights, f"expand.{n}"),
            )
            for n in range(sum(name.startswith("conv.") for name in weights) // 2)
        ]
        self._project = _Pointwise(weights, "project")
        self._spectral_out = _mixing(weights, "spectral_out")

    def __call__(self, channels: Reals, scalars: Reals) -> Reals:
        """Return answers (batch, outputs, columns).

        `channels` are (batch, inputs, columns), `scalars` (batch, count).
        """
        columns = channels.shape[2]
        constant = np.repeat(scalars[:, :, None], columns, axis=2)
        h = self._lift(np.concatenate([channels, constant], axis=1).swapaxes(0, 1).astype(self.dtype))
        width = len(h) // 2
        h = h[:width] * h[width:] + gelu(h[:width])
        for (taps, bias), mixing, expand in self._layers:
            both = _convolve(taps, bias, h)
            a, b = both[:width], both[width:]
            gate = np.tanh(a)
            gate *= b
            gate *= self.dtype.type(GATE)
            gate += expand(gelu(a + spectral(mixing, h)))
            h = h + gate
        return np.asarray(self._project(h) + spectral(self._spectral_out, h)).swapaxes(0, 1)


def check_shapes(weights: Mapping[str, Reals]) -> None:
    """Raise ValueError or KeyError unless `weights` are those of a network, by names and shapes."""
    width, inputs = weights["lift.weight"].shape[0] // 2, weights["lift.weight"].shape[1]
    outputs = weights["project.weight"].shape[0]
    wanted: dict[str, tuple[int, ...]] = {
        "lift.weight": (2 * width, inputs, 1), "lift.bias": (2 * width,),
        "project.weight": (outputs, width, 1), "project.bias": (outputs,),
        "spectral_out.weight": (weights["spectral_out.weight"].shape[0], width, outputs, 2),
    }  # fmt: skip
    for n in range(sum(name.startswith("conv.") for name in weights) // 2):
        modes = weights[f"spectral.{n}.weight"].shape[0]
        wanted |= {
            f"conv.{n}.weight": (2 * width, width, TAPS), f"conv.{n}.bias": (2 * width,),
            f"expand.{n}.weight": (width, width, 1), f"expand.{n}.bias": (width,),
            f"spectral.{n}.weight": (modes, width, width, 2),
        }  # fmt: skip
    for name in [*wanted, *weights]:
        shape = weights[name].shape if name in weights else None
        if shape != wanted.get(name) or not width:
            raise ValueError(f"array {name!r:.60} has shape {shape} in place of {wanted.get(name)}")


def gelu(x: Reals) -> Reals:
    """Return the Gaussian error linear unit in its tanh form. Hendrycks & Gimpel, arXiv 1606.08415."""
    y = x * x
    y *= x.dtype.type(0.044715 * 0.7978845608028654)
    y += x.dtype.type(0.7978845608028654)
    y *= x
    np.tanh(y, out=y)
    y += x.dtype.type(1.0)
    y *= x.dtype.type(0.5) * x
    return np.asarray(y)


def spectral(mixing: Reals, h: Reals) -> Reals:
    """Return h (c, batch, n) with its first modes mixed by a complex matrix each: `mixing` (modes, c, d)."""
    count, n = len(mixing), h.shape[2]
    spectrum = np.ascontiguousarray(np.fft.rfft(h)[..., :count].T)
    out = np.zeros((mixing.shape[2], h.shape[1], n // 2 + 1), mixing.dtype)
    out[..., :count] = (spectrum @ mixing).T
    return np.fft.irfft(out, n).astype(h.dtype, copy=False)


class _Pointwise:
    """A linear map of the channels (c, batch, n), the same in every column."""

    def __init__(self, weights: Mapping[str, Reals], name: str) -> None:
        self._matrix = np.ascontiguousarray(weights[f"{name}.weight"][:, :, 0])
        self._bias = weights[f"{name}.bias"][:, None]

    def __call__(self, h: Reals) -> Reals:
        out = self._matrix @ h.reshape(len(h), -1)
        out += self._bias
        return out.reshape(-1, *h.shape[1:])


def _taps(weights: Mapping[str, Reals], name: str) -> tuple[Reals, Reals]:
    """Return a convolution's weights side by side, (outputs, TAPS inputs), and its bias."""
    weight = weights[f"{name}.weight"]
    return np.concatenate([weight[:, :, t] for t in range(TAPS)], axis=1), weights[f"{name}.bias"][:, None]


def _mixing(weights: Mapping[str, Reals], name: str) -> Reals:
    weight = weights[f"{name}.weight"]
    return np.asarray(weight[..., 0] + weight.dtype.type(1) * 1j * weight[..., 1]).astype(
        np.result_type(weight.dtype, np.complex64)
    )


def _convolve(taps: Reals, bias: Reals, h: Reals) -> Reals:
    """Return the circular convolution over `TAPS` columns as one matrix product."""
    width, batch, n = h.shape
    half = TAPS // 2
    around = np.concatenate([h[..., -half:], h, h[..., :half]], axis=2)
    shifted = np.empty((TAPS, width, batch, n), h.dtype)
    for t in range(TAPS):
        shifted[t] = around[..., t : t + n]
    out = taps @ shifted.reshape(TAPS * width, -1)
    out += bias
    return out.reshape(-1, batch, n)
