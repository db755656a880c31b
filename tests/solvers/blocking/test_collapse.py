"""Chords taken out of quad meshes, and rings of quads put in."""

import numpy as np
from known_meshes import annulus, corner, disc, lattice_in_a_circle, rectangle

from meshonet.solvers.blocking.decomposition.collapse.base_complex import base_complex
from meshonet.solvers.blocking.decomposition.collapse.collapse import contract, is_conforming, widths
from meshonet.solvers.blocking.decomposition.quads.padding import loops_to_pad, pad, wrong_count


def rungs_at(mesh, start, end):
    """Return the edges (e,) of the mesh chord that the edge between two points belongs to."""
    label = np.arange(len(mesh.edges))
    for _ in range(len(mesh.quads)):
        for sides in mesh.edge_of.tolist():
            for a, b in ((0, 2), (1, 3)):
                label[[sides[a], sides[b]]] = min(label[sides[a]], label[sides[b]])
    ends = [int(np.hypot(*(mesh.nodes - point).T).argmin()) for point in (start, end)]
    return label == label[mesh.edges.tolist().index(sorted(ends))]


def test_a_column_of_a_rectangle():
    """Taking a column out of 6 x 4 cells leaves 5 x 4, its neighbours meeting in the middle."""
    mesh = rectangle(6, 4)
    less = contract(mesh, rungs_at(mesh, (1.0, 0.0), (1.5, 0.0)))
    assert len(less.quads) == 5 * 4
    bottom = np.sort(less.nodes[less.nodes[:, 1] == 0.0, 0])
    np.testing.assert_allclose(bottom, [0, 0.5, 1.25, 2, 2.5, 3])
    assert is_conforming(less)


def test_a_corner_stays():
    """Next to a corner, nodes go to the corner."""
    mesh = rectangle(6, 4)
    less = contract(mesh, rungs_at(mesh, (0.0, 0.0), (0.5, 0.0)))
    np.testing.assert_allclose(np.sort(less.nodes[less.nodes[:, 1] == 0.0, 0]), [0, 1, 1.5, 2, 2.5, 3])


def test_two_corners_do_not_meet():
    mesh = rectangle(6, 1)
    assert contract(mesh, rungs_at(mesh, (0.0, 0.0), (0.0, 2.0))) is None


def test_a_ring_from_wall_to_wall_stays():
    """All cells between two loops: the loops would be one."""
    mesh = annulus(24, 1)
    radial = rungs_at(mesh, (1.0, 0.0), (2.0, 0.0))
    assert np.count_nonzero(radial) == 24
    assert contract(mesh, radial) is None


def test_widths_are_those_of_blocks():
    result = base_complex(corner(3))
    np.testing.assert_allclose(widths(result), 1.0)


def test_padding_moves_wrong_counts_inside():
    """A lattice in a circle has its four corners on the wall; a ring of quads makes it a butterfly."""
    mesh = lattice_in_a_circle(4)
    assert np.count_nonzero(wrong_count(mesh)) == 4
    assert loops_to_pad(mesh) == [0]
    result = base_complex(pad(mesh, [0]))
    assert len(result.blocks) == 5
    assert result.mesh.valence[result.mesh.irregular].tolist() == [3, 3, 3, 3]


def test_padding_keeps_the_mesh_conforming():
    mesh = disc(3)
    ring = pad(mesh, [0])
    assert is_conforming(ring)
    assert len(ring.quads) == len(mesh.quads) + 24
    assert np.count_nonzero(wrong_count(ring)) == 0
    np.testing.assert_allclose(np.hypot(*ring.nodes[ring.wall_nodes].T), 1.0, atol=2e-4)
    old = ring.nodes[: len(mesh.nodes)][mesh.wall_nodes]
    assert np.hypot(*old.T).max() < 0.99
