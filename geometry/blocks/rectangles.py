"""The cells of a side as rectangles of equal ones.

::

    a a b      a a, b, b b b and so on: from the first cell that is left as far as its row
    a a b      has the same value, then as many rows down as all have it there
    b b b
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.blocks.block import Range


def rectangles(values: NDArray[np.intp]) -> Iterator[tuple[int, Range]]:
    """Yield rectangles of cells of equal value, unless it is negative, of `values` (n,) or (n, m).

    Each comes with its first and last node along each direction.
    """
    left = values.reshape(len(values), -1).copy()
    while (left >= 0).any():
        i, j = divmod(int(np.argmax(left.ravel() >= 0)), left.shape[1])
        value = int(left[i, j])
        others = np.flatnonzero(left[i, j:] != value)
        n = j + (int(others[0]) if len(others) else left.shape[1] - j)
        ends = np.flatnonzero((left[i:, j:n] != value).any(axis=1))
        m = i + (int(ends[0]) if len(ends) else len(left) - i)
        left[i:m, j:n] = -1
        yield value, ((i, m), (j, n))[: values.ndim]
