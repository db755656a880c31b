"""Coarser copies of blocks in space, and what is carried back from them."""

import numpy as np
import pytest
from joined_volumes import bend, joined, perturbed, shell

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.volume.hex_mesh import HexMesh, hex_mesh_of
from meshonet.solvers.energy.hexes import optimise
from meshonet.solvers.smoothing.volume_levels import carried, coarser
from meshonet.solvers.smoothing.volume_spacing import wanted_edges
from meshonet.solvers.smoothing.volumes import smooth_volumes


def partly_joined() -> Grid:
    """Two blocks of which one side is joined to a part of the other."""
    large = np.stack(np.meshgrid(*(0.1 * np.arange(n) for n in (17, 40, 17)), indexing="ij"), axis=-1)
    small = large[:, 3:18] + (1.6, 0.0, 0.0)
    joint = Connection(0, "east", ((3, 17), (0, 16)), 1, "west", ((0, 14), (0, 16)), (1, 2))
    return Grid((Block(large), Block(small)), (), (joint,))


def turned() -> Grid:
    """Two blocks that count the lines across their interface from different ends, an odd number of cells."""
    nodes = np.stack(np.meshgrid(*(np.linspace(0, 1, n) for n in (41, 28, 17)), indexing="ij"), axis=-1)
    return joined([nodes[:21], nodes[20:, ::-1, ::-1]])


@pytest.mark.parametrize(
    "make", [partly_joined, turned, lambda: shell(n=17, layers=20), lambda: bend(15, 15, 31)]
)
def test_blocks_of_a_copy_share_the_nodes_that_they_shared(make) -> None:
    mesh = hex_mesh_of(make())
    copy = coarser(mesh)
    assert copy is not None
    assert len(copy.mesh.nodes) < 0.4 * len(mesh.nodes)
    np.testing.assert_array_equal(copy.mesh.nodes, mesh.nodes[copy.nodes])
    np.testing.assert_array_equal(copy.mesh.outer, mesh.outer[copy.nodes])
    for each in copy.mesh.connections:
        own, donor = each.pairs(copy.mesh.blocks)
        np.testing.assert_array_equal(own, donor)


def test_few_nodes_have_no_copy() -> None:
    assert coarser(hex_mesh_of(shell())) is None


@pytest.mark.parametrize("make", [partly_joined, turned])
def test_linear_maps_are_carried_back_exactly(make) -> None:
    mesh = hex_mesh_of(make())
    stretched = mesh.with_nodes(np.sinh(2.0 * mesh.nodes))
    copy = coarser(stretched)
    assert copy is not None
    targets = wanted_edges(stretched, ~mesh.outer, rounds=0)
    back = carried(stretched, copy, copy.mesh.nodes, targets)
    np.testing.assert_allclose(back, stretched.nodes, rtol=0, atol=1e-12)
    np.testing.assert_array_equal(back[copy.nodes], copy.mesh.nodes)


def waved(mesh: HexMesh, size: float) -> HexMesh:
    """Nodes inside moved along a long wave."""
    nodes = mesh.nodes.copy()
    inner = ~mesh.outer
    nodes[inner] += size * np.sin(4.0 * nodes[inner][:, [1, 2, 0]])
    return mesh.with_nodes(nodes)


def test_long_waves_go_by_a_coarser_copy() -> None:
    grid = shell(n=25, layers=24, first=0.05, growth=1.05)
    mesh = waved(hex_mesh_of(grid), 0.05)
    moves = ~mesh.outer
    spoilt = Grid(tuple(Block(mesh.nodes[block]) for block in mesh.blocks), grid.patches, grid.connections)
    alone = optimise(mesh, moves, wanted_edges(mesh, moves), iterations=20)
    together = smooth_volumes(spoilt, iterations=20).grid
    blocks = tuple(Block(alone.nodes[block]) for block in mesh.blocks)
    one_level = measure(Grid(blocks, grid.patches, grid.connections))
    assert measure(together)["deviation"].mean < 0.9 * one_level["deviation"].mean
    assert measure(together).folded == 0


def test_many_folds_are_unfolded_from_a_copy() -> None:
    spoilt = perturbed(shell(n=17, layers=20), 0.9)
    assert measure(spoilt).folded > 1000
    assert measure(smooth_volumes(spoilt).grid).folded == 0
