"""Settings of the march, and those that are tried in turn while cells are folded."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

RISING = 0.75  # part of the levels over which the dissipation rises


@dataclass(frozen=True)
class MarchSettings:
    """How levels are smoothed.

    Parameters
    ----------
    dissipation : coefficient of the smoothing along a level.
    theta : the flux along the new level weighs 1 + theta; 0 is Euler's implicit rule, more is more robust.
    sweeps : smoothing steps of the cells' areas along a level.
    even : how far that smoothing evens the spacing of nodes out: 1 is more robust, 0 keeps angles.
    tolerated : relative difference of neighbouring lengths along a level beyond which it evens more.
    bend : coefficient of the smoothing that grows with the height.
    """

    dissipation: float
    theta: float
    sweeps: int
    even: float = 1.0
    tolerated: float = math.inf
    bend: float = 0.0


ATTEMPTS = (
    MarchSettings(0.6, 0.4, 20, 0.1, 0.11, 0.02),
    MarchSettings(0.5, 0.5, 10),
    MarchSettings(0.3, 0.0, 4),
    MarchSettings(1.0, 0.5, 20),
    MarchSettings(1.0, 1.0, 40),
    MarchSettings(2.0, 2.0, 40),
)
"""Those around a closed body; the third suits first cells nearly as high as long."""
SHARP_ATTEMPTS = (replace(ATTEMPTS[0], tolerated=0.19), *ATTEMPTS[1:])
"""The same around a sharp edge: with less tolerance, more of the lines beside it would lean."""
OPEN_ATTEMPTS = (
    MarchSettings(0.5, 0.5, 20, 0.02, 0.13, 0.02),
    MarchSettings(0.5, 0.5, 4, 0.15, bend=0.05),
    MarchSettings(0.5, 0.5, 10),
    MarchSettings(1.0, 0.5, 20),
    MarchSettings(2.0, 2.0, 40),
)
"""The same for C grids, whose lines spread less."""
