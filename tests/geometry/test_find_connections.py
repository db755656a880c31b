"""Interfaces of planar blocks found by position: whole sides, parts, folds, rounded nodes and copies."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from block_grids import butterfly, duct, o_ring, turned

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection, c_wake, o_seam
from meshonet.geometry.blocks.find_connections import find_connections, order
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes

MAKES = [butterfly, o_ring, duct]


def lattice(*spans: tuple[float, float, int]) -> Floats:
    """Nodes (ni, nj, 2) at equal steps."""
    return np.stack(np.meshgrid(*(np.linspace(*span) for span in spans), indexing="ij"), axis=-1)


@pytest.mark.parametrize("make", MAKES)
def test_whole_sides_are_found_as_comparing_all_of_them_does(make: Callable[[], Grid]) -> None:
    grid = make()
    assert find_connections(grid.blocks) == tuple(sorted(grid.connections, key=order))


@pytest.mark.parametrize("quarters", range(4))
def test_a_part_of_a_side_is_joined_whatever_way_the_neighbour_runs(quarters: int) -> None:
    blocks = [
        Block(lattice((0, 4, 41), (0, 1, 11))),
        Block(turned(lattice((1, 2, 11), (-1, 0, 9)), quarters)),
    ]
    (joint,) = find_connections(blocks)
    assert (joint.block, joint.side, joint.range, joint.donor) == (0, "south", ((10, 20),), 1)
    Grid(with_equal_nodes(blocks, [joint]), (), (joint,))  # checks that they are, in the order that it says
    own, donor = joint.nodes(lambda block, side: blocks[block].face(side))
    np.testing.assert_allclose(own, donor, atol=1e-15)


def test_a_side_may_be_joined_to_several_blocks_and_to_itself() -> None:
    low = [Block(lattice((a, a + 1, 5), (-1, 0, 4))) for a in (0, 1, 3)]
    result = find_connections([Block(lattice((0, 4, 17), (0, 1, 4))), *low])
    assert [(c.range, c.donor) for c in result if c.block == 0] == [
        (((0, 4),), 1),
        (((4, 8),), 2),
        (((12, 16),), 3),
    ]
    angle = -np.linspace(0, 2 * np.pi, 13)
    ring = np.stack([np.outer(np.cos(angle), [1, 2, 3]), np.outer(np.sin(angle), [1, 2, 3])], axis=-1)
    assert find_connections([Block(ring)]) == (o_seam(3),)  # its ends differ in the last bits
    x = np.array([3, 2, 1, 0, 1, 2, 3.0])
    slit = np.stack([x, np.zeros(7)], axis=-1)
    around = np.array([[3, -1], [1, -1], [-1, -1], [-1, 0], [-1, 1], [1, 1], [3, 1.0]])
    assert find_connections([Block(np.stack([slit, around], axis=1))]) == (c_wake(7, 3),)


@pytest.mark.parametrize("form", ["float32", "%.5e", "%.5f", "%.9e"])
@pytest.mark.parametrize("make", MAKES)
def test_sides_that_were_computed_twice_and_rounded_become_equal(make: Callable[[], Grid], form: str) -> None:
    grid, noise = make(), np.random.default_rng(0)

    def written(nodes: Floats) -> Floats:
        values = (nodes * (1 + 1e-9 * noise.uniform(-1, 1, nodes.shape)) + 10 / 3).ravel()
        if form == "float32":
            return values.astype(np.float32).astype(float).reshape(nodes.shape)
        return np.array([float(form % value) for value in values]).reshape(nodes.shape)

    blocks = [Block(written(block.nodes)) for block in grid.blocks]
    result = find_connections(blocks)
    assert result == tuple(sorted(grid.connections, key=order))
    equal = Grid(with_equal_nodes(blocks, result), (), result)  # checks that they are
    for block, old in zip(equal.blocks, blocks, strict=True):
        assert np.abs(block.nodes - old.nodes).max() < 1e-4
        np.testing.assert_array_equal(block.nodes[1:-1, 1:-1], old.nodes[1:-1, 1:-1])


def test_a_gap_of_a_thousandth_of_a_cell_stays_open() -> None:
    low, high = lattice((0, 1, 5), (0, 1, 5)), lattice((0, 1, 5), (1.0002, 2, 5)) + 1e-13
    assert find_connections([Block(low), Block(high)]) == ()
    assert len(find_connections([Block(low), Block(high)], 1e-2)) == 1


def test_copies_of_a_grid_are_not_joined_to_each_other() -> None:
    one = duct()
    assert find_connections([one.blocks[0], one.blocks[0]]) == ()
    twice = find_connections([*one.blocks, *one.blocks])
    assert [(c.block, c.donor) for c in twice] == [(0, 1), (2, 3)]


def test_stretches_known_to_be_boundaries_are_left_out() -> None:
    grid = duct(0)
    joint = grid.connections[0]
    stretch = joint.block, joint.side, 1, 3
    assert [c.range for c in find_connections(grid.blocks, without=[stretch])] == [((0, 1),), ((3, 4),)]


def test_nodes_of_periodic_sides_become_those_of_the_first_moved() -> None:
    turn = ((np.cos(0.5), -np.sin(0.5)), (np.sin(0.5), np.cos(0.5)))
    for move in (Motion((0.1, 1.0)), Motion((0.3, 0.2), turn)):
        nodes = lattice((0, 1, 4), (0, 1, 5))
        nodes[:, -1] = move(nodes[:, 0]) + 1e-9
        joint = Connection(0, "south", ((0, 3),), 0, "north", ((0, 3),), (1,), move)
        (equal,) = with_equal_nodes([Block(nodes)], [joint])
        Grid((equal,), (), (joint,))
        np.testing.assert_allclose(move.inverse()(move(nodes)), nodes, atol=1e-14)
        assert replace(joint.reversed(), transform=None).reversed() == replace(joint, transform=None)
