r"""A row of quads along a wall with a sharp edge, and along both sides of the grid line behind it.

::

    ---------------- front --------------.
                                          \
      wake   -------------------- edge  wall |      the nodes of the path wake, wall, wake are doubled,
                                          /       with a quad at each of its edges: a C
    ---------------- front --------------'
"""

import numpy as np

from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.quads.inner_rows import HalfEdges, half_edges, with_row
from meshonet.solvers.blocking.decomposition.quads.padding import along_wall


def has_sharp_edge(loop: Loop) -> bool:
    """Return whether a loop has exactly one corner, so sharp that four cells meet there."""
    return len(loop.corners) == 1 and int(loop.corner_cells[0]) == 4


def wake_of(mesh: QuadMesh, number: int) -> list[int]:
    """Return the nodes of the grid line from the sharp edge of a loop to a boundary."""
    half = half_edges(mesh)
    edge, ahead = _edge(mesh, number)[:2]
    wake = [edge, _turned(mesh, half, edge, ahead, 2)]
    while not mesh.wall_nodes[wake[-1]]:
        wake.append(_turned(mesh, half, wake[-1], wake[-2], int(mesh.valence[wake[-1]]) // 2))
    return wake


def with_sheet(mesh: QuadMesh, number: int) -> QuadMesh:
    """Return the mesh with a row of quads inserted around the loop with index `number` and its wake.

    The new quads are the last of the mesh. The first two nodes of each are on the loop or its wake, the
    others on the front (the opposite side of the row).
    """
    wake = wake_of(mesh, number)
    return with_row(mesh, [*wake[:0:-1], *_edge(mesh, number), *wake])


def _edge(mesh: QuadMesh, number: int) -> list[int]:
    """Return the nodes of a loop in order, the domain on their left, from its sharp edge on."""
    edge = int(np.argmax((mesh.places.loop == number) & (mesh.places.cells == 4)))
    return along_wall(mesh, edge, edge)[:-1]


def _turned(mesh: QuadMesh, half: HalfEdges, node: int, beside: int, steps: int) -> int:
    """Return the neighbour of a node that follows another one after a number of quads, counter-clockwise."""
    for _ in range(steps):
        k, i = half[node, beside]
        beside = int(mesh.quads[k, (i + 3) % 4])
    return beside
