"""`solve-pde --coarse` and `--refine`: fewer nodes first, the same boundary after."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids


@pytest.mark.parametrize(
    ("method", "res", "coarse"), [("variational", "260x40", 129), ("auto", "513x30", 257)]
)
def test_large_quads_are_solved_on_fewer_nodes_unless_told(
    meshonet: Meshonet, duct_h5: Path, method: str, res: str, coarse: int
) -> None:
    words = ("solve-pde", duct_h5, "--method", method, "--res", res, "--json")
    nj = int(res.split("x")[1])
    for k, more in enumerate(
        (("--coarse", "auto"), ("--coarse", "off"), ("--coarse", "0"), ("--max-cycles", "20"))
    ):
        meshonet(*words, *more, "-o", f"{k}.vts")
    results = [next(read_grids(f"{k}.vts")).provenance.get("coarse") for k in range(4)]
    assert [None if one is None else list(one) for one in results] == [[coarse, nj], None, None, None]


def test_a_coarse_solve_is_evaluated_at_the_resolution(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("solve-pde", duct_h5, "--res", "80x60", "-o", "full.vts")
    report = meshonet("solve-pde", duct_h5, "--res", "80x60", "--coarse", "33", "-o", "g.vts", "--json").only
    assert (report["ni"], report["nj"], report["folded"], report["method"]) == (80, 60, 0, "winslow")
    (full,), (grid,) = read_grids("full.vts"), read_grids("g.vts")
    assert np.array_equal(grid.nodes[:, 0], full.nodes[:, 0])
    distance = np.abs(grid.nodes - full.nodes).max() / np.ptp(full.nodes[..., 0])
    assert 0 < distance < 2e-3


def test_refine_makes_the_finest_grid_of_a_family(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("solve-pde", duct_h5, "--refine", "2", "--tol", "1e-9", "-o", "finest.vts")
    assert done.code == 0
    assert "refined: 21x11 in " in done.err
    (finest,) = read_grids("finest.vts")
    assert (finest.ni, finest.nj) == (81, 41)
    meshonet("solve-pde", duct_h5, "--res", "81x41", "--tol", "1e-9", "-o", "alone.vts")
    (alone,) = read_grids("alone.vts")
    np.testing.assert_allclose(finest.nodes, alone.nodes, atol=1e-7)
    meshonet("convert", "finest.vts", "coarsest.vts", "--coarsen", "4")
    (coarsest,) = read_grids("coarsest.vts")
    np.testing.assert_array_equal(coarsest.nodes, finest.nodes[::4, ::4])


@pytest.mark.parametrize("topology", ["o", "c"])
def test_refine_keeps_the_ends_of_wall_and_wake(meshonet: Meshonet, topology: str) -> None:
    words = ("solve-pde", "naca:2412", "--topology", topology, "--res", "61x17", "--refine", "1")
    assert meshonet(*words, "-o", "f.vts").code == 0
    assert meshonet("convert", "f.vts", "g.vts", "--coarsen", "2").code == 0
    (grid,) = read_grids("g.vts")
    assert (grid.ni, grid.nj, grid.topology) == (61, 17, topology)


def test_refine_goes_with_a_first_grid(meshonet: Meshonet, body_h5: Path) -> None:
    meshonet("solve-pde", body_h5, "-o", "start.vts")
    assert meshonet("solve-pde", body_h5, "--refine", "1", "-o", "g.vts", "--initial", "start.vts").code == 0


@pytest.mark.parametrize(("name", "topology"), [("0012", "o"), ("0012", "c"), ("0012-sharp", "c")])
def test_refine_goes_with_first_cells_which_are_those_of_the_finest_grid(
    meshonet: Meshonet, name: str, topology: str
) -> None:
    words = ("infer", f"naca:{name}", "--topology", topology, "--first-cell", "1e-4", "--refine", "2")
    assert meshonet(*words, "--growth", "1.2", "-o", "fine.cgns").code == 0
    assert meshonet("quality", "fine.cgns", "--fail-on", "wall_growth>1.2").code == 0
    (grid,) = read_grids("fine.cgns")
    (wall,) = (patch for patch in grid.patches if patch.name == "wall" and patch.block == 0)
    rows = grid.blocks[0].nodes[wall.start : wall.stop + 1, :2]
    np.testing.assert_allclose(np.linalg.norm(np.diff(rows, axis=1), axis=-1), 1e-4, rtol=1e-6)
    assert meshonet("convert", "fine.cgns", "coarse.cgns", "--coarsen", "4").code == 0


def test_too_few_rows_to_be_refined_are_refused_with_a_number_that_suffices(meshonet: Meshonet) -> None:
    words = (
        "infer",
        "naca:0012",
        "--topology",
        "o",
        "--first-cell",
        "1e-5",
        "--growth",
        "1.2",
        "--refine",
        "2",
    )
    done = meshonet(*words, "--res", "65x9", "-o", "g.vts")
    assert done.code == 2
    rows = re.search(r"use (\d+) rows or more before --refine", done.err)
    assert rows is not None
    assert meshonet(*words, "--res", f"65x{rows[1]}", "-o", "g.vts").code == 0


def test_corners_of_a_base_are_those_of_all_grids_of_a_family(meshonet: Meshonet) -> None:
    words = ("infer", "naca:0012", "--topology", "o", "--res", "65x33", "--refine", "2", "-o", "fine.vts")
    assert meshonet(*words).code == 0
    assert meshonet("convert", "fine.vts", "coarse.vts", "--coarsen", "4").code == 0
    for name in ("fine.vts", "coarse.vts"):
        (grid,) = read_grids(name)
        x = grid.nodes[:, 0, 0]
        base = grid.nodes[x > x.max() - 1e-9, 0]
        assert np.ptp(base[:, 1]) == pytest.approx(0.00252, abs=1e-12)


def test_a_corner_that_would_be_cut_is_named(meshonet: Meshonet) -> None:
    meshonet("infer", "naca:0012", "--res", "65x33", "--base-nodes", "5", "-o", "fine.vts")
    done = meshonet("convert", "fine.vts", "coarse.vts", "--coarsen", "4")
    assert done.code == 2
    assert (
        "node 2, would be cut: every 4-th drops it; 1 more; the largest number that keeps all corners is 2"
        in done.err
    )
