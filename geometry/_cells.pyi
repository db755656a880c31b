import numpy as np
from numpy.typing import NDArray

def count_folded(x: NDArray[np.float64], y: NDArray[np.float64]) -> int: ...
def folded_cells(x: NDArray[np.float64], y: NDArray[np.float64], room: int) -> NDArray[np.int64]: ...
def measure(
    x: NDArray[np.float64],
    y: NDArray[np.float64],
    periodic: bool,
    wake: int,
    summary: NDArray[np.float64],
    where: NDArray[np.int64],
    keep: int,
    kept: NDArray[np.float64],
    brackets: NDArray[np.float64],
    counts: NDArray[np.int64],
    caught: NDArray[np.float64],
) -> None: ...
