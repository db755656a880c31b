"""Winslow's equations in the periodic strip, by Fourier modes along phi and Chebyshev points across.

A grid in the strip is w(theta, eta) = psi + i phi with phi = theta + ..., so that F = w - i theta is
periodic in theta (2 pi). With W = w::

    alpha W_tt - 2 beta W_te + gamma W_ee = 0
    alpha = |W_e|^2,  beta = Re(conj(W_t) W_e),  gamma = |W_t|^2

The uniform strip W = T eta + i theta has alpha = T^2, beta = 0, gamma = 1: the harmonic extension of the two
walls solves the equations with these coefficients, and Picard's iteration with that constant operator as
preconditioner does the rest. Points cluster at the wall, where high modes live.

Trefethen, Spectral Methods in MATLAB (2000), chapters 6 and 7.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.kernels._native import picard_step

MODES = 63  # as in kernels/conformal/picard.h, like the next two
COLUMNS = 128  # samples along theta
LEVELS = 40  # Chebyshev points across the strip, both walls included
CLUSTERING = 4.0  # eta(s) = (exp(c s) - 1)/(exp(c) - 1)


@dataclass(frozen=True)
class Across:
    """The Chebyshev points across the strip and their derivative matrices."""

    s: Floats
    eta: Floats
    d1: Floats
    d2: Floats
    eigenvalues: Floats
    vectors: Floats
    inverse: Floats


@lru_cache(maxsize=1)
def across() -> Across:
    """Return the discretisation across the strip (built once, about a millisecond)."""
    n = LEVELS - 1
    x = np.cos(np.pi * np.arange(n + 1) / n)
    c = np.r_[2.0, np.ones(n - 1), 2.0] * (-1.0) ** np.arange(n + 1)
    dx = x[:, None] - x[None, :] + np.eye(n + 1)
    d = np.outer(c, 1.0 / c) / dx
    d -= np.diag(d.sum(axis=1))
    s = 0.5 * (1.0 - x)  # rises from the wall to the far field
    eta = np.expm1(CLUSTERING * s) / np.expm1(CLUSTERING)
    rate = CLUSTERING * np.exp(CLUSTERING * s) / np.expm1(CLUSTERING)
    d1 = -2.0 * d / rate[:, None]
    d2 = d1 @ d1
    values, vectors = np.linalg.eig(d2[1:-1, 1:-1])
    return Across(s, eta, d1, d2, values.real, vectors.real, np.linalg.inv(vectors.real))


def interpolation(eta: Floats) -> Floats:
    """Return the (LEVELS, len(eta)) matrix that takes values at the Chebyshev points to values at `eta`.

    Barycentric formula; exact at the points themselves. Berrut & Trefethen, SIAM Review 46 (2004) 501.
    """
    points = across().s
    s = np.log1p(eta * np.expm1(CLUSTERING)) / CLUSTERING
    weights = (-1.0) ** np.arange(LEVELS)
    weights[[0, -1]] *= 0.5
    gap = s[None, :] - points[:, None]
    hit = gap == 0.0
    gap[hit] = 1.0
    matrix = weights[:, None] / gap
    matrix[:, hit.any(axis=0)] = 0.0
    matrix[hit] = 1.0
    matrix /= matrix.sum(axis=0)
    return matrix


def modes(F: Complexes, count: int = MODES) -> Complexes:
    """Return Fourier coefficients (2 count + 1, ...) of F (n, ...) for k = 0, 1 .. count, -count .. -1.

    Modes that n samples cannot tell are zero.
    """
    n = len(F)
    c = np.fft.fft(F, axis=0) / n
    keep = min(count, (n - 1) // 2)
    out = np.zeros((2 * count + 1, *F.shape[1:]), complex)
    out[: keep + 1] = c[: keep + 1]
    if keep:
        out[-keep:] = c[-keep:]
    return out


def wavenumbers(count: int = MODES) -> Floats:
    """Return k in the order of `modes`."""
    return np.concatenate([np.arange(count + 1.0), np.arange(-count, 0.0)])


def decay(k: Floats, T: float, eta: Floats) -> tuple[Floats, Floats]:
    """Return how mode k of the wall and of the far field reach eta: two (len(k), len(eta)) arrays.

    sinh(kT(1-eta))/sinh(kT) and sinh(kT eta)/sinh(kT), written without overflow.
    """
    kT = np.where(k == 0, 1.0, np.abs(k) * T)[:, None]
    e = eta[None, :]
    whole = 1.0 - np.exp(-2.0 * kT)
    wall = (np.exp(-kT * e) - np.exp(-kT * (2.0 - e))) / whole
    far = (np.exp(-kT * (1.0 - e)) - np.exp(-kT * (1.0 + e))) / whole
    flat = k == 0
    wall[flat], far[flat] = 1.0 - e, e
    return wall, far


def smoothing() -> Floats:
    """Return what is taken of a change of each mode: those near `MODES` are aliases of others."""
    return np.asarray(np.exp(-36.0 * (np.abs(wavenumbers()) / (MODES + 1)) ** 12))


def harmonic(wall: Complexes, far: Complexes, eta: Floats) -> Complexes:
    """Return modes (2 MODES + 1, len(eta)) of the harmonic function with these modes on the two walls."""
    T = float((far[0] - wall[0]).real)
    count = (len(wall) - 1) // 2
    near, away = decay(np.arange(count + 1.0), T, eta)
    found = np.empty((len(wall), len(eta)), complex)  # k = 0, 1 .. count and -count .. -1 decay alike
    found[: count + 1] = wall[: count + 1, None] * near + far[: count + 1, None] * away
    found[count + 1 :] = wall[count + 1 :, None] * near[:0:-1] + far[count + 1 :, None] * away[:0:-1]
    return found


def to_columns(c: Complexes, axis: int = 0) -> Complexes:
    """Return samples at `COLUMNS` equal steps of theta of the functions whose modes lie along `axis` of c."""
    c = np.moveaxis(c, axis, -1)
    full = np.zeros((*c.shape[:-1], COLUMNS), complex)
    full[..., : MODES + 1], full[..., -MODES:] = c[..., : MODES + 1], c[..., -MODES:]
    return np.moveaxis(np.fft.ifft(full, norm="forward"), -1, axis)


def picard(c: Complexes, steps: int) -> tuple[Complexes, list[float]]:
    """Return the modes after `steps` Picard steps, and the largest change of F in each.

    A step that is not finite counts as an infinite change, and is the last.

    Parameters
    ----------
    c : (2 MODES + 1, LEVELS) modes at the Chebyshev points; the two walls stay as they are.
    """
    T = float((c[0, -1] - c[0, 0]).real)
    parts = np.stack([c.real, c.imag])
    matrices, eigenvalues, smooth = _kernels()
    changes: list[float] = []
    while len(changes) < steps and (not changes or np.isfinite(changes[-1])):
        changes.append(picard_step(parts, T, matrices, eigenvalues, smooth))
    return parts[0] + 1j * parts[1], changes


@lru_cache(maxsize=1)
def _kernels() -> tuple[Floats, Floats, Floats]:
    """Return what `step` takes: matrices, eigenvalues, and a filter against aliasing."""
    grid = across()
    inner = np.zeros((2, LEVELS, LEVELS))
    inner[:, 1:-1, 1:-1] = grid.inverse, grid.vectors
    matrices = np.concatenate([[grid.d1, grid.d2], inner]).swapaxes(1, 2).copy()
    return matrices, np.pad(grid.eigenvalues, 1, constant_values=-1.0), smoothing()
