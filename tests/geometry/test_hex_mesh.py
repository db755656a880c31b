"""Blocks in space become one mesh: shared nodes, poles, what lies beyond connected sides, and back again."""

import numpy as np
import pytest
from joined_volumes import bend, joined, shell

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.errors import InputError
from meshonet.geometry.volume.hex_mesh import hex_mesh_of, with_nodes


def lattice(ni: int, nj: int, nk: int, start: float = 0.0) -> np.ndarray:
    x = np.meshgrid(np.arange(ni) + start, np.arange(nj), np.arange(nk), indexing="ij")
    return np.stack(x, axis=-1).astype(float)


def test_a_shell_has_each_node_of_its_cube_once() -> None:
    mesh = hex_mesh_of(shell(n=5, layers=3))
    assert len(mesh.nodes) == (6 * 3**2 + 12 * 3 + 8) * 4
    assert mesh.cells == 6 * 4 * 4 * 3
    radius = np.linalg.norm(mesh.nodes, axis=1)
    np.testing.assert_array_equal(
        mesh.outer, np.isclose(radius, radius.min()) | np.isclose(radius, radius.max())
    )


def test_blocks_come_back_bitwise() -> None:
    grid = bend()
    back = with_nodes(grid, hex_mesh_of(grid))
    for block, before in zip(back.blocks, grid.blocks, strict=True):
        np.testing.assert_array_equal(block.nodes, before.nodes)
    assert back.connections == grid.connections


def test_beyond_a_connected_side_are_the_next_nodes_of_the_other_block_whichever_way_it_is_turned() -> None:
    first, second = lattice(4, 3, 5), lattice(4, 3, 5, start=3.0).transpose(1, 2, 0, 3)
    mesh = hex_mesh_of(joined([first, second]))
    wider = mesh.beyond[0]
    assert (wider[0] == -1).all()
    np.testing.assert_array_equal(mesh.nodes[wider[-1, 1:-1, 1:-1]], first[-1] + (1.0, 0.0, 0.0))


def test_the_axis_of_a_pipe_is_one_line_of_nodes() -> None:
    r, t, z = np.meshgrid([0.0, 1.0, 2.0], np.linspace(0, 1.5, 4), [0.0, 1.0], indexing="ij")
    mesh = hex_mesh_of(Grid((Block(np.stack([r * np.cos(t), r * np.sin(t), z], axis=-1)),)))
    assert len(mesh.nodes) == 2 + 2 * 4 * 2
    assert len(np.unique(mesh.blocks[0][0])) == 2


def test_a_part_of_a_side_that_is_not_joined_is_outer() -> None:
    large, small = lattice(3, 5, 3), lattice(3, 3, 3, start=2.0)
    joint = Connection(0, "east", ((0, 2), (0, 2)), 1, "west", ((0, 2), (0, 2)), (1, 2))
    mesh = hex_mesh_of(Grid((Block(large), Block(small)), (), (joint,)))
    face = mesh.outer[mesh.blocks[0][-1]]
    np.testing.assert_array_equal(face[:, 1], [True, False, True, True, True])


def test_both_sides_of_a_periodic_connection_are_outer() -> None:
    whole = ((0, 2), (0, 2))
    joint = Connection(0, "west", whole, 0, "east", whole, (1, 2), Motion((3.0, 0.0, 0.0)))
    mesh = hex_mesh_of(Grid((Block(lattice(4, 3, 3)),), (), (joint,)))
    assert len(mesh.nodes) == 36
    assert mesh.outer[mesh.blocks[0][0]].all()
    assert mesh.outer[mesh.blocks[0][-1]].all()


def test_left_handed_blocks_and_patches_of_surface_are_refused() -> None:
    good = lattice(3, 3, 3)
    with pytest.raises(InputError, match="block 1: the block is left-handed"):
        hex_mesh_of(Grid((Block(good), Block(good[::-1]))))
    with pytest.raises(InputError, match="block 0 of 3 x 3 nodes is no volume"):
        hex_mesh_of(Grid((Block(good[:, :, 0]),)))
