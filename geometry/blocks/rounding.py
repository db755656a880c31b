"""The rounding error of coordinates, estimated from the digits that they were written with.

Files have numbers in single precision, with so many digits, or with so many decimals. The same point of two
blocks, computed twice and rounded then, differs by a unit of the last digit, which next to walls can be a
large part of a cell.
"""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats

_DECIMALS = range(3, 13)  # places behind the point that numbers may have been written with
_DIGITS = range(5, 14)  # significant digits that numbers may have been written with
_MOST = 400
"""Values of which digits are counted, one after the other."""


def rounding(values: Floats) -> Callable[[Floats], Floats]:
    """Return the function from magnitudes (n,) to the last unit (n,) of coordinates like `values` (m,).

    >>> unit = rounding(np.array([0.123457, 12.345679, 3.0]))  # written by %.6f
    >>> unit(np.array([1.0, 2.0])).tolist()
    [1e-06, 1e-06]
    """
    with np.errstate(over="ignore"):
        odd = values[values != values.astype(np.float32)]
    if not len(odd):
        return lambda size: np.asarray(size * 2**-23)
    numbers = odd[:: max(1, len(odd) // _MOST)].tolist()
    fixed = (10**-k for k in _DECIMALS if (values == np.round(values, k)).all())
    relative = (10 ** (1 - k) for k in _DIGITS if all(v == float(f"{v:.{k - 1}e}") for v in numbers))
    unit, part = next(fixed, 0.0), next(relative, 2**-50)
    return lambda size: np.maximum(unit, size * part)
