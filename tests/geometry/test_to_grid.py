"""Layouts as grids: connections, periodic pairs, patches."""

from dataclasses import replace

import numpy as np
import pytest

from meshonet.geometry.blocks.connection import o_seam
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.quality.measure import count_folded

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def two_squares(turn=0):
    """Return a layout of [0, 2] x [0, 1]: 2 x 2 cells a unit, the right block turned by quarters."""
    loop = Loop.of_polygon(np.array([[0.0, 0], [2, 0], [2, 1], [0, 1]]), names=("low", "out", "top", "in"))
    x, y = np.meshgrid(np.linspace(0, 2, 5), np.linspace(0, 1, 3), indexing="ij")
    number = np.arange(15).reshape(5, 3)
    quads = np.stack([number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]], -1).reshape(-1, 4)
    places = Places.inside(15)
    nodes = np.stack([x.ravel(), y.ravel()], axis=1)
    mesh = QuadMesh(Domain((loop,), "box"), nodes, quads, places)
    for k in np.flatnonzero(mesh.wall_nodes):
        px, py = nodes[k]
        places.loop[k] = 0
        places.arc[k] = px if py == 0 else 2 + py if px == 2 else 5 - px if py == 1 else 6 - py
    return Layout(mesh, (number[:3], np.rot90(number[2:], turn)))


@pytest.mark.parametrize("turn", range(4))
def test_blocks_meet_however_they_are_turned(turn):
    """`Grid` compares the nodes of connected sides itself; here is only whether all is there."""
    grid = to_grid(two_squares(turn))
    (joint,) = grid.connections
    own, donor = grid.face(0, "east"), grid.face(1, joint.donor_side)
    np.testing.assert_array_equal(own, donor[:: joint.orientation[0]])
    assert (joint.block, joint.side, joint.range, joint.donor) == (0, "east", ((0, 2),), 1)
    assert sorted(patch.name for patch in grid.patches) == ["in", "low", "low", "out", "top", "top"]
    assert {patch.kind for patch in grid.patches} == {"other"}
    assert sum(count_folded(block.nodes) for block in grid.blocks) == 0
    assert grid.name == "box"


@pytest.mark.parametrize("turn", range(4))
def test_a_block_meets_two_others_along_one_side(turn):
    layout = two_squares()
    left, right = layout.blocks
    grid = to_grid(replace(layout, blocks=(left, np.rot90(right[:, :2], turn), right[:, 1:])))
    ranges = {joint.donor: joint.range for joint in grid.connections if joint.block == 0}
    assert ranges == {1: ((0, 1),), 2: ((1, 2),)}
    assert len(grid.connections) == 3
    assert sum(patch.stop - patch.start for patch in grid.outer_patches()) == 2 * (4 + 2)


def test_a_patch_ends_where_its_name_does():
    """One block over a wall of two names."""
    layout = two_squares()
    loop = Loop.of_polygon(
        np.array([[0.0, 0], [1, 0], [2, 0], [2, 1], [0, 1]]), (0, 1, 2, 3, 4), ("a", "b", "out", "top", "in")
    )
    number = np.arange(15).reshape(5, 3)
    mesh = replace(layout.mesh, domain=Domain((loop,)))
    south = [patch for patch in to_grid(Layout(mesh, (number,))).patches if patch.side == "south"]
    assert [(patch.name, patch.start, patch.stop) for patch in south] == [("a", 0, 2), ("b", 2, 4)]


def test_a_ring_is_connected_to_itself():
    t = np.arange(12) * -np.pi / 6
    ways = np.stack([np.cos(t), np.sin(t)], axis=1)
    domain = Domain.of_polygons([2 * ways, ways])
    ring = np.arange(36).reshape(12, 3)
    ring = np.concatenate([ring, ring[:1]])
    quads = np.stack([ring[:-1, :-1], ring[1:, :-1], ring[1:, 1:], ring[:-1, 1:]], -1).reshape(-1, 4)
    places = Places.inside(36)
    places.loop[0::3], places.loop[2::3] = 1, 0
    places.arc[0::3] = domain.loops[1].curve.knots
    places.arc[2::3] = domain.loops[0].curve.knots[np.arange(12, 0, -1) % 12]
    nodes = (np.array([1.0, 1.5, 2.0])[:, None] * ways[:, None]).reshape(-1, 2)
    grid = to_grid(Layout(QuadMesh(domain, nodes, quads, places), (ring,)))
    assert (grid.connections, grid.topology) == ((o_seam(3),), "o")
    assert [(patch.name, patch.kind, patch.side) for patch in grid.patches] == [
        ("body", "wall", "south"),
        ("outer", "other", "north"),
    ]


def test_periodic_sides_are_moved_exactly():
    """Bottom and top of a square whose period is not a machine number."""
    layout = two_squares()
    shift = (0.1, 1.0 / 3.0)
    mesh = layout.mesh
    nodes = mesh.nodes.copy()
    bottom, top = np.arange(0, 15, 3), np.arange(2, 15, 3)
    nodes[bottom] = np.stack([np.linspace(0, 2, 5) / 3, np.zeros(5)], axis=1)
    nodes[top] = nodes[bottom] + np.array(shift) * (1 + 1e-12)
    nodes[1::3] = 0.5 * (nodes[bottom] + nodes[top])
    partner = np.full(15, -1)
    partner[top] = bottom
    loop = Loop.of_polygon(nodes[[0, 12, 14, 2]])
    domain = Domain((loop,), periodic=(Periodic((0, 2 / 3), (1, 2), shift),))
    mesh = QuadMesh(domain, nodes, mesh.quads, replace(mesh.places, partner=partner))
    grid = to_grid(Layout(mesh, layout.blocks))
    moved = [connection for connection in grid.connections if connection.transform]
    assert len(moved) == 2
    for connection in moved:
        first, second = connection.nodes(grid.face)
        np.testing.assert_array_equal(first, second)
    names = sorted(patch.name for patch in grid.patches if patch.kind == "periodic")
    assert names == ["periodic1", "periodic1", "periodic2", "periodic2"]
