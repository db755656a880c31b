from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from geometry.arrays import Floats
from geometry.lift import Lift

def fill(
    x: Floats,
    y: Floats,
    order: NDArray[np.intp],
    lift: Lift,
    sums: Sequence[tuple[int, int, Floats]],
    sharpness: float,
    along: Floats,
    across: Floats,
    matrix: Floats,
    cuts: NDArray[np.intp],
    begin: int,
    axis: tuple[complex, complex] | None,
) -> bool: ...
