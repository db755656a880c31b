"""O grids around bodies by the quad network, applied to the unrolled, periodic strip.

::

    walls -> 65 nodes of them -> strip -> even steps from wall to wall -> size out -> towards Winslow's grid
          -> features -> network -> 65 x 33 grid, its walls those nodes
          -> splines -> grid at the walls' own counts

Rotation, translation and scaling of the body only shift the strip, so that the network's output does not
change, up to rounding. The output is equivariant under reflection, and if the numbering of nodes starts one
eighth of the circumference further on.
"""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.elementary import angle
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.resample.spline import between
from meshonet.solvers.neural.quad.coarse_grids import Moves, answered, nearer
from meshonet.solvers.neural.quad.encoding import LATENT, WINSLOW, planes_of
from meshonet.solvers.neural.quad.network import CHUNK, Network
from meshonet.solvers.neural.quad.unrolled import AROUND, around_middles, even, factors, rolled

# problem and remedy of the error, for NumPy and torch
NOT_ROUND = "its walls do not go once round a middle of the body", "use meshonet solve-pde for this shape"

COMPACT = 0.15  # least over largest distance of the wall from the middle, of bodies to train on


def coarse_grids(boundaries: Sequence[Boundary], network: Network, head: int) -> Floats:
    """Return the nodes (batch, 2, 65, 33) of the network's grids of O `boundaries` with equal node counts.

    `head` is an index into `encoding.HEADS`. Raises InputError: with 65 nodes, a wall winds once neither
    around the centroid of the body nor around a point inside the body.
    """
    walls, strips, centres, once = _strips(boundaries)
    if not once.all():
        name = boundaries[int(np.argmin(once))].name
        raise InputError(*NOT_ROUND, source=name)
    base, factor = even(strips, LATENT), factors(strips)[:, None, None]
    for k in range(0, len(base), CHUNK):
        chunk = slice(k, k + CHUNK)
        base[chunk] = moved(base[chunk], factor[chunk], head, partial(network.moves, head=head), np)
    grids = rolled(base, centres[:, None, None])
    grids[:, :, [0, -1]] = walls
    return planes_of(grids)


def moved(base: Any, factor: Any, head: int, network: Moves, xp: Any) -> Any:
    """Return strips `base` (batch, m + 1, n) with equal steps, moved by the network and closed.

    `factor`: (batch, 1, 1) to unit size; `network` as in `coarse_grids.answered`; `xp`: numpy or torch.
    """
    strip = answered(base, (base * factor, 1.0 / factor), network, None, xp, around=True)
    if head == WINSLOW:
        strip = nearer(strip, (strip * factor, 1.0 / factor), xp, around=True)
    return xp.concatenate(
        [strip[:, :-1], strip[:, :1]], 1
    )  # exp(-i strip) closes: a whole turn on is the same


def _strips(boundaries: Sequence[Boundary]) -> tuple[Complexes, Complexes, Complexes, Bools]:
    """Return the walls at 65 nodes, their strips, the centres, and which walls wind once around them."""
    sides = [np.stack([getattr(b, side) for b in boundaries]).swapaxes(1, 2) for side in ("south", "north")]
    walls = _complex(np.stack([between(side, AROUND) for side in sides], axis=3))
    return walls, *around_middles(_complex(sides[0]), walls, inside)


def compact(boundary: Boundary) -> bool:
    """Return whether the body of an O boundary is about as thick as those of the training set."""
    _, _, centres, once = _strips([boundary])
    reach = np.abs(_complex(boundary.south.T[None]) - centres)
    return bool(once[0] and reach.min() > COMPACT * reach.max())


def _complex(planes: Floats) -> Complexes:
    return np.asarray(planes[:, 0] + 1j * planes[:, 1])


PIECES = 8  # segments of each edge of the wall, for the midpoint rule
EQUAL = 1e-9  # relative difference of two values of the potential that count as equal
WITHIN = 0.3  # largest step, as a fraction of the distance to the wall
STEPS, STILL = 50, 1e-14  # most Newton steps, and the step over the body's size at which they end


def inside(wall: Complexes) -> complex:
    """Return the point of least potential inside a simple closed curve `wall` (n,).

    The first node of the curve is not repeated. The potential is V(p) = ∮ |p - x|⁻⁴ ds, which tends to
    infinity at the wall. Its minimum is where the body is thickest; it is needed for bodies whose centroid
    lies outside of them. The point is translated, rotated and scaled with the body. If minima are equal, the
    one nearest to the first node of the wall is taken.
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
    """Return the gradient g and the second derivatives m and c of the potential of `inside` at the point `p`.

    `wall` (n,) is the closed curve of the potential. A step v of the point changes g by ``m v + c v̄``; m is
    real. `xp` is the module, numpy or torch, of `wall`.
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
