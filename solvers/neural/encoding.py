"""What the strip network sees and what its answer means: the one copy that training and inference share.

The answer is R = Winslow - harmonic, zero on both walls by construction. To leading order R is quadratic in
how far the walls are from straight, so the network sees walls of unit size and its answer is scaled by
size^2.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Complexes, Floats
from solvers.neural.strip import MODES, decay, to_columns, wavenumbers

VERSION = 1
DEPTHS = np.array([0.0, 0.03, 0.08, 0.16, 0.32, 0.6, 1.0])  # eta at which the network sees the harmonic base
CHANNELS = 4 * len(DEPTHS)
SCALARS = 3
SLOPE = 0.3  # slopes are larger than values by about their wavenumber


def encode(wall: Complexes, far: Complexes) -> tuple[Floats, Floats, Floats]:
    """Return the network's input for a batch of strips.

    Parameters
    ----------
    wall, far : (batch, 2 MODES + 1) modes of F on the two walls.

    Returns
    -------
    channels : (batch, CHANNELS, COLUMNS) the harmonic base and its slope along theta at `DEPTHS`, unit size.
    scalars : (batch, SCALARS) log size, strip height, shear, each shifted and scaled to about one.
    size : (batch,) root mean square of the walls' deviation from straight.
    """
    k = wavenumbers()
    height = (far[:, 0] - wall[:, 0]).real
    shear = (far[:, 0] - wall[:, 0]).imag
    a, b = wall.copy(), far.copy()
    a[:, 0] = b[:, 0] = 0.0
    size = np.maximum(np.sqrt((np.abs(a) ** 2 + np.abs(b) ** 2).sum(axis=1)), 1e-12)
    channels = np.empty((len(wall), CHANNELS, to_columns(a.T).shape[0]))
    for m in range(len(wall)):
        near, away = decay(k, float(height[m]), DEPTHS)
        h = (a[m][:, None] * near + b[m][:, None] * away) / size[m]
        value, slope = to_columns(h).T, SLOPE * to_columns(1j * k[:, None] * h).T
        channels[m] = np.stack([value.real, value.imag, slope.real, slope.imag], axis=1).reshape(CHANNELS, -1)
    scalars = np.stack([np.log(size) + 2.5, height - 4.0, shear], axis=1)
    return channels, scalars, size


def decode(coefficients: Floats, basis: Floats, scale: float, size: float) -> Complexes:
    """Return the modes (2 MODES + 1, LEVELS) of R from the network's answer for one strip.

    Parameters
    ----------
    coefficients : (2 Q, COLUMNS) real parts, then imaginary parts.
    basis : (Q, LEVELS - 2) functions of the inner Chebyshev points.
    scale : of the training targets.
    size : from `encode`.
    """
    q = len(basis)
    spectrum = np.fft.fft(coefficients[:q] + 1j * coefficients[q:], axis=1) / coefficients.shape[1]
    kept = np.concatenate([spectrum[:, : MODES + 1], spectrum[:, -MODES:]], axis=1)
    inner = (kept.T @ basis) * (scale * size**2)
    return np.pad(inner, ((0, 0), (1, 1)))
