"""Fields and grids seen from the elements of a quad's symmetry group."""

import numpy as np

from meshonet.geometry.arrays import Complexes
from meshonet.solvers.neural.quad.symmetry import ELEMENTS


def relabelled(values: Complexes, element: int) -> Complexes:
    """Return fields (..., n, n) of complex vectors or places, index axes and plane moved by an element.

    >>> square = np.array([[0, 1j], [1, 1 + 1j]]) - (0.5 + 0.5j)
    >>> [bool(np.allclose(relabelled(square, k), square)) for k in range(8)]
    [True, True, True, True, True, True, True, True]
    """
    n = values.shape[-1]
    centred = np.arange(n) - (n - 1) / 2
    places = np.stack(np.meshgrid(centred, centred, indexing="ij")).reshape(2, -1)
    at = np.rint(ELEMENTS[element] @ places + (n - 1) / 2).astype(np.int64)
    moved = values[..., at[0], at[1]].reshape(values.shape)
    back = ELEMENTS[element].T
    real = back[0, 0] * moved.real + back[0, 1] * moved.imag
    return np.asarray(real + 1j * (back[1, 0] * moved.real + back[1, 1] * moved.imag))
