from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Real = TypeVar("Real", np.float32, np.float64)

class Program:
    def run(self, x: NDArray[Real], out: NDArray[Real]) -> None: ...

def convolve(
    x: NDArray[Real],
    w: NDArray[Real],
    bias: NDArray[Real],
    size: int,
    stride: int,
    add: NDArray[Real] | None,
    out: NDArray[Real],
    later: Program | None = None,
) -> None: ...
def winograd_scratch(inputs: int, wide: int, line: int) -> int: ...
def winograd(
    x: NDArray[Real],
    w: NDArray[Real],
    bias: NDArray[Real],
    add: NDArray[Real] | None,
    scratch: NDArray[Real],
    out: NDArray[Real],
    later: Program | None = None,
) -> None: ...
def activate(
    x: NDArray[Real], out: NDArray[Real], around: bool = False, later: Program | None = None
) -> None: ...
def refine(
    x: NDArray[Real],
    add: NDArray[Real],
    out: NDArray[Real],
    around: bool = False,
    later: Program | None = None,
) -> None: ...
def look(
    planes: NDArray[np.float64],
    steps: NDArray[np.float64],
    out: NDArray[Real],
) -> None: ...
