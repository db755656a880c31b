"""Winslow's equations in the strip by Fourier modes and Chebyshev points (Trefethen 2000, chapters 6, 7)."""

import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from meshonet.geometry import elementary
from meshonet.geometry.arrays import Complexes, Floats, array_like, read_only
from meshonet.geometry.elementary import functions_of
from meshonet.kernels._native import picard_step
from meshonet.solvers.conformal.chebyshev import barycentric, weights

MODES = 63  # as in kernels/conformal/picard.h, like the next two
COLUMNS = 128  # samples along theta
LEVELS = 40  # Chebyshev points across the strip, both walls included
CLUSTERING = 4.0  # eta(s) = (exp(c s) - 1)/(exp(c) - 1)

EIGENVECTORS = Path(__file__).with_name("eigenvectors.npy")
"""Rows of eigenvalues w of ``d2[1:-1, 1:-1]`` below, of eigenvectors v in columns, and of their inverse.

LAPACK would round them differently on different processors. If `LEVELS` or `CLUSTERING` change: ``w, v =
np.linalg.eig(d2[1:-1, 1:-1])``, ``np.save(EIGENVECTORS, np.vstack([w, v, np.linalg.inv(v)]))``.
"""


@dataclass(frozen=True)
class Across:
    """Chebyshev points across the strip, and the matrices of derivatives at these points."""

    s: Floats
    eta: Floats
    d1: Floats
    d2: Floats
    eigenvalues: Floats
    vectors: Floats
    inverse: Floats
    matrices: Floats
    """(4, LEVELS, LEVELS) tables of the compiled step: `d1`, `d2`, `inverse` and `vectors`, transposed."""
    stiffness: Floats  # eigenvalues with one more value at both ends, for the compiled step
    smooth: Floats  # factors by which changes of the modes are filtered: aliasing affects modes near `MODES`


@lru_cache(maxsize=1)
def across() -> Across:
    """Return Chebyshev points and derivative matrices across the strip (conformal image of the domain)."""
    n = LEVELS - 1
    x = elementary.cos(np.pi * np.arange(n + 1) / n)
    c = np.r_[2.0, np.ones(n - 1), 2.0] * (1.0 - 2.0 * (np.arange(n + 1) % 2))
    dx = x[:, None] - x[None, :] + np.eye(n + 1)
    d = np.outer(c, 1.0 / c) / dx
    d -= np.diag(d.sum(axis=1))
    s = 0.5 * (1.0 - x)  # rises from the wall to the far field
    eta = elementary.expm1(CLUSTERING * s) / math.expm1(CLUSTERING)
    rate = CLUSTERING * elementary.exp(CLUSTERING * s) / math.expm1(CLUSTERING)
    d1 = -2.0 * d / rate[:, None]
    d2 = elementary.product(d1, d1)
    kept = np.load(EIGENVECTORS)
    inner = np.zeros((2, LEVELS, LEVELS))
    inner[:, 1:-1, 1:-1] = kept[n:], kept[1:n]
    matrices = np.concatenate([[d1, d2], inner]).swapaxes(1, 2).copy()
    stiffness = np.pad(kept[0], 1, constant_values=-1.0)
    smooth = elementary.exp(-36.0 * elementary.power(np.abs(wavenumbers()) / (MODES + 1), 12.0))
    arrays = (s, eta, d1, d2, kept[0], kept[1:n], kept[n:], matrices, stiffness, smooth)
    return Across(*map(read_only, arrays))


@lru_cache(maxsize=8)
def interpolation(eta: bytes) -> Floats:
    """Return the matrix (LEVELS, n) of interpolation from the Chebyshev points to `eta`; it is read-only.

    `eta` are the bytes of an array (n,), so that the result can be cached.
    """
    s = elementary.log1p(np.frombuffer(eta) * math.expm1(CLUSTERING)) / CLUSTERING
    return read_only(barycentric(across().s, weights(LEVELS), s))


