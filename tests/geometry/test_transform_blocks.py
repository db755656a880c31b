"""Grids of many blocks made coarser, moved to unit size and turned keep their connections and patches."""

from __future__ import annotations

import numpy as np
import pytest
from block_grids import butterfly, duct, o_ring, turned
from test_layout_from_grid import periodic_duct

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import coarser_grid, normalised
from meshonet.geometry.blocks.transform import turned as turned_grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import measure

GRIDS = [butterfly(), o_ring(m=7), duct(1), duct(3, bend=0.2), periodic_duct()]


@pytest.mark.parametrize("grid", GRIDS)
def test_every_second_node_is_left_and_names_and_connections_stay(grid: Grid) -> None:
    coarse = coarser_grid(grid, 2)
    for block, before in zip(coarse.blocks, grid.blocks, strict=True):
        np.testing.assert_array_equal(block.nodes, before.nodes[::2, ::2])
    assert [p.name for p in coarse.patches] == [p.name for p in grid.patches]
    assert len(coarse.connections) == len(grid.connections)
    assert coarse.provenance["coarsened"] == 2
    sums = [sum(p.stop - p.start for p in each.outer_patches()) for each in (coarse, grid)]
    assert 2 * sums[0] == sums[1]


def test_a_block_that_does_not_divide_is_named() -> None:
    low, high = (block.nodes for block in duct(0, ni=9, nj=5).blocks)
    with pytest.raises(InputError, match="block 1: 9x4 nodes are 8x3 cells, which 2 does not divide"):
        coarser_grid(Grid((Block(low), Block(high[:, :4]))), 2)


def test_a_connection_that_would_lose_an_end_is_named() -> None:
    x, y = np.meshgrid(np.arange(9.0), np.arange(5.0), indexing="ij")
    low, high = np.stack([x, y], axis=-1), np.stack([x + 3, y + 4], axis=-1)
    joint = Connection(0, "north", ((3, 8),), 1, "south", ((0, 5),), (1,))
    with pytest.raises(InputError, match="north of block 0 to south of block 1 runs from node 3 to 8, which"):
        coarser_grid(Grid((Block(low), Block(high)), (), (joint,)), 2)


@pytest.mark.parametrize("grid", GRIDS)
def test_a_turn_keeps_cells_names_and_connections(grid: Grid) -> None:
    round_ = turned_grid(grid)
    for block, before in zip(round_.blocks, grid.blocks, strict=True):
        np.testing.assert_array_equal(block.nodes, turned(before.nodes, 1))
    ends = [
        sorted((p.name, *sorted(map(tuple, each.face(p.block, p.side)[[p.start, p.stop]].tolist())))
               for p in each.outer_patches())
        for each in (round_, grid)
    ]  # fmt: skip
    assert ends[0] == ends[1]
    assert measure(round_)["max_angle"].max == pytest.approx(measure(grid)["max_angle"].max)


@pytest.mark.parametrize("grid", GRIDS)
def test_unit_size_is_that_of_the_box_around_all_blocks(grid: Grid) -> None:
    unit = normalised(grid)
    nodes = np.concatenate([block.nodes.reshape(-1, 2) for block in unit.blocks])
    assert nodes.min(axis=0) == pytest.approx((0, 0), abs=1e-15)
    assert np.ptp(nodes, axis=0).max() == pytest.approx(1.0)
    angles = [measure(each)["max_angle"].mean for each in (unit, grid)]
    assert angles[0] == pytest.approx(angles[1])


def test_a_period_is_scaled_along() -> None:
    unit = normalised(periodic_duct())
    moves = {each.transform.shift for each in unit.connections if each.transform}
    assert moves == {(0.0, 0.25)}
