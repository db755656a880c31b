"""Removes pairs of singular points from a cross field that is nearly as smooth without them.

The phase of u = exp(4 i theta) turns once around a point where three cells meet, and once in the opposite
direction where five meet. Two such points vanish if the phase jumps by a full turn across a line between
them. The gradient of the phase is then minimised with these jumps, by a linear system (Crane, Desbrun,
Schroeder, Comput. Graph. Forum 29 (2010) 1525-1533).

The energy of a field is half the integral of the squared gradient of its phase, outside of the cores of its
singular points (Bethuel, Brezis, Helein, Ginzburg-Landau Vortices, 1994). A point adds pi log(R / r), where R
is a length of the domain and r the radius of its core. With smaller cores, fewer points remain.
"""

import math

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices, complex_of
from meshonet.geometry.elementary import angle, exp, modulus, product, times
from meshonet.solvers.blocking.decomposition.surface.laplacian import Laplacian
from meshonet.solvers.blocking.decomposition.surface.surface import NEXT, Triangulation
from meshonet.solvers.sparse import Factor

CORE = 1.0  # radius of cores over the size of triangles; with 1, it is the energy that triangles resolve
MOST_PAIRS = 64  # largest number of pairs that are examined, the nearest ones
_TURN = 2.0 * np.pi  # a full turn, radians


def without_pairs(
    surface: Triangulation, laplacian: Laplacian, factor: Factor, crosses: Complexes
) -> Complexes:
    """Return the crosses (n,), with pairs of singular points removed where this lowers the energy.

    `crosses` are exp(4 i theta) at the vertices; crosses at walls do not change. The free vertices of
    `laplacian` are the interior vertices; `factor` is its factored matrix. If no pair is removed, `crosses`
    itself is returned.
    """
    phase = angle(crosses)
    steps = phase[surface.triangles[:, NEXT]] - phase[surface.triangles]
    steps -= _TURN * np.round(steps / _TURN)
    turns = np.round(steps.sum(axis=1) / _TURN).astype(np.intp)
    ends, line, crossed = _lines(surface, np.flatnonzero(turns > 0), np.flatnonzero(turns < 0))
    if not len(ends):
        return crosses
    halves, jumps = _jumps(surface, crossed, line, len(ends))
    triangle, edge = np.divmod(halves, 3)
    here, there = surface.triangles[triangle, edge], surface.triangles[triangle, NEXT[edge]]
    twin = surface.neighbours[triangle, edge], surface.neighbour_edge[triangle, edge]
    weight = -surface.edge_weights[triangle, edge] - surface.edge_weights[twin]
    jumped = weight[:, None] * jumps
    right = np.zeros((surface.size, len(ends) + 1))  # of each line, and of the field as it is
    np.add.at(right[:, :-1], here, jumped)
    np.add.at(right[:, :-1], there, -jumped)
    right[:, -1] = _divergence(surface, steps)
    moved = np.zeros_like(right)
    moved[laplacian.free] = factor.solve(right[laplacian.free])
    change = moved[there] - moved[here]
    # gradients are orthogonal to the smallest possible steps: products are sums over crossed edges
    taken = _taken(
        ends,
        product(steps[triangle, edge] + change[:, -1], jumped),
        product(jumped.T, jumps + change[:, :-1]),
    )
    if not taken:
        return crosses
    phase = phase + moved[:, -1] + moved[:, taken].sum(axis=1)
    return np.where(laplacian.free, exp(1j * phase), crosses)


def _divergence(surface: Triangulation, steps: Floats) -> Floats:
    """Return the right side (n,) of Laplace's equation for steps (t, 3) of the phase along edges."""
    flow = (-surface.edge_weights * steps).ravel()
    leaving = np.bincount(surface.triangles.ravel(), flow, surface.size)
    arriving = np.bincount(surface.triangles[:, NEXT].ravel(), flow, surface.size)
    return np.asarray(leaving - arriving)


def _jumps(surface: Triangulation, half: Indices, line: Indices, count: int) -> tuple[Indices, Floats]:
    """Return the edges (e,) that `count` lines cross, as 3 t + i, and the jumps (e, count) of the phase."""
    twin = (3 * surface.neighbours + surface.neighbour_edge).ravel()[half]
    halves, number = np.unique(np.minimum(half, twin), return_inverse=True)
    jumps = np.zeros((len(halves), count))
    np.add.at(jumps, (number, line), np.where(half < twin, -_TURN, _TURN))
    return halves, jumps


def _taken(ends: Indices, gain: Floats, products: Floats) -> list[int]:
    """Return the pairs to remove, in turn the one that lowers the energy most.

    Removing pairs x changes the energy by `gain` (k,) x + x `products` (k, k) x / 2.
    """
    change = gain + 0.5 * np.diagonal(products) + _TURN * math.log(CORE)
    taken: list[int] = []
    while True:
        best = int(np.argmin(change))
        if not change[best] < 0.0:
            return taken
        taken.append(best)
        change = change + products[best]
        change[(ends == ends[best]).any(axis=1)] = np.inf


def _lines(surface: Triangulation, first: Indices, second: Indices) -> tuple[Indices, Indices, Indices]:
    """Return the shortest lines inside a surface from the middles of `first` triangles to those of `second`.

    They are given by their end triangles (k, 2); the line (m,) of each crossing, and the edge (m,) that is
    crossed, as 3 t + i of the triangle that the line leaves.
    """
    points = complex_of(surface.points[surface.triangles])
    middle = points.mean(axis=1)
    ends = np.stack([np.repeat(first, len(second)), np.tile(second, len(first))], axis=1)
    apart = modulus(middle[ends[:, 1]] - middle[ends[:, 0]])
    ends = ends[np.argsort(apart, kind="stable")[:MOST_PAIRS]]
    begin, way = middle[ends[:, 0]], middle[ends[:, 1]] - middle[ends[:, 0]]
    at, going = ends[:, 0].copy(), np.arange(len(ends))
    seen = np.zeros(len(ends), dtype=bool)
    crossed: list[tuple[Indices, Indices, Indices]] = []
    for _ in range(len(points)):
        side = times(np.conj(way[going])[:, None], (points[at] - begin[going][:, None])).imag
        edge = np.argmax((side < 0.0) & (side[:, NEXT] >= 0.0), axis=1)  # from right to left: where it leaves
        crossed.append((going, at, edge))
        at = surface.neighbours[at, edge]
        seen[going[at == ends[going, 1]]] = True
        goes_on = (at >= 0) & (at != ends[going, 1])
        at, going = at[goes_on], going[goes_on]
        if not going.size:
            break
    line, triangle, edge = (np.concatenate(column) for column in zip(*crossed, strict=True))
    whole, number = seen[line], np.cumsum(seen) - 1
    return ends[seen], number[line[whole]], 3 * triangle[whole] + edge[whole]
