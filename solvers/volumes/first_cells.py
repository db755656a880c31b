"""Restores first-cell heights at faces, by moving nodes along grid lines."""

import numpy as np

from meshonet.geometry.arrays import Floats, Side, norms
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.six_faces import FACES, SixFaces
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import volume_lines
from meshonet.solvers.volumes.interpolate import Laws

CROWDED = 0.5  # ratio of the first step to the mean step below which nodes count as clustered at that end

REACH = 12.0  # number of steps over which the correction decays by a factor e


def keep_first_cells(planes: Floats, faces: SixFaces, laws: Laws) -> tuple[str, ...]:
    """Restore first-cell heights at faces, in place; return the names of these faces.

    `planes` (3, ni, nj, nk) are x, y, z of nodes, `laws` their relative positions along edges. Heights are
    restored at faces towards which nodes cluster, by interpolation from those at the face's four edges.
    """
    kept: list[str] = []
    for axis in range(3):
        heights: list[Floats | None] = [None, None]
        steps = np.diff(laws[axis][0])
        for side in FACES:
            own, end = PLACES[side]
            if own == axis and steps[end] < CROWDED / len(steps) and len(steps) > 3:
                heights[end] = _heights(faces, side)
                kept.append(side)
        low, high = heights
        if low is not None or high is not None:
            volume_lines(planes, axis, low, high, REACH, threads_for(planes[0].size))
    return tuple(kept)


def _heights(faces: SixFaces, face: Side) -> Floats:
    """Return first-cell heights (n, m) at a face, from those of its edges; 0 on the edges."""
    axis = PLACES[face][0]
    first, second = (each for each in range(3) if each != axis)
    beside = [side for side in FACES if PLACES[side][0] != axis]
    rims = {side: log(norms(faces.steps_at_edge(side, face))) for side in beside}
    west, east = (rims[side] for side in FACES if PLACES[side][0] == first)  # along the second direction
    south, north = (rims[side] for side in FACES if PLACES[side][0] == second)
    u = np.linspace(0.0, 1.0, faces.counts[first])[:, None]
    v = np.linspace(0.0, 1.0, faces.counts[second])[None, :]
    across = (1 - u) * west + u * east + (1 - v) * south[:, None] + v * north[:, None]
    corners = (1 - u) * ((1 - v) * west[0] + v * west[-1]) + u * ((1 - v) * east[0] + v * east[-1])
    heights = exp(across - corners)
    heights[[0, -1]] = heights[:, [0, -1]] = 0.0
    return np.ascontiguousarray(heights)
