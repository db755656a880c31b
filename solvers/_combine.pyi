import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

def add_rows(
    x: Floats, first: NDArray[np.intp], weights: Floats, values: Floats, bends: Floats, rim: bool
) -> None: ...
