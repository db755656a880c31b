"""Inserts a row of quads along smooth walls on which the field has singularities.

A loop without corners, such as a circle, may have nodes at which other than two quads meet. With a ring of
quads along the loop they become irregular interior nodes, and all nodes on the wall are regular. A row of
quads along a stretch between two corners with one quad each has the same effect.

Mitchell, Tautges, "Pillowing doublets: refining a mesh to ensure that faces share at most one edge", 4th
International Meshing Roundtable (1995).
"""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.arrays import Bools, distinct
from meshonet.geometry.layout.periodic_sides import following
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.decomposition.quads.inner_rows import with_row

Span = tuple[int, float, float]
"""Number of a loop, and the arc lengths of the corners at which a stretch of it starts and ends."""


def wrong_count(mesh: QuadMesh) -> Bools:
    """Return a mask (n,) of wall nodes with a wrong number of quads; away from corners, 2 are right."""
    cells = mesh.places.cells
    return np.asarray(mesh.wall_nodes & (mesh.valence != np.where(cells > 0, cells, 2)))


def loops_to_pad(mesh: QuadMesh) -> list[int]:
    """Return indices of loops that have no corners and have a node with more or fewer than two quads."""
    wrong = distinct(mesh.places.loop[wrong_count(mesh)])
    return [int(loop) for loop in wrong if loop >= 0 and not mesh.domain.loops[loop].corners]


def spans_to_pad(mesh: QuadMesh, spans: Sequence[Span]) -> list[Span]:
    """Return those `spans` (parts of loops) inside which a node has more or fewer quads than intended."""
    places, wrong = mesh.places, wrong_count(mesh)
    return [
        (loop, begin, end)
        for loop, begin, end in spans
        if wrong[(places.loop == loop) & (places.arc > begin) & (places.arc < end)].any()
    ]


def pad(mesh: QuadMesh, loops: Sequence[int]) -> QuadMesh:
    """Return the mesh with a ring of quads added along each boundary loop in `loops`, inside the domain.

    >>> from meshonet.geometry.domain.domain import Domain
    >>> from meshonet.geometry.layout.quad_mesh import Places
    >>> square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    >>> places = Places(np.zeros(4, int), np.arange(4.0), np.zeros(4, int), np.full(4, -1))
    >>> one = QuadMesh(Domain.of_polygons([square]), square, np.array([[0, 1, 2, 3]]), places)
    >>> ring = pad(one, [0])
    >>> len(ring.quads), ring.valence.tolist()
    (5, [3, 3, 3, 3, 2, 2, 2, 2])
    """
    for number in loops:
        first = int(np.argmax(mesh.places.loop == number))
        mesh = with_row(mesh, along_wall(mesh, first, first)[:-1], closed=True, of_wall=True)
    return mesh


def pad_span(mesh: QuadMesh, span: Span) -> QuadMesh:
    """Return the mesh with a row of quads added along `span`, a part of a boundary loop, inside the domain.

    The span starts and ends at a corner with a single quad. If both are the same corner, the row goes around
    the whole loop. `with_row` describes the order of the new quads.
    """
    number, begin, end = span
    on, length = np.flatnonzero(mesh.places.loop == number), mesh.domain.loops[number].length
    first, last = (int(on[np.abs(mesh.places.arc[on] - arc % length).argmin()]) for arc in (begin, end))
    chain = along_wall(mesh, first, last)
    closed = first == last
    padded = with_row(mesh, chain[:-1] if closed else chain, closed=closed, of_wall=True)
    inner = padded.places.cells[len(mesh.nodes) + 1 : len(mesh.nodes) + len(chain) - 1]
    inner[inner > 0] = 2
    return padded


def along_wall(mesh: QuadMesh, first: int, last: int) -> list[int]:
    """Return the nodes along a boundary loop from `first` to `last`; the whole loop if both are equal."""
    after, chain = following(mesh), [first]
    while chain[-1] != last or len(chain) == 1:
        chain.append(int(after[chain[-1]]))
    return chain
