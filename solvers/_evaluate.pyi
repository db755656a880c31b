import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

Placed = tuple[NDArray[np.intp], Floats]

def begin_all(sides: tuple[Floats, ...], thin: tuple[Placed, ...], nodes: Floats) -> None: ...
def evaluate_all(
    coarse: Floats,
    sides: tuple[Floats, ...],
    fine: tuple[Placed, Placed],
    opened: Floats,
    near: float,
    far: float,
    reach: float,
    nodes: Floats,
    straight: NDArray[np.uint8] | None = None,
) -> None: ...
