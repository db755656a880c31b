"""O grids by the quad network, from strips of 65 x 33 nodes with equal steps from wall to far field."""

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Bools, Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.resample.spline import between
from meshonet.solvers.neural.quad.coarse_grids import Moves, answered, nearer
from meshonet.solvers.neural.quad.encoding import LATENT, WINSLOW, planes_of
from meshonet.solvers.neural.quad.inside_point import inside
from meshonet.solvers.neural.quad.network import CHUNK, Network
from meshonet.solvers.neural.quad.unrolled import AROUND, around_middles, even, factors, rolled

# problem and remedy of the error, for NumPy and torch
NOT_ROUND = "its walls do not go once round a middle of the body", "use meshonet solve-pde for this shape"

COMPACT = 0.15  # least over largest distance of the wall from the middle, of bodies to train on


def coarse_grids(boundaries: Sequence[Boundary], network: Network, head: int) -> Floats:
    """Return the network's grids (batch, 2, 65, 33), x and y of 65 by 33 nodes, for O `boundaries`.

    Boundaries have equal node counts. `head` is the index in `encoding.HEADS` of the kind of grid. Raises
    InputError if no point is found around which wall and far field both wind exactly once.
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
    """Return O grids, unrolled to strips, after the network has moved their nodes.

    `base` (batch, m + 1, n) are the strips before. The last row of the result is equal to the first. `factor`
    (batch, 1, 1) scales the grids to unit size. For `head` and `network` see `quad.coarse_grids`.
    """
    strip = answered(base, (base * factor, 1.0 / factor), network, None, xp, around=True)
    if head == WINSLOW:
        strip = nearer(strip, (strip * factor, 1.0 / factor), xp, around=True)
    return xp.concatenate([strip[:, :-1], strip[:, :1]], 1)  # exp(-i strip) is the same a whole turn on


def _strips(boundaries: Sequence[Boundary]) -> tuple[Complexes, Complexes, Complexes, Bools]:
    """Return the walls at 65 nodes, their strips, the centres, and which walls wind once around them."""
    sides = [np.stack([getattr(b, side) for b in boundaries]).swapaxes(1, 2) for side in ("south", "north")]
    walls = _complex(np.stack([between(side, AROUND) for side in sides], axis=3))
    return walls, *around_middles(_complex(sides[0]), walls, inside)


def compact(boundary: Boundary) -> bool:
    """Return whether the body of an O boundary is about as thick as the bodies of the training set."""
    _, _, centres, once = _strips([boundary])
    reach = np.abs(_complex(boundary.south.T[None]) - centres)
    return bool(once[0] and reach.min() > COMPACT * reach.max())


def _complex(planes: Floats) -> Complexes:
    return np.asarray(planes[:, 0] + 1j * planes[:, 1])
