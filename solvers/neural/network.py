"""The strip network's forward pass in numpy.

A one-dimensional Fourier neural operator along theta, so that it commutes with shifts of theta::

    h <- a * b + gelu(a)                                  lifting, [a, b] = W channels
    h <- h + E gelu(a + K h) + 0.3 b tanh(a)              three times, [a, b] = conv5(h), K spectral
    out = P h + K' h

Li et al., Fourier Neural Operator for Parametric Partial Differential Equations (2020). The same layers in
torch are `solvers.neural.models.strip_fno`; a test holds the two together.
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


def forward(weights: Mapping[str, Reals], channels: Reals, scalars: Reals) -> Reals:
    """Return the answer (outputs, columns) for one strip.

    Parameters
    ----------
    weights : arrays by torch's names; float32 or float64 decides the arithmetic.
    channels : (inputs, columns).
    scalars : (count,).
    """
    dtype = weights["lift.weight"].dtype
    constant = np.repeat(scalars[:, None], channels.shape[1], axis=1)
    h = _pointwise(weights, "lift", np.concatenate([channels, constant]).astype(dtype))
    a, b = np.split(h, 2)
    h = a * b + gelu(a)
    layer = 0
    while f"conv.{layer}.weight" in weights:
        a, b = np.split(_convolve(weights, f"conv.{layer}", h), 2)
        mixed = gelu(a + spectral(weights[f"spectral.{layer}.weight"], h))
        h = h + _pointwise(weights, f"expand.{layer}", mixed) + dtype.type(GATE) * b * np.tanh(a)
        layer += 1
    return np.asarray(_pointwise(weights, "project", h) + spectral(weights["spectral_out.weight"], h))


def gelu(x: Reals) -> Reals:
    """Return the Gaussian error linear unit in its tanh form. Hendrycks & Gimpel, arXiv 1606.08415."""
    c = x.dtype.type(0.7978845608028654)
    return np.asarray(0.5 * x * (1.0 + np.tanh(c * (x + x.dtype.type(0.044715) * x * x * x))))


def spectral(weight: Reals, h: Reals) -> Reals:
    """Return h (c, n) with its first modes mixed, a complex (c, d) matrix each: weight (modes, c, d, 2)."""
    mixing = weight[..., 0] + 1j * weight[..., 1]
    count, n = len(weight), h.shape[1]
    spectrum = np.fft.rfft(h)[:, :count].astype(mixing.dtype)
    out = np.zeros((mixing.shape[2], n // 2 + 1), mixing.dtype)
    out[:, :count] = (spectrum.T[:, None, :] @ mixing)[:, 0].T
    return np.fft.irfft(out, n).astype(h.dtype)


def _pointwise(weights: Mapping[str, Reals], name: str, h: Reals) -> Reals:
    return np.asarray(weights[f"{name}.weight"][:, :, 0] @ h + weights[f"{name}.bias"][:, None])


def _convolve(weights: Mapping[str, Reals], name: str, h: Reals) -> Reals:
    """Return the circular convolution over `TAPS` columns as one matrix product."""
    weight = weights[f"{name}.weight"]
    shifted = np.concatenate([np.roll(h, TAPS // 2 - t, axis=1) for t in range(TAPS)])
    flat = np.concatenate([weight[:, :, t] for t in range(TAPS)], axis=1)
    return np.asarray(flat @ shifted + weights[f"{name}.bias"][:, None])