def modes(F: Any, xp: Any = np) -> Any:
    """Return the Fourier modes (..., 2 MODES + 1) of periodic samples F (..., n); `xp` is numpy or torch.

    They are in the order k = 0, 1 .. MODES, -MODES .. -1. Modes that n samples cannot resolve are zero.
    """
    n = F.shape[-1]
    c, kept = xp.fft.fft(F) / n, min(MODES, (n - 1) // 2)
    zeros = xp.zeros((*c.shape[:-1], 2 * (MODES - kept)), dtype=c.dtype, device=c.device)
    return xp.concatenate([c[..., : kept + 1], zeros, c[..., n - kept :]], -1)


def wavenumbers(like: Any = None, xp: Any = np) -> Any:
    """Return the wavenumbers 0, 1 .. MODES, -MODES .. -1 as an array of the same kind as `like`."""
    k = np.concatenate([np.arange(MODES + 1.0), np.arange(-MODES, 0.0)])
    return k if like is None else array_like(k, like, xp)


def decay(k: Any, T: Any, eta: Any, xp: Any = np) -> tuple[Any, Any]:
    """Return the factors by which Fourier modes k at the wall and at the far field have decayed at eta.

    They are sinh(kT(1-eta))/sinh(kT), 1 at the wall, and sinh(kT eta)/sinh(kT), 1 at the far field, each
    (..., len(k), len(eta)). T, a number or (..., 1, 1), is the height of the strip between both.
    """
    k, exp = abs(k)[:, None], functions_of(xp).exp
    flat = k == 0
    kT = xp.where(flat, 1.0, k * T)
    whole = 1.0 - exp(-2.0 * kT)
    wall = (exp(-kT * eta) - exp(-kT * (2.0 - eta))) / whole
    far = (exp(-kT * (1.0 - eta)) - exp(-kT * (1.0 + eta))) / whole
    return xp.where(flat, 1.0 - eta, wall), xp.where(flat, eta, far)


def harmonic(wall: Any, far: Any, eta: Floats, xp: Any = np) -> Any:
    """Return the Fourier modes (..., 2 MODES + 1, n) of a harmonic function across the strip, at `eta` (n,).

    `wall` and `far` are its modes on the two walls of the strip.
    """
    count, T = MODES + 1, (far - wall)[..., :1, None].real
    k = wavenumbers(wall, xp)[:count]  # k and -k decay alike
    near, away = decay(k, T, array_like(eta, wall, xp), xp)
    ahead = wall[..., :count, None] * near + far[..., :count, None] * away
    near, away = xp.flip(near[..., 1:, :], (-2,)), xp.flip(away[..., 1:, :], (-2,))
    return xp.concatenate([ahead, wall[..., count:, None] * near + far[..., count:, None] * away], -2)


def to_columns(c: Any, xp: Any = np) -> Any:
    """Return the sums (..., COLUMNS) of Fourier modes `c` (..., 2 MODES + 1) at equal steps of theta."""
    zeros = xp.zeros((*c.shape[:-1], COLUMNS - 2 * MODES - 1), dtype=c.dtype, device=c.device)
    return xp.fft.ifft(xp.concatenate([c[..., : MODES + 1], zeros, c[..., MODES + 1 :]], -1), norm="forward")


def from_columns(values: Any, xp: Any = np) -> Any:
    """Return Fourier modes (..., 2 MODES + 1) of functions with `values` (..., COLUMNS) at equal steps."""
    spectrum = xp.fft.fft(values) / COLUMNS
    return xp.concatenate([spectrum[..., : MODES + 1], spectrum[..., -MODES:]], -1)


def picard(
    c: Complexes, steps: int, settled: float = 0.0, diverged: float = np.inf
) -> tuple[Complexes, list[float]]:
    """Return Fourier modes of F after at most `steps` Picard steps, and the largest change of F in each step.

    The domain around a body is mapped to a strip along the imaginary axis. In it, the grid is a complex
    function w(theta, eta). theta goes around the body from 0 to 2 pi, eta from 0 at the wall to 1 at the far
    field. F = w - i theta is periodic. With derivatives by t = theta and e = eta, w solves::

        alpha w_tt - 2 beta w_te + gamma w_ee = 0
        alpha = |w_e|^2,  beta = Re(conj(w_t) w_e),  gamma = |w_t|^2

    A step solves T^2 d_tt + d_ee = -r for the change d of w. T is the mean width of the strip, r the left
    side above times 2 / (alpha / T^2 + gamma). The iteration ends after a step whose change is below
    `settled` or at least `diverged`; NaN counts as infinite. `c` (2 MODES + 1, LEVELS) are the initial modes
    at Chebyshev points of eta. The modes at wall and far field stay.
    """
    T = float((c[0, -1] - c[0, 0]).real)
    parts, grid = np.stack([c.real, c.imag]), across()
    changes: list[float] = []
    while len(changes) < steps and (not changes or settled <= changes[-1] < diverged):
        changes.append(picard_step(parts, T, grid.matrices, grid.stiffness, grid.smooth))
    return parts[0] + 1j * parts[1], changes
