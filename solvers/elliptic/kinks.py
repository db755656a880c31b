"""Relaxation of Winslow's equations around kinks of a boundary, where spline interpolation is inaccurate."""

from collections.abc import Iterator

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, as_planar
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import angles
from meshonet.solvers.elliptic.multigrid import relax

REACH = 3.0
"""Number of coarse cells on each side of a kink, and inwards, that are relaxed at full resolution; half of it
if it is more than `NEAR` fine cells and Winslow's equations were solved.
"""
NEAR = 40  # fine cells from the kink
SWEEPS = 4  # sweeps there


def sweep_kinks(
    nodes: Floats, boundary: Boundary, counts: tuple[int, int], *, only_better: bool = False
) -> bool:
    """Relax planar `nodes` in place around the kinks of the boundary; return whether there are any.

    `nodes` (ni, nj, 2) have been interpolated by splines from a coarser grid of `counts` nodes, and
    splines are too smooth near kinks. With `only_better`, the nodes around a kink move only if the largest
    angle of the cells there becomes smaller.
    """
    any_kinks = False
    steps = [(n - 1) / (m - 1) for n, m in zip(nodes.shape[:2], counts, strict=True)]
    for axis, sides in ((0, ("south", "north")), (1, ("west", "east"))):
        if boundary.periodic and axis == 1:
            continue
        n, lines = nodes.shape[axis], nodes.shape[1 - axis]
        wide = REACH * steps[axis], REACH * steps[1 - axis]
        reach, depth = (int(np.ceil(w if only_better else min(w, max(NEAR, 0.5 * w)))) for w in wide)
        for side in sides:
            corners = boundary.corners[side]
            any_kinks = any_kinks or len(corners) > 0
            inside = (
                slice(0, depth + 1) if side in {"south", "west"} else slice(max(lines - depth - 1, 0), lines)
            )
            for start, stop in _joined(corners, reach, n):
                window = (slice(start, stop), inside) if axis == 0 else (inside, slice(start, stop))
                patch = as_planar(nodes[window])
                before = angles(patch)[0] if only_better else 0.0
                relax(patch, SWEEPS)
                if not only_better or angles(patch)[0] < before:
                    nodes[window] = patch
    return any_kinks


def _joined(kinks: Indices, reach: int, n: int) -> Iterator[tuple[int, int]]:
    """Yield ranges of indices, none touching another, `reach` to each side of the `kinks`, within n."""
    start = stop = 0
    for kink in kinks:
        if stop and kink - reach > stop:
            yield start, stop
            stop = 0
        start = start if stop else max(int(kink) - reach, 0)
        stop = min(int(kink) + reach + 1, n)
    if stop:
        yield start, stop
