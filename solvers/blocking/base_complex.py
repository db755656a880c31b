"""The blocks that a quad mesh consists of: what its lines through irregular nodes cut it into.

From every irregular node all edges are followed straight on, through regular nodes, to the boundary or
another irregular node. Between these lines lie lattices, or rings: these get one more line.

Tarini, Puppo, Panozzo, Pietroni, Cignoni, "Simple quad domains for field aligned mesh parametrization", ACM
Trans. Graph. 30 (2011), section 3.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import connect_quads, split_quads
from meshonet.solvers.blocking.errors import BlockingError


@dataclass(frozen=True, eq=False)
class BaseComplex:
    """Blocks of a quad mesh, the edges that bound them, and its chords."""

    mesh: QuadMesh
    blocks: tuple[Indices, ...]
    """Lattices (ni, nj) of nodes, right-handed."""
    bounds: NDArray[np.bool_]
    """(e,) edges that bound blocks."""
    chord: Indices
    """(e,) number of the chord of each edge: opposite sides of a block are of one chord, and so are all edges
    beside them inside the block."""
    chords: int

    @property
    def layout(self) -> Layout:
        """The blocks as a layout."""
        return Layout(self.mesh, self.blocks)


def base_complex(mesh: QuadMesh) -> BaseComplex:
    """Return the blocks of a quad mesh.

    Lines run through periodic sides to their partners; blocks end there.

    Raises BlockingError: the mesh is not manifold, or what its lines bound are no lattices.
    """
    quads = np.ascontiguousarray(mesh.quads, dtype=np.intp)
    n = len(mesh.nodes)
    if not (mesh.places.partner >= 0).any():
        edge, twin, irregular = mesh.edge_of, mesh.twin, mesh.irregular
        bounds = np.zeros(len(mesh.edges), dtype=bool)
        found = split_quads(quads, quads, edge, twin, irregular, bounds) if mesh.manifold else None
    else:
        glued = glued_quads(mesh)
        edge, twin, ends, manifold = connect_quads(glued, n)
        glued_bounds = np.zeros(len(ends), dtype=bool)
        glued_bounds[edge[(mesh.twin < 0)]] = True
        found = (
            split_quads(glued, quads, edge, twin, _irregular(glued, twin, n), glued_bounds)
            if manifold
            else None
        )
        # edges of the mesh, two for one along periodic sides
        bounds = np.zeros(len(mesh.edges), dtype=bool)
        bounds[mesh.edge_of.ravel()] = glued_bounds[edge.ravel()]
    if found is None:
        raise BlockingError("the lines of the quad mesh do not bound lattices")
    _, blocks, chord, chords = found
    if edge is not mesh.edge_of:
        own = np.zeros(len(mesh.edges), dtype=np.intp)
        own[mesh.edge_of.ravel()] = chord[edge.ravel()]
        chord = own
    return BaseComplex(mesh, tuple(blocks), bounds, chord, chords)


def glued_quads(mesh: QuadMesh) -> Indices:
    """Return the quads (m, 4) with every node that has a partner replaced by it."""
    partner = mesh.places.partner
    return np.ascontiguousarray(np.where(partner >= 0, partner, np.arange(len(partner)))[mesh.quads])


def _irregular(quads: Indices, twin: Indices, n: int) -> NDArray[np.bool_]:
    wall = np.zeros(n, dtype=bool)
    wall[quads[twin < 0]] = True
    wall[np.roll(quads, -1, axis=1)[twin < 0]] = True
    valence = np.bincount(quads.ravel(), minlength=n)
    return (valence != np.where(wall, 2, 4)) & (valence > 0)
