from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.conformal.lift import Lift

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
def halve(
    lift: Lift, lines: Iterable[tuple[complex, complex, complex, complex, float]], limit: float
) -> list[float]: ...
