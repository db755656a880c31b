"""Arrays that a cache hands out many times cannot be written to."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from meshonet.solvers.conformal import fourier_sums, strip
from meshonet.solvers.neural.models.fourier import _waves
from meshonet.solvers.neural.quad import network, picard


@pytest.mark.parametrize(
    "cached",
    [
        lambda: vars(strip.across()).values(),
        lambda: [strip.interpolation(np.linspace(0.0, 1.0, 5).tobytes())],
        lambda: fourier_sums._transform(256),
        lambda: [network.rim_factor(9, 9, False)],
        lambda: picard._padded(9, False),
        lambda: picard._transform(9, True),
        lambda: _waves(9, 9, 2, 1),
    ],
)
def test_cached_arrays_are_read_only(cached: Callable[[], Any]) -> None:
    for array in cached():
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
