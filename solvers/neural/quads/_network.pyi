from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Real = TypeVar("Real", np.float32, np.float64)

def convolve(
    x: NDArray[Real],
    w: NDArray[Real],
    bias: NDArray[Real],
    size: int,
    stride: int,
    add: NDArray[Real] | None,
    out: NDArray[Real],
) -> None: ...
def winograd_scratch(inputs: int, wide: int, line: int) -> int: ...
def winograd(
    x: NDArray[Real],
    w: NDArray[Real],
    bias: NDArray[Real],
    add: NDArray[Real] | None,
    scratch: NDArray[Real],
    out: NDArray[Real],
) -> None: ...
def activate(x: NDArray[Real], out: NDArray[Real], around: bool = False) -> None: ...
def refine(x: NDArray[Real], add: NDArray[Real], out: NDArray[Real], around: bool = False) -> None: ...
def look(
    planes: NDArray[np.float64],
    middle: NDArray[np.float64],
    factor: NDArray[np.float64],
    scratch: NDArray[np.float64],
    out: NDArray[Real],
) -> None: ...
