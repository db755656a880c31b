"""The minimum on windows around folded and skewed cells, before all nodes of an O grid are moved.

Splines smear what corners of a wall do to the lines that leave them. There the functional is far from a
parabola, and descents of whole grids spend most of their iterations on a few cells.
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.energy.clusters import windows
from meshonet.solvers.energy.functional import Weights
from meshonet.solvers.energy.preconditioner import Descent
from meshonet.solvers.energy.untangle import STILL, unfold

SKEWED = 1.5  # 1/sin⁴ of an angle, here 65 or 115 degrees, from which on a cell has a window around it
MARGIN_CELLS = 6  # cells around a group of skewed ones that move with them
LARGEST_CELLS = 1500  # cells of a window at the most
ITERATIONS = 30  # in a window at the most


def descend_windows(nodes: Floats, aspect: float, weights: Weights, relief: Floats) -> None:
    """Unfold planar `nodes` (ni, nj, 2) of an O grid in windows, and minimise in these, in place.

    `aspect`, `weights`, `relief`: of the functional (`meshonet.solvers.energy.functional`).
    """
    skewed = skewness(nodes)
    poor = np.argwhere(skewed > SKEWED)
    if 2 * len(poor) > skewed.size:
        poor = np.argwhere(skewed == np.inf)
    if len(poor) == 0:
        return
    for window in windows(poor, MARGIN_CELLS, nodes.shape[:2], True, LARGEST_CELLS):
        patch = window.cut(nodes, True)
        m, n = patch.shape[:2]
        if min(m, n) < 3:
            continue
        if count_folded(patch) and not unfold(patch, weights, aspect=aspect)[0]:
            continue
        eased = relief[window.rows(len(nodes), True)] if window.j0 == 0 else None
        still = STILL * float(np.sqrt((m - 1) * (n - 1)))
        Descent(patch, weights, aspect=aspect).run(still, ITERATIONS, relief=eased)
        window.put(nodes, True, patch)


def skewness(nodes: Floats) -> Floats:
    """Return the largest 1/sin⁴ of the angles of each cell of `nodes` (ni, nj, 2), infinite where folded."""
    z = nodes[..., 0] + 1j * nodes[..., 1]
    along, across = np.diff(z, axis=0), np.diff(z, axis=1)
    g, h = np.abs(along), np.abs(across)
    least = np.full((len(z) - 1, z.shape[1] - 1), np.inf)
    for south in (slice(None, -1), slice(1, None)):
        for west in (slice(None, -1), slice(1, None)):
            area = (np.conj(along[:, south]) * across[west]).imag
            np.minimum(least, area / np.maximum(g[:, south] * h[west], 1e-300), out=least)
    with np.errstate(divide="ignore"):
        return np.asarray(np.where(least > 0.0, least, 0.0) ** -4.0)
