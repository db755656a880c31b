"""What the strip network sees and what its answer means: the one copy that training and inference share.

The answer is R = Winslow - harmonic, zero on both walls by construction. To leading order R is quadratic in
how far the walls are from straight, so the network sees walls of unit size and its answer is scaled by
size^2.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.solvers.conformal.strip import MODES, decay, to_columns, wavenumbers

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
    near, away = np.array([decay(k, float(T), DEPTHS) for T in height]).swapaxes(0, 1).swapaxes(2, 3)
    h = (a[:, None] * near + b[:, None] * away) / size[:, None, None]
    value, slope = to_columns(h, -1), SLOPE * to_columns(1j * k * h, -1)
    channels = np.stack([value.real, value.imag, slope.real, slope.imag], axis=2)
    scalars = np.stack([np.log(size) + 2.5, height - 4.0, shear], axis=1)
    return channels.reshape(len(wall), CHANNELS, -1), scalars, size


def decode(coefficients: Floats, basis: Floats, scale: float, size: Floats) -> Complexes:
    """Return the modes (batch, 2 MODES + 1, LEVELS) of R from the network's answers.

    Parameters
    ----------
    coefficients : (batch, 2 Q, COLUMNS) real parts, then imaginary parts.
    basis : (Q, LEVELS - 2) functions of the inner Chebyshev points.
    scale : of the training targets.
    size : (batch,) from `encode`.
    """
    q = len(basis)
    spectrum = np.fft.fft(coefficients[:, :q] + 1j * coefficients[:, q:]) / coefficients.shape[2]
    kept = np.concatenate([spectrum[..., : MODES + 1], spectrum[..., -MODES:]], axis=2)
    inner = (kept.swapaxes(1, 2) @ basis) * (scale * size**2)[:, None, None]
    return np.pad(inner, ((0, 0), (0, 0), (1, 1)))
