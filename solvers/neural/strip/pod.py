"""What the strip network is asked to answer: coefficients of R / size^2 in a basis across the strip.

The basis is the best one for the training set in the H1 sense (proper orthogonal decomposition), so that
angles count and not only positions.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.conformal.strip import across, to_columns
from meshonet.solvers.neural.strip.dataset import Strips
from meshonet.solvers.neural.strip.encoding import encode

HEIGHT = 4.0  # of a typical strip: brings derivatives across it to the scale of those along it


@dataclass(frozen=True)
class Targets:
    """Inputs (n, CHANNELS, COLUMNS) and (n, SCALARS); wanted answers (n, 2 Q, COLUMNS) of unit mean square.

    An answer times `scale`, in the `basis` (Q, LEVELS - 2), is R / size^2.
    """

    channels: Floats
    scalars: Floats
    wanted: Floats
    basis: Floats
    scale: float


def make_targets(strips: Strips, count: int) -> Targets:
    """Return the inputs and answers of `strips` and their mirror images, with `count` basis functions."""
    other = strips.mirrored()
    pairs = ((strips.wall, other.wall), (strips.far, other.far), (strips.residual, other.residual))
    both = Strips(*(np.concatenate(pair) for pair in pairs))
    channels, scalars, size = encode(both.wall, both.far)
    inner = np.array([to_columns(r.T).T[:, 1:-1] for r in both.residual])
    inner /= (size**2)[:, None, None]
    product = _h1_product()
    rows = inner[:, ::4].reshape(-1, inner.shape[2])  # every fourth column tells as much
    gram = rows.real.T @ rows.real + rows.imag.T @ rows.imag
    root = np.linalg.cholesky(product)
    _, vectors = np.linalg.eigh(root.T @ gram @ root)
    basis = np.linalg.solve(root.T, vectors[:, ::-1][:, :count]).T
    c = np.einsum("nxe,eq->nqx", inner, product @ basis.T)
    wanted = np.concatenate([c.real, c.imag], axis=1)
    scale = float(np.sqrt((wanted**2).sum(axis=1).mean()))
    return Targets(channels, scalars, wanted / scale, basis, scale)


def _h1_product() -> Floats:
    """Return the (LEVELS - 2)^2 matrix of f g + f' g' across the strip, for f = g = 0 on its walls."""
    grid = across()
    quadrature = np.gradient(grid.eta)
    derivative = grid.d1[:, 1:-1] / HEIGHT
    product: Floats = np.diag(quadrature[1:-1]) + derivative.T @ (quadrature[:, None] * derivative)
    return product
