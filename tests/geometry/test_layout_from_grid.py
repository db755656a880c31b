"""The layout of a grid of blocks has its nodes once, and a domain whose loops run through its own nodes."""

from dataclasses import replace

import numpy as np
import pytest
from block_grids import butterfly, duct, o_ring

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.from_grid import layout_of, with_nodes


@pytest.mark.parametrize("grid", [butterfly(), o_ring(), duct(0), duct(1), duct(2), duct(3, bend=0.2)])
def test_boundary_nodes_are_on_the_loops_at_their_arc_lengths(grid: Grid) -> None:
    mesh = layout_of(grid).mesh
    np.testing.assert_array_equal(mesh.places.loop >= 0, mesh.wall_nodes)
    for number, loop in enumerate(mesh.domain.loops):
        on = mesh.places.loop == number
        np.testing.assert_array_equal(loop.at(mesh.places.arc[on]), mesh.nodes[on])
    ring = mesh.nodes[mesh.quads]
    (ax, ay), (bx, by) = (ring[:, 2] - ring[:, 0]).T, (ring[:, 3] - ring[:, 1]).T
    assert mesh.domain.area == pytest.approx(0.5 * (ax * by - ay * bx).sum())


@pytest.mark.parametrize("grid", [butterfly(), duct(3, bend=0.2)])
def test_the_nodes_of_a_layout_are_those_of_the_grid_again(grid: Grid) -> None:
    again = with_nodes(grid, layout_of(grid))
    for block, before in zip(again.blocks, grid.blocks, strict=True):
        np.testing.assert_array_equal(block.nodes, before.nodes)


def test_a_butterfly_has_four_vertices_of_three_cells_and_a_smooth_wall() -> None:
    mesh = layout_of(butterfly()).mesh
    assert sorted(mesh.valence[mesh.irregular & ~mesh.wall_nodes]) == [3, 3, 3, 3]
    assert len(mesh.nodes) == 49 + 4 * 24
    (loop,) = mesh.domain.loops
    assert (loop.corners, loop.names) == ((), ("wall",))


def test_names_change_at_corners_and_turns_are_corners() -> None:
    (loop,) = layout_of(duct(3, bend=0.2)).mesh.domain.loops
    corners = dict(zip(map(tuple, loop.curve.points[list(loop.corners)].tolist()), loop.names, strict=True))
    assert corners == {
        (0.0, 0.0): "wall", (2.0, 0.0): "wall", (4.0, 0.4): "outlet",
        (4.0, 1.4): "wall", (2.0, 1.0): "wall", (0.0, 1.0): "inlet",
    }  # fmt: skip


def test_a_hole_is_a_second_loop() -> None:
    loops = layout_of(o_ring()).mesh.domain.loops
    assert [loop.names for loop in loops] == [("farfield",), ("wall",)]
    assert loops[0].length > loops[1].length


def test_an_o_grid_of_one_block_is_a_layout_too() -> None:
    blocks = [block.nodes for block in o_ring().blocks]
    whole = np.concatenate([*(nodes[:-1] for nodes in blocks), blocks[0][:1]])
    mesh = layout_of(Grid.from_nodes(whole, "o")).mesh
    assert (len(mesh.domain.loops), len(mesh.nodes), mesh.irregular.any()) == (2, 24 * 6, False)


def periodic_duct(shift: tuple[float, float] = (0.0, 1.0)) -> Grid:
    grid = duct(0)
    span = ((0, 8),)
    sides = tuple(Connection(k, "south", span, k, "north", span, (1,), Motion(shift)) for k in (0, 1))
    patches = tuple(p for p in grid.patches if p.name != "wall")
    return replace(grid, patches=patches, connections=(*grid.connections, *sides))


def test_periodic_sides_are_stretches_of_the_loop_and_their_nodes_partners() -> None:
    mesh = layout_of(periodic_duct()).mesh
    (period,) = mesh.domain.periodic
    assert (period.first, period.shift) == ((0.0, 4.0), (0.0, 1.0))
    assert period.second == pytest.approx((5.0, 9.0))
    moved = np.flatnonzero(mesh.places.partner >= 0)
    assert len(moved) == 17
    np.testing.assert_array_equal(mesh.nodes[moved], mesh.nodes[mesh.places.partner[moved]] + period.shift)


def test_two_blocks_at_one_side_of_another_are_refused_with_the_place() -> None:
    x, y = np.meshgrid(np.arange(3.0), np.arange(3.0), indexing="ij")
    square = np.stack([x, y], axis=-1)
    span = ((0, 2),)
    twice = tuple(Connection(0, "east", span, k, "west", span, (1,)) for k in (1, 2))
    blocks = tuple(Block(square + shift) for shift in ([0, 0], [2, 0], [2, 0]))
    with pytest.raises(InputError, match=r"blocks overlap at \(2, 0\) of block 2"):
        layout_of(Grid(blocks, (), twice))


def test_what_is_no_planar_right_handed_grid_is_refused() -> None:
    grid = duct(0)
    mirrored = tuple(Block(block.nodes[::-1]) for block in grid.blocks[:1])
    with pytest.raises(InputError, match="left-handed"):
        layout_of(Grid(mirrored))
    solid = np.stack(np.meshgrid(*[np.arange(3.0)] * 3, indexing="ij"), axis=-1)
    with pytest.raises(InputError, match="block 0 of 3 x 3 x 3 nodes is not in the plane"):
        layout_of(Grid((Block(solid),)))
