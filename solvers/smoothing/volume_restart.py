"""New interior nodes for volumes whose given nodes are unusable: Laplace's equation on the graph of edges.

Tutte, Proc. London Math. Soc. 13 (1963) 743-767.
"""

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices
from meshonet.geometry.volume.hex_mesh import HexMesh

_MOST, _SMALL = 500, 1e-8  # largest number of iterations, and the relative residual at which they end


def harmonic(mesh: HexMesh, moves: Bools) -> Floats:
    """Return the nodes (n, 3) of a mesh; nodes in the mask `moves` (n,) go to the mean of their neighbours.

    Thus coordinates of moved nodes satisfy Laplace's equation on the graph of edges. Other nodes stay.
    """
    edges = _edges(mesh)
    start = mesh.nodes.copy()
    start[moves] = mesh.nodes[~moves].mean(axis=0)
    x = np.zeros_like(start)
    residual = -_laplacian(start, edges)
    residual[~moves] = 0.0
    way, size = residual.copy(), (residual**2).sum(axis=0)
    enough = _SMALL**2 * size
    for _ in range(_MOST):
        if (size <= enough).all():
            break
        turned = _laplacian(way, edges)
        turned[~moves] = 0.0
        part = size / np.maximum((way * turned).sum(axis=0), 1e-300)
        x += part * way
        residual -= part * turned
        after = (residual**2).sum(axis=0)
        way = residual + after / np.maximum(size, 1e-300) * way
        size = after
    return np.asarray(start + x)


def _edges(mesh: HexMesh) -> Indices:
    """Return the edges (e, 2) of a mesh; edges of interfaces occur once per block."""
    edges = []
    for block in mesh.blocks:
        for axis in range(3):
            numbers = np.moveaxis(block, axis, 0)
            edges.append(np.stack([numbers[:-1].ravel(), numbers[1:].ravel()], axis=1))
    return np.concatenate(edges)


def _laplacian(values: Floats, edges: Indices) -> Floats:
    steps = values[edges[:, 0]] - values[edges[:, 1]]
    sums = [
        np.bincount(edges[:, 0], step, len(values)) - np.bincount(edges[:, 1], step, len(values))
        for step in steps.T
    ]
    return np.stack(sums, axis=1)
