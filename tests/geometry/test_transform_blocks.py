"""Grids of many blocks made coarser, moved to unit size and turned keep their connections and patches."""

import re
from pathlib import Path

import meshio
import numpy as np
import pytest
from block_grids import butterfly, duct, o_ring, turned
from test_layout_from_grid import periodic_duct

import meshonet
from meshonet.formats.registry import format_named, read_grids
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import coarser_grid, normalised, scaled
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


@pytest.mark.parametrize("grid", GRIDS)
def test_all_lengths_are_multiplied(grid: Grid) -> None:
    made = grid.with_provenance(wall_spacing=3.0, spacing_south=2.0, method="tfi", cells=7)
    smaller = scaled(scaled(made, 0.1), 0.01)
    for block, before in zip(smaller.blocks, grid.blocks, strict=True):
        np.testing.assert_allclose(block.nodes, 1e-3 * before.nodes, rtol=1e-14)
    for each, before in zip(smaller.connections, grid.connections, strict=True):
        assert (each.transform is None) == (before.transform is None)
        if each.transform and before.transform:
            assert each.transform.shift == pytest.approx([1e-3 * x for x in before.transform.shift])
            assert each.transform.turn == before.transform.turn
    facts = smaller.provenance
    lengths = [facts[name] for name in ("wall_spacing", "spacing_south", "scaled")]
    assert lengths == pytest.approx([3e-3, 2e-3, 1e-3])
    assert (facts["method"], facts["cells"]) == ("tfi", 7)


@pytest.mark.parametrize("factor", [0.0, -1.0, float("nan"), float("inf"), 1e13])
def test_a_factor_that_is_no_unit_is_refused(factor: float) -> None:
    with pytest.raises(InputError, match=r"scale: a factor of .*; give the new unit in old ones"):
        scaled(duct(1), factor)


@pytest.mark.parametrize("name", ["hdf5", "vtm", "cgns", "plot3d", "vtk", "vts"])
def test_a_converted_file_has_its_lengths_in_the_new_unit(name: str, tmp_path: Path) -> None:
    grid = duct(1) if name in ("vtk", "vts") else periodic_duct()
    if name in ("vtk", "vts"):
        grid = Grid(grid.blocks[:1])
    end = format_named(name).suffixes[0]
    metres, back = tmp_path / f"metres{end}", tmp_path / f"back{end}"
    grid.write(tmp_path / f"mm{end}")
    meshonet.convert(tmp_path / f"mm{end}", metres, scale=1e-3)
    meshonet.convert(metres, back, scale=1e3)
    given, small, again = (next(read_grids(str(path))) for path in (tmp_path / f"mm{end}", metres, back))
    for large, little, same in zip(given.blocks, small.blocks, again.blocks, strict=True):
        np.testing.assert_allclose(little.nodes, 1e-3 * large.nodes, rtol=1e-14)
        np.testing.assert_allclose(same.nodes, large.nodes, rtol=1e-14)
    periods = [[each.transform for each in one.connections if each.transform] for one in (given, small)]
    for motion, other in zip(*periods, strict=True):
        np.testing.assert_allclose(other.shift, 1e-3 * np.array(motion.shift), rtol=1e-12)


@pytest.mark.parametrize("name", ["vtu", "gmsh", "su2", "openfoam"])
def test_solvers_get_the_new_unit(name: str, tmp_path: Path) -> None:
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0), indexing="ij")
    Grid((Block(np.stack([7.0 * x, 8.0 * y], axis=-1)),)).write(tmp_path / "mm.vts")
    path = tmp_path / "case" / f"a{format_named(name).suffixes[0]}"
    path.parent.mkdir()
    meshonet.convert(tmp_path / "mm.vts", path, scale=1e-3, extrude=5e-4)
    if name == "openfoam":
        rows = re.findall(r"^\((.*)\)$", (path.parent / "constant/polyMesh/points").read_text(), re.MULTILINE)
        points = np.array([row.split() for row in rows], dtype=float)
    else:
        points = meshio.read(path).points
    assert np.ptp(points, axis=0) == pytest.approx([0.021, 0.016, 5e-4])
