"""Commands on volumes and surfaces: `quality`, `convert` and `plot` from the command line."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.quality.metrics import METRICS, SOLID_METRICS
from meshonet.geometry.quality.profiles import PROFILES

NAMES = [metric.name for metric in (*SOLID_METRICS, *METRICS)]


@pytest.fixture
def duct_vtm(tmp_path: Path) -> Path:
    """Two blocks 5 x 5 x 5, volumes of their cells 8 : 1, walls below; a node in the second is moved."""
    nodes = [
        np.stack(np.meshgrid(x, np.linspace(0, 1, 5), np.linspace(0, 1, 5), indexing="ij"), axis=-1)
        for x in (np.linspace(0, 8, 5), np.linspace(8, 9, 5))
    ]
    nodes[1][2, 2, 2] += [0.1, 0, 0]
    blocks = tuple(Block(each) for each in nodes)
    walls = tuple(Patch("wall", "bottom", 0, 4, block=k) for k in (0, 1))
    Grid(blocks, walls, find_connections(blocks), "duct").write("duct.vtm")
    return Path("duct.vtm")


def test_a_volume_is_measured_by_both_tests_and_at_its_walls(meshonet: Meshonet, duct_vtm: Path) -> None:
    done = meshonet("quality", duct_vtm)
    assert done.code == 0
    head, *lines = done.out.splitlines()
    assert head == (
        "duct.vtm: 2 blocks, 225 nodes, 1 interface, 128 cells, "
        "none folded at corners, none by the Bezier test"
    )
    rows = {line.split()[0]: line for line in lines}
    assert set(NAMES) <= set(rows)
    assert rows["volume_ratio"].split()[5:10] == ["8", "0,", "3,", "0,", "0"]
    assert "wall: first cell" in done.out
    facts = meshonet("quality", duct_vtm, "--json").only
    assert (facts["form"], facts["folded"], facts["bezier_folded"]) == ("volume", 0, 0)
    (wall,) = facts["walls"]
    assert wall["first_cell"]["mean"] == pytest.approx(0.25)
    assert wall["growth"]["max"] == pytest.approx(1, rel=0.1)
    assert facts["lines"]["growth_across"]["max"] == pytest.approx(8)


def test_gates_look_at_metrics_of_volumes(meshonet: Meshonet, duct_vtm: Path) -> None:
    for gate, code in (
        ("volume_ratio>7", 1),
        ("volume_ratio>9", 0),
        ("bezier_folded>0", 0),
        ("growth_across>7", 1),
    ):
        assert meshonet("quality", duct_vtm, "--fail-on", gate).code == code, gate
    done = meshonet("quality", duct_vtm, "--fail-on", "area_ratio>2")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert "--fail-on: this grid has no area_ratio; use folded" in done.err
    done = meshonet("quality", duct_vtm, "--fail-on", "irregular>2")
    assert "this grid has no irregular; use folded" in done.err


def test_cells_are_written_with_their_metrics(meshonet: Meshonet, duct_vtm: Path) -> None:
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    assert meshonet("quality", duct_vtm, "--per-cell", "cells.vtm").code == 0
    reader = vtk.vtkXMLStructuredGridReader()
    reader.SetFileName(str(sorted(Path("cells_blocks").glob("*.vts"))[1]))
    reader.Update()
    cells = reader.GetOutput().GetCellData()
    (grid,) = read_grids(str(duct_vtm))
    for name in NAMES:
        values = per_cell_of_blocks(grid, name)[1]
        np.testing.assert_array_equal(vtk_to_numpy(cells.GetArray(name)), values.T.ravel(), err_msg=name)


def test_a_volume_is_compared_with_another(meshonet: Meshonet, duct_vtm: Path) -> None:
    (grid,) = read_grids(str(duct_vtm))
    blocks = [Block(block.nodes) for block in grid.blocks]
    blocks[1].nodes[2, 2, 2, 2] += 0.05
    Grid(tuple(blocks), grid.patches, grid.connections).write("other.vtm")
    facts = meshonet("quality", duct_vtm, "--compare", "other.vtm", "--json").only["compare"]
    assert facts["at"] == [1, 2, 2, 2]
    assert facts["max"] == pytest.approx(0.05)
    assert facts["boundary"] == 0
    assert "block=1, i=2, j=2, k=2" in meshonet("quality", duct_vtm, "--compare", "other.vtm").out


@pytest.mark.parametrize("profile", PROFILES)
def test_profiles_judge_volumes(meshonet: Meshonet, duct_vtm: Path, profile: str) -> None:
    done = meshonet("quality", duct_vtm, "--profile", profile)
    assert done.code in (0, 1)
    assert f"profile {profile}" in done.out
    assert "along zeta" in done.out


def test_a_volume_is_coarsened_and_brought_to_unit_size(meshonet: Meshonet, duct_vtm: Path) -> None:
    assert meshonet("convert", duct_vtm, "coarse.vtm", "--coarsen", "2", "--normalise").code == 0
    (grid,), (coarse,) = read_grids(str(duct_vtm)), read_grids("coarse.vtm")
    assert [block.counts for block in coarse.blocks] == [(3, 3, 3)] * 2
    np.testing.assert_allclose(coarse.blocks[1].nodes * 9, grid.blocks[1].nodes[::2, ::2, ::2])
    assert len(coarse.connections) == 1
    assert [patch.name for patch in coarse.walls()] == ["wall", "wall"]
    done = meshonet("convert", duct_vtm, "odd.vtm", "--coarsen", "3")
    assert (
        "block 0: 5x5x5 nodes are 4x4x4 cells, which 3 does not divide; use a number that divides 4"
        in done.err
    )
    done = meshonet("deform", duct_vtm, "--rotate", "wall=5@0,0", "-o", "odd.vtm")
    assert "--rotate: the motion of 'wall' is not in the space of the grid; translate it by 3" in done.err
    done = meshonet("convert", duct_vtm, "odd.vtm", "--swap")
    assert "a volume has three directions to swap; swap grids of two directions only" in done.err


@pytest.mark.parametrize("words", [(), ("--slice", "k=0"), ("--slice", "x=1.1"), ("--seen-from", "10,80")])
def test_a_volume_becomes_a_picture(meshonet: Meshonet, duct_vtm: Path, words: tuple[str, ...]) -> None:
    done = meshonet("plot", duct_vtm, "-o", "made.png", *words)
    assert done.code == 0
    assert "2 blocks, 128 cells" in done.err
    assert Path("made.png").read_bytes().startswith(b"\x89PNG")
