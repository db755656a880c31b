"""Transfinite interpolation of a planar grid from its four edges.

Gordon and Hall, Int. J. Numer. Meth. Engng 7 (1973) 461-477; parameters: Soni, AIAA 85-1526 (1985).
"""

from typing import Literal, get_args

import numpy as np

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import tfi as fill
from meshonet.solvers.solution import Solution, timed

Blending = Literal["linear", "arclength"]
Four = tuple[Floats, Floats, Floats, Floats]


def tfi(boundary: Boundary, blending: Blending = "arclength") -> Grid:
    """Return the grid inside `boundary` by transfinite interpolation; its cells may be folded.

    The edges S, N, W and E meet at corners a, b, c and d; s, n, w and e are parameters along them::

        x = (1-v) S_i + v N_i + (1-u) W_j + u E_j - (1-u)(1-v) a - u (1-v) b - u v c - (1-u) v d
        u = s_i + (n_i - s_i) v,    v = w_j + (e_j - w_j) u

    With the `blending` ``linear``, the parameters are i / (ni - 1). With ``arclength`` they are fractions of
    the arc length of the edge, so that its spacing continues into the interior. Raises InputError if the
    blending is unknown.
    """
    edges = (boundary.south, boundary.north, boundary.west, boundary.east)
    facts = {"method": "tfi", "blending": blending}
    return boundary.grid(between(edges, blending), facts)


@timed
def solve(boundary: Boundary, *, blending: Blending = "arclength") -> Solution:
    """Return the transfinite interpolation of `boundary` (see `tfi`) as a solution."""
    grid = tfi(boundary, blending)
    return Solution(grid, "tfi")


def between(edges: Four, blending: Blending = "arclength") -> Floats:
    """Return nodes (ni, nj, 2) by transfinite interpolation (`tfi`) of south, north, west, east (n, 2)."""
    nodes = planar_nodes(len(edges[0]), len(edges[2]))
    interpolate(nodes[..., 0], nodes[..., 1], edges, parameters(edges, blending))
    return nodes


def parameters(edges: Four, blending: Blending) -> Four:
    """Return the parameters (n,), from 0 to 1, along each of the `edges` (n, 2): south, north, west, east."""
    if blending not in get_args(Blending):
        remedy = "use " + "/".join(get_args(Blending))
        raise InputError(f"blending {blending!r} is not known", remedy, parameter="blending")
    if blending == "linear":
        south, north, west, east = (np.linspace(0.0, 1.0, len(edge)) for edge in edges)
    else:
        south, north, west, east = (arc_length_fraction(edge) for edge in edges)
    return south, north, west, east


def interpolate(x: Floats, y: Floats, edges: Four, along: Four) -> None:
    """Fill `x` and `y` (ni, nj) from the `edges` south, north, west, east with the parameters `along`."""
    south, north, west, east = (np.ascontiguousarray(edge.T) for edge in edges)
    xs, ys = ((south[k], north[k], west[k], east[k]) for k in (0, 1))
    fill(x, y, xs, ys, along, threads_for(x.size))


def arc_length_fraction(points: Floats) -> Floats:
    """Return the arc length up to each point of polylines (..., n, 2), as a fraction (..., n) of the whole.

    >>> arc_length_fraction(np.array([[0.0, 0.0], [3.0, 4.0], [3.0, 9.0]]))
    array([0. , 0.5, 1. ])
    """
    along = np.zeros(points.shape[:-1])
    steps = points[..., 1:, :] - points[..., :-1, :]
    np.hypot(steps[..., 0], steps[..., 1], out=along[..., 1:])
    np.cumsum(along, axis=-1, out=along)
    along /= along[..., -1:]
    return along
