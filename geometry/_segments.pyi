import numpy as np
from numpy.typing import NDArray

def crossing_pairs(
    points: NDArray[np.float64],
    closed: bool,
    order: NDArray[np.intp],
    low: NDArray[np.float64],
    top: NDArray[np.float64],
    limit: int,
    budget: int,
) -> tuple[list[tuple[int, int]], bool]: ...
