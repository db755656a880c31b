"""Settings of the march, and those that are tried in turn while cells are folded."""

import math
from dataclasses import dataclass, replace

_BEND = 0.2  # smoothing that grows with the height, beside concave corners; with 0.3 cells fold there
RISING = 0.75  # part of the levels over which the dissipation rises


@dataclass(frozen=True)
class MarchSettings:
    """Parameters of the smoothing in a march."""

    dissipation: float  # coefficient of the smoothing along a level
    # the flux along the new level weighs 1 + theta; 0 is Euler's implicit rule, more is more robust
    theta: float
    sweeps: int  # smoothing steps of the cells' areas along a level
    # how far that smoothing evens the spacing of nodes out: 1 is more robust, 0 keeps angles
    even: float = 1.0
    # relative difference of neighbouring lengths along a level beyond which it evens more
    tolerated: float = math.inf
    bend: float = 0.0  # coefficient of the smoothing that grows with the height


ATTEMPTS = (
    MarchSettings(0.6, 0.4, 20, 0.1, 0.11, 0.02),
    MarchSettings(0.5, 0.5, 10),
    MarchSettings(0.3, 0.0, 4),
    MarchSettings(1.0, 0.5, 20),
    MarchSettings(1.0, 1.0, 40),
    MarchSettings(2.0, 2.0, 40),
)
"""Settings around a closed body; the third suits first cells nearly as high as long."""
SHARP_ATTEMPTS = (replace(ATTEMPTS[0], tolerated=0.19), *ATTEMPTS[1:])
"""Settings around a body with a sharp edge: with a smaller tolerance, more lines beside it would be oblique.
"""
OPEN_ATTEMPTS = (
    MarchSettings(0.5, 0.5, 20, 0.02, 0.13, 0.02),
    MarchSettings(0.5, 0.5, 4, 0.15, bend=0.05),
    MarchSettings(0.5, 0.5, 10),
    MarchSettings(1.0, 0.5, 20),
    MarchSettings(2.0, 2.0, 40),
)
"""Settings for C grids, whose lines diverge less."""


def attempts_around_base(ratio: float, *, concave: bool) -> tuple[MarchSettings, ...]:
    """Return the settings for C grids around a blunt trailing edge, in the order in which they are tried.

    `ratio` is the growth ratio away from the wall. The larger it is, the more the lines from corners of the
    trailing edge must spread. Lines from `concave` corners converge and need more smoothing.
    """
    even = max(0.05, 0.5 * (ratio - 1.0) - 0.05)
    first = replace(OPEN_ATTEMPTS[0], even=even)
    if concave:
        return (
            replace(first, even=even + 0.02, bend=_BEND),
            replace(first, even=even + 0.05),
            *OPEN_ATTEMPTS[1:],
        )
    return (first, *OPEN_ATTEMPTS[1:])
