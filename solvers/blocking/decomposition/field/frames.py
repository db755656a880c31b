"""Two directions (a frame) of each cross, continuous except across a cut; the cut; sizes of frames."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, middle
from meshonet.geometry.elementary import angle, exp, times
from meshonet.kernels._native import surface_comb, surface_prune
from meshonet.solvers.blocking.decomposition.field.cross_field import CrossField
from meshonet.solvers.blocking.decomposition.field.wall_directions import QUARTER
from meshonet.solvers.blocking.decomposition.surface.laplacian import Laplacian
from meshonet.solvers.blocking.decomposition.surface.surface import NEXT, PREVIOUS

_LARGEST = 4.0
"""Logarithm of a frame's size, which is unbounded at singular points; 1 and 8 give the same blocks."""


@dataclass(frozen=True, eq=False)
class Frames:
    """One direction in each triangle, selected from the four directions of the cross field."""

    field: CrossField
    angles: Floats  # (t,) angle of the direction u
    turns: Indices  # (t, 3) quarter turns k, 0 to 3: coordinates across an edge are i^k times those here
    wall_axis: Indices  # (w,) direction d, 0 to 3, of each wall edge in its frame: it runs along i^d
    cut: Bools
    """(t, 3) edges that open the surface to a disc, through all singular vertices; others have no turns."""
    wedges: Indices  # (t, 3) number of each corner's vertex on the opened surface


def cut_frames(field: CrossField) -> Frames:
    """Return one of the cross field's four directions in each triangle, continuous except across cuts."""
    surface = field.surface
    turn, cut = surface_comb(surface.arrays, surface.size, field.quarters)
    keep = surface.on_wall.copy()
    keep[field.singular] = True
    surface_prune(surface.arrays, *surface.fans, keep.astype(np.uint8), cut)
    inner = surface.neighbours >= 0
    turns = np.where(inner, field.quarters + turn[:, None] - turn[surface.neighbours], 0)
    triangle, _ = surface.walls
    open_edges = cut.astype(bool)
    return Frames(
        field,
        field.angles + turn * QUARTER,
        turns % 4,
        (field.wall_axis - turn[triangle]) % 4,
        open_edges,
        _wedges(field, open_edges),
    )


def _wedges(field: CrossField, cut: Bools) -> Indices:
    """Return a number (t, 3) for each corner, equal for corners at a vertex that no cut separates."""
    surface = field.surface
    start, corners = surface.fans
    behind = cut[:, PREVIOUS].ravel()[corners]  # between a corner of a fan and the next
    first = np.zeros(len(corners), dtype=bool)
    first[start[:-1]] = True
    number = np.cumsum(first | np.roll(behind, 1)) - 1
    inner = np.flatnonzero(~surface.on_wall)
    closed = inner[~behind[start[inner + 1] - 1]]
    same = np.arange(number[-1] + 1)
    same[number[start[closed + 1] - 1]] = number[start[closed]]
    kept = same == np.arange(len(same))
    wedges = np.empty(len(corners), dtype=np.intp)
    wedges[corners] = (np.cumsum(kept) - 1)[same[number]]
    return wedges.reshape(-1, 3)


def frame_sizes(field: CrossField) -> Floats:
    """Return lengths e^H (t,), one per triangle, with which the cross field is nearly free of curl.

    Vectors e^H (cos theta, sin theta) along the field are free of curl if grad H is grad theta rotated by a
    quarter turn. H is the least-squares solution. Lengths are scaled to a median of about 1.
    """
    surface = field.surface
    corner = angle(field.crosses)[surface.triangles] / 4.0
    steps = corner[:, NEXT] - corner
    steps -= QUARTER * np.round(steps / QUARTER)
    steps[np.abs(steps.sum(axis=1)) > 1e-6] = 0.0  # a singularity is inside
    gradient = surface.gradients[:, 1] * steps[:, 0] - surface.gradients[:, 2] * steps[:, 2]
    turned = times(surface.areas * 1j, gradient)
    right = surface.gather(times(surface.gradients, np.conj(turned)[:, None]).real)
    free = np.ones(surface.size, dtype=bool)
    free[0] = False
    size = np.zeros(surface.size)
    size[free] = Laplacian(surface, free).factor().solve(right[free])
    size = np.clip(size - middle(size), -_LARGEST, _LARGEST)
    return np.asarray(exp(size[surface.triangles].mean(axis=1)))
