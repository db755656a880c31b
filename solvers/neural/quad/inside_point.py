"""A point inside a body whose centroid lies outside: the minimum of a potential of the wall."""

from typing import Any

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats
from meshonet.geometry.elementary import angle

PIECES = 8  # segments of each edge of the wall, for the midpoint rule

EQUAL = 1e-9  # relative difference of two values of the potential that count as equal

WITHIN = 0.3  # largest step, as a fraction of the distance to the wall

STEPS, STILL = 50, 1e-14  # most Newton steps, and the step over the body's size at which they end


def inside(wall: Complexes) -> complex:
    """Return the point inside a closed curve `wall` (n,) where a repulsive potential is least.

    The potential is V(p) = ∮ |p - x|⁻⁴ ds over the curve. Of equal minima, the one nearest to the first node
    is taken. The first node is not repeated at the end.
    """
    size = float(np.abs(wall - wall[0]).max())
    curve = (wall - wall[0]) / size
    p = _first(curve)
    for _ in range(STEPS):
        g, m, c = slope(p, curve, np)
        convex = m > abs(c)
        step = (c * g.conjugate() - m * g) / (m * m - abs(c) ** 2) if convex else -g / (m + abs(c))
        step *= min(1.0, WITHIN * float(np.abs(curve - p).min()) / max(abs(step), 1e-300))
        p += step
        if abs(step) < STILL:
            break
    return complex(wall[0] + size * p)


def slope(p: Any, wall: Any, xp: Any) -> tuple[Any, Any, Any]:
    """Return the gradient g and second derivatives m and c of the wall's potential at the point `p`.

    The function `inside` defines the potential. Points and gradients are complex numbers x + iy. If p moves
    by v, g changes by ``m v + c v̄``, where m is real. `wall` (n,) is an array of `xp`, numpy or torch.
    """
    x, lengths = _pieces(wall, xp)
    o = p - x
    square = abs(o) ** 2
    weights = lengths / (square * square * square)
    return -4.0 * (weights * o).sum(), 8.0 * weights.sum(), 12.0 * (weights * (o / abs(o)) ** 2).sum()


def _pieces(wall: Any, xp: Any) -> tuple[Any, Any]:
    """Return the middles of pieces of the edges of a closed curve, (n, PIECES), and their lengths (n, 1)."""
    edges = xp.concatenate([wall[1:], wall[:1]]) - wall
    at = (xp.arange(PIECES, dtype=wall.real.dtype, device=wall.device) + 0.5) / PIECES
    return wall[:, None] + edges[:, None] * at, abs(edges)[:, None] / PIECES


def _first(wall: Complexes) -> complex:
    """Return the initial guess: of the centres of inscribed circles, that of least potential."""
    x, lengths = _pieces(wall, np)
    middles = _inscribed(wall, x)
    values = np.array([(lengths / (np.abs(p - x) ** 2) ** 2).sum() for p in middles])
    values[~_within(middles, wall)] = np.inf
    lowest = np.flatnonzero(values <= values.min() * (1.0 + EQUAL))
    return complex(middles[lowest[np.argmin(np.abs(middles[lowest] - wall[0]))]])


def _inscribed(wall: Complexes, x: Complexes) -> Complexes:
    """Return the centres of the largest circles that touch a closed curve at `x` and contain no other `x`."""
    edges = np.roll(wall, -1) - wall
    turn = 1j * np.sign((wall.conj() * edges).imag.sum())
    inwards = np.repeat(turn * edges / np.maximum(np.abs(edges), 1e-300), PIECES)
    points = x.ravel()
    off = points - points[:, None]
    away: Floats = (off * inwards.conj()[:, None]).real
    radii = np.full(off.shape, np.inf)
    np.divide(np.abs(off) ** 2, 2.0 * away, out=radii, where=away > 1e-9 * np.abs(off))
    return np.asarray(points + inwards * np.minimum(radii.min(axis=1), 1.0))


def _within(points: Complexes, wall: Complexes) -> Bools:
    """Return a mask of the points around which a closed curve winds once."""
    off = wall - points[:, None]
    turns = angle(np.roll(off, -1, axis=1) / off).sum(axis=1)
    return np.asarray(np.abs(np.abs(turns) - 2.0 * np.pi) < 1e-6)
