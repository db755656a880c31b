"""`meshonet solve-pde`."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, dataset, duct, wave

from meshonet.formats.registry import read_grids, read_shapes
from meshonet.solvers.elliptic.multigrid import Multigrid
from meshonet.solvers.elliptic.solve import solve


def test_the_grid_solves_the_equations(meshonet: Meshonet, body_h5: Path) -> None:
    report = meshonet("solve-pde", body_h5, "-o", "grid.vts", "--tol", "1e-10", "--json").only
    assert report["method"] == "winslow"
    assert report["residual"] <= 1e-10
    assert report["cycles"] >= 1
    assert report["folded"] == 0
    residuals = []
    for path in ("grid.vts", str(_interpolated(meshonet, body_h5))):
        nodes = next(read_grids(path)).nodes
        residuals.append(Multigrid(nodes, (nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1]), True).residual())
    assert residuals[0] < 1e-9 * residuals[1]


def _interpolated(meshonet: Meshonet, source: Path) -> Path:
    meshonet("tfi", source, "-o", "start.vts")
    return Path("start.vts")


def test_the_report_says_residual_and_cycles(meshonet: Meshonet, duct_h5: Path) -> None:
    report = meshonet("solve-pde", duct_h5, "-o", "grid.vts").err
    assert "method     winslow" in report
    assert "cycles" in report


def test_a_grid_that_needs_no_cycle_says_so(meshonet: Meshonet) -> None:
    Path("square.csv").write_text("0 0\n1 0\n\n1 0\n1 1\n\n1 1\n0 1\n\n0 1\n0 0\n")
    done = meshonet("solve-pde", "square.csv", "--method", "winslow", "--res", "9x9", "-o", "grid.vts")
    assert "in the initial grid: no cycles needed" in done.err


def test_the_method_can_be_named(meshonet: Meshonet, duct_h5: Path) -> None:
    assert meshonet("solve-pde", duct_h5, "--method", "winslow", "-o", "g.vts").code == 0
    done = meshonet("solve-pde", duct_h5, "--method", "magic", "-o", "g.vts")
    assert done.code == 2
    assert "magic" in done.err


def test_thomas_middlecoff_keeps_the_spacing_of_the_sides(meshonet: Meshonet, tmp_path: Path) -> None:
    edges = duct(21, 33)
    for side in ("west", "east"):
        edges[side][:, 1] **= 3
    source = dataset(tmp_path / "layers.h5", "quad", edges)
    report = meshonet("solve-pde", source, "--method", "thomas-middlecoff", "-o", "g.vts", "--json").only
    assert (report["method"], report["folded"]) == ("thomas-middlecoff", 0)
    (grid,) = read_grids("g.vts")
    first = np.diff(grid.y, axis=1)[:, 0]
    meshonet("solve-pde", source, "-o", "plain.vts")
    (plain,) = read_grids("plain.vts")
    assert first.max() < 0.2 * np.diff(plain.y, axis=1)[:, 0].max()
    report = meshonet(
        "solve-pde", source, "--method", "thomas-middlecoff", "--coarse", "17", "-o", "c.vts", "--json"
    ).only
    (coarse,) = read_grids("c.vts")
    assert report["folded"] == 0
    np.testing.assert_allclose(coarse.nodes, grid.nodes, atol=5e-3)


def test_a_march_needs_a_first_cell_and_takes_no_elliptic_options(meshonet: Meshonet, body_h5: Path) -> None:
    given = ("--wall-spacing", "1e-3", "--res", "41x60")
    assert meshonet("solve-pde", body_h5, "--method", "hyperbolic", *given, "-o", "g.vts").code == 0
    cases = {
        (
            "--method",
            "hyperbolic",
        ): "--method hyperbolic without a first cell; give --first-cell or --y-plus",
        ("--tol", "1e-6", *given): "--tol is of no use to a grid marched from the wall; drop --tol",
        ("--coarse", "33", *given): "--coarse is of no use to a grid marched from the wall",
    }
    for words, report in cases.items():
        done = meshonet("solve-pde", body_h5, *words, "-o", "none.vts")
        assert done.code == 2
        assert report in done.err
        assert not Path("none.vts").exists()


def test_where_interpolation_folds_it_does_not(meshonet: Meshonet, folding_h5: Path) -> None:
    done = meshonet("solve-pde", folding_h5, "-o", "grid.vts")
    assert done.code == 0
    (grid,) = read_grids("grid.vts")
    np.testing.assert_array_equal(grid.nodes[:, 0], wave()["south"])


def test_max_cycles_stops_it(meshonet: Meshonet, duct_h5: Path) -> None:
    report = meshonet(
        "solve-pde", duct_h5, "-o", "g.vts", "--tol", "1e-14", "--max-cycles", "1", "--json"
    ).only
    assert report["cycles"] == 1
    assert report["residual"] > 1e-14


def test_initial_starts_from_a_grid(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("solve-pde", duct_h5, "-o", "first.vts", "--tol", "1e-9")
    report = meshonet(
        "solve-pde", duct_h5, "-o", "g.vts", "--initial", "first.vts", "--tol", "1e-8", "--json"
    ).only
    assert report["cycles"] == 0


def test_variational_angles_are_better(meshonet: Meshonet, duct_h5: Path) -> None:
    words = ("solve-pde", duct_h5, "--res", "65x33", "--json", "-o", "g.vts")
    winslow = meshonet(*words, "--method", "winslow").only
    for more in ((), ("--coarse", "33")):
        report = meshonet(*words, "--method", "variational", *more).only
        assert report["method"] == "variational"
        assert report["folded"] == 0
        assert report["quality"]["max_angle"]["mean"] < winslow["quality"]["max_angle"]["mean"]


@pytest.mark.parametrize("topology", ["o", "c"])
def test_variational_around_a_body(meshonet: Meshonet, topology: str) -> None:
    words = ("solve-pde", "naca:2412", "--topology", topology, "--res", "100x40", "--method", "variational")
    report = meshonet(*words, "--json", "-o", "g.vts").only
    assert (report["method"], report["topology"], report["folded"], report["path"]) == (
        "variational",
        topology,
        0,
        [],
    )
    assert report["quality"]["max_angle"]["mean"] < 93


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--history", "cycles.txt"),
            "no CSV file; name it FILE.csv",
        ),
        (("--refine", "9"), "'--refine': 9 is not in the range 0<=x<=8"),
        (
            ("--refine", "1", "--coarse", "9"),
            "--coarse and --refine both solve on fewer nodes first; give one",
        ),
        (("--tol", "2"), "--tol: 2 is not between 0 and 1; use e.g. 1e-8"),
        (("--tol", "x"), "tol"),
        (("--max-cycles", "0"), "max-cycles"),
        (("--coarse", "8"), "--coarse: '8' is not a number of nodes from 9 on; use auto, off or e.g. 65"),
        (("--coarse", "x"), "--coarse: 'x' is not a number of nodes from 9 on; use auto, off or e.g. 65"),
        (("--coarse", "9", "--initial", "start.vts"), "drop --initial or --coarse"),
        (("--initial", "missing.vts"), "missing.vts: no such file"),
        (("--initial", "duct.h5"), "duct.h5: holds boundaries, not grids"),
        (("--res", "33", "--initial", "start.vts"), "the initial grid has 21x11 nodes, not 33x33"),
    ],
)
def test_mistakes_get_a_line(meshonet: Meshonet, duct_h5: Path, words: tuple[str, ...], message: str) -> None:
    _interpolated(meshonet, duct_h5)
    done = meshonet("solve-pde", "duct.h5", "-o", "g.vts", *words)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


def test_a_wider_repair_moves_more(meshonet: Meshonet, tmp_path: Path) -> None:
    words = ("--family", "wrench", "--count", "1", "--range", "0.3:0.3", "--res", "41", "--quiet")
    assert meshonet("sample-boundary", *words, "-o", "wrench.h5").code == 0
    reports = [
        meshonet("solve-pde", "wrench.h5", *more, "-o", f"g{k}.vts", "--json").only
        for k, more in enumerate([(), ("--repair-margin", "6"), ("--repair-margin", "12")])
    ]
    assert [one["folded"] for one in reports] == [0, 0, 0]
    assert all(one["path"] == ["repair"] for one in reports)
    own, six, twelve = (next(read_grids(f"g{k}.vts")).nodes for k in range(3))
    np.testing.assert_array_equal(own, six)
    assert np.abs(twelve - own).max() > 1e-3
    done = meshonet("solve-pde", "wrench.h5", "--repair-margin", "1", "-o", "no.vts")
    assert done.code == 2
    assert "repair-margin" in done.err
    assert not Path("no.vts").exists()


def test_without_repair_the_grid_is_what_the_equations_have(meshonet: Meshonet, tmp_path: Path) -> None:
    words = ("--family", "wrench", "--count", "1", "--range", "0.3:0.3", "--res", "41", "--quiet")
    assert meshonet("sample-boundary", *words, "-o", "wrench.h5").code == 0
    done = meshonet("solve-pde", "wrench.h5", "--no-repair", "--tol", "1e-6", "-o", "no.vts")
    assert done.code == 3
    assert "folded" in done.err
    assert not Path("no.vts").exists()
    words = ("--no-repair", "--allow-invalid", "--tol", "1e-6", "--json")
    report = meshonet("solve-pde", "wrench.h5", *words, "-o", "bare.vts").only
    assert report["folded"] > 0
    assert report["path"] == []
    repaired = meshonet("solve-pde", "wrench.h5", "--repair", *words[1:], "-o", "whole.vts").only
    assert (repaired["folded"], repaired["path"]) == (0, ["repair"])
    solved = solve(next(read_shapes("wrench.h5")), tol=1e-6).grid.nodes
    np.testing.assert_array_equal(next(read_grids("bare.vts")).nodes, solved)


@pytest.mark.parametrize("res", ["100x50", "270x60"])
def test_lines_of_c_grids_do_not_lean_along_the_wake_unless_winslow_is_asked_for(
    meshonet: Meshonet, res: str
) -> None:
    words = ("solve-pde", "naca:2412", "--topology", "c", "--res", res, "--json", "-o", "g.vts")
    ways = (), ("--method", "variational"), ("--method", "winslow"), ("--tol", "1e-6")
    report, minimised, winslow, stopped = (meshonet(*words, *more).only for more in ways)
    methods = [one["method"] for one in (report, minimised, winslow, stopped)]
    assert methods == ["hyperbolic", "variational", "winslow", "winslow"]
    assert report["folded"] == minimised["folded"] == 0
    assert report["quality"]["max_angle"]["max"] < 115
    assert minimised["quality"]["max_angle"]["max"] < 140 < 155 < winslow["quality"]["max_angle"]["max"]
    for one in report, minimised:
        assert one["quality"]["max_angle"]["mean"] < winslow["quality"]["max_angle"]["mean"] - 5
