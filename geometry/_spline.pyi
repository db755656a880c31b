from numpy import float64
from numpy.typing import NDArray

def solve_tridiagonal(
    lower: NDArray[float64], diagonal: NDArray[float64], upper: NDArray[float64], right: NDArray[float64]
) -> None: ...
