"""Points of the computational square: those of sensors and of nodes, and features of their coordinates."""

from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary


def sensors(boundary: Boundary, count: int) -> Floats:
    """Return `count` points of the boundary (count, 2), interpolated linearly between its nodes.

    On four-sided boundaries they start at the south-west corner and run counter-clockwise, at equal steps of
    xi and eta. On O boundaries half of them, rounded up, are on the body, the rest on the far field.
    """
    if boundary.periodic:
        inner = count - count // 2
        rings = (boundary.south, inner), (boundary.north, count - inner)
        return np.concatenate([_at(ring, np.arange(n) / n) for ring, n in rings])
    place = 4.0 * np.arange(count) / count
    sides = (boundary.south, boundary.east, boundary.north[::-1], boundary.west[::-1])
    points = np.empty((count, 2))
    for k, side in enumerate(sides):
        own = (place >= k) & (place < k + 1)
        points[own] = _at(side, place[own] - k)
    return points


def square(ni: int, nj: int) -> Floats:
    """Return the parameters (ni * nj, 2), xi and eta from 0 to 1, of a grid's nodes; eta varies fastest."""
    xi, eta = np.linspace(0.0, 1.0, ni), np.linspace(0.0, 1.0, nj)
    return np.stack(np.meshgrid(xi, eta, indexing="ij"), axis=-1).reshape(-1, 2)


def rim(ni: int, nj: int, topology: Topology) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return a mask (ni * nj,) of the boundary nodes of a grid; the cut of an O grid is no boundary."""
    on = np.zeros((ni, nj), dtype=bool)
    on[:, [0, -1]] = True
    if topology != "o":
        on[[0, -1]] = True
    return on.reshape(-1)


def lift(xp: Any, points: Any, powers: int) -> Any:
    """Return the paper's Lift-Layer: sines, cosines and powers of xi and eta (p, 4 + 2 powers).

    `points` (p, 2) is an array of `xp`, numpy or torch. Xiao et al., arXiv 2501.11937, section III.
    """
    return xp.concatenate([xp.sin(points), xp.cos(points), *(points**q for q in range(1, powers + 1))], -1)


def _at(side: Floats, place: Floats) -> Floats:
    """Return points of the polyline `side`, linearly interpolated at fractions 0 to 1 of the index."""
    index = place * (len(side) - 1)
    nodes = np.arange(len(side))
    return np.stack([np.interp(index, nodes, side[:, 0]), np.interp(index, nodes, side[:, 1])], axis=1)
