"""How sharply walls bend."""

import numpy as np

from meshonet.geometry.arrays import Floats, running_sums
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.elementary import arctan2


def wall_bend(loop: Loop, arcs: Floats, window: int) -> Floats:
    """Return the curvature (n,) of a loop at ascending arc lengths (n,), averaged over `window` either way.

    In radians over the loop's unit, either way; its corners, which are among `arcs`, are no curvature.
    """
    along = loop.tangent(arcs)
    direction = arctan2(along[:, 1], along[:, 0])
    turn = np.diff(direction, append=direction[:1])
    turn = np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi)
    turn[np.searchsorted(arcs, loop.corner_arcs) - 1] = 0.0
    step = np.diff(arcs, append=arcs[0] + loop.length)
    around = np.arange(-window, len(arcs) + window) % len(arcs)
    return running_sums(turn[around], 2 * window + 1) / running_sums(step[around], 2 * window + 1)
