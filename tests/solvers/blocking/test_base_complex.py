"""Blocks of quad meshes whose blocks are known."""

import numpy as np
import pytest
from known_meshes import annulus, corner, disc, rectangle

from meshonet.geometry.polygon.area import polygon_area
from meshonet.solvers.blocking.decomposition.collapse.base_complex import base_complex
from meshonet.solvers.refinement.chords import Chords


@pytest.mark.parametrize(
    ("mesh", "blocks", "chords", "irregular"),
    [
        (rectangle(), 1, 2, 0),
        (corner(), 3, 4, 0),
        (annulus(), 1, 2, 0),  # a ring, cut once
        (disc(), 5, 3, 4),  # the butterfly of pipe cross-sections
    ],
    ids=["rectangle", "corner", "annulus", "disc"],
)
def test_known_blocks(mesh, blocks, chords, irregular):
    result = base_complex(mesh)
    assert (len(result.blocks), result.chords) == (blocks, chords)
    assert np.count_nonzero(mesh.irregular & ~mesh.wall_nodes) == irregular
    assert Chords.of(result.layout).count == chords


@pytest.mark.parametrize("mesh", [rectangle(), corner(), annulus(), disc()])
def test_blocks_are_the_quads(mesh):
    """Each quad is a cell of one block, and the same way round."""
    result = base_complex(mesh)
    cells = []
    for block in result.blocks:
        corners = block[:-1, :-1], block[1:, :-1], block[1:, 1:], block[:-1, 1:]
        cells += np.stack(corners, axis=-1).reshape(-1, 4).tolist()
    assert all(polygon_area(mesh.nodes[cell]) > 0 for cell in cells)
    assert sorted(map(sorted, cells)) == sorted(map(sorted, mesh.quads.tolist()))


@pytest.mark.parametrize("mesh", [rectangle(), corner(), annulus(), disc()])
def test_edges_against_a_search(mesh):
    """The compiled table of edges is what a dictionary of node pairs gives."""
    seen = {}
    for q, quad in enumerate(mesh.quads.tolist()):
        for i in range(4):
            seen.setdefault(frozenset((quad[i], quad[(i + 1) % 4])), []).append(4 * q + i)
    assert mesh.manifold
    assert mesh.edges.tolist() == sorted(sorted(edge) for edge in seen)
    for half_edges in seen.values():
        assert len({int(mesh.edge_of.flat[h]) for h in half_edges}) == 1
        twins = [int(mesh.twin.flat[h]) for h in half_edges]
        assert twins == (half_edges[::-1] if len(half_edges) == 2 else [-1])
