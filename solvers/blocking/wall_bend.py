"""How sharply walls bend."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.loop import Loop


def wall_bend(loop: Loop, arcs: Floats, window: int) -> Floats:
    """Return the curvature (n,) of a loop at ascending arc lengths (n,), averaged over `window` either way.

    In radians over the loop's unit, either way; its corners, which are among `arcs`, are no curvature.
    """
    along = loop.tangent(arcs)
    direction = np.arctan2(along[:, 1], along[:, 0])
    turn = np.diff(direction, append=direction[:1])
    turn = np.abs((turn + np.pi) % (2.0 * np.pi) - np.pi)
    turn[np.searchsorted(arcs, loop.corner_arcs) - 1] = 0.0
    step = np.diff(arcs, append=arcs[0] + loop.length)
    around = np.arange(-window, len(arcs) + window) % len(arcs)
    kernel = np.ones(2 * window + 1)
    return np.convolve(turn[around], kernel, "valid") / np.convolve(step[around], kernel, "valid")
