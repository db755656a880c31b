"""Moves nodes of a mesh back to the loops of its domain."""

import numpy as np

from meshonet.geometry.arrays import Bools
from meshonet.geometry.layout.quad_mesh import QuadMesh

_STEPS = 3  # of projection onto the tangent, which converges quadratically


def on_loops(mesh: QuadMesh, which: Bools) -> QuadMesh:
    """Return the mesh with the nodes `which` (n,) moved to the nearest point of their loop."""
    nodes, arc = mesh.nodes.copy(), mesh.places.arc.copy()
    for number, loop in enumerate(mesh.domain.loops):
        on = np.flatnonzero(which & (mesh.places.loop == number))
        if not on.size:
            continue
        for _ in range(_STEPS):
            arc[on] += ((nodes[on] - loop.at(arc[on])) * loop.tangent(arc[on])).sum(axis=1)
        arc[on] = np.mod(arc[on], loop.length)
        nodes[on] = loop.at(arc[on])
    return mesh.with_nodes(nodes, arc)
