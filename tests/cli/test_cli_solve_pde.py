"""`meshonet solve-pde`."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, dataset, duct, wave

from formats.registry import read_grids
from solvers.elliptic.winslow import residual


def test_the_grid_solves_the_equations(meshonet: Meshonet, body_h5: Path) -> None:
    told = meshonet("solve-pde", body_h5, "-o", "grid.vts", "--tol", "1e-10", "--json").only
    assert told["method"] == "winslow"
    assert told["residual"] <= 1e-10
    assert told["cycles"] >= 1
    assert told["folded"] == 0
    (grid,) = read_grids("grid.vts")
    (start,) = read_grids(str(_interpolated(meshonet, body_h5)))
    assert np.abs(residual(grid.nodes)).max() < 1e-8 * np.abs(residual(start.nodes)).max()


def _interpolated(meshonet: Meshonet, source: Path) -> Path:
    meshonet("tfi", source, "-o", "start.vts")
    return Path("start.vts")


def test_the_report_says_residual_and_cycles(meshonet: Meshonet, duct_h5: Path) -> None:
    told = meshonet("solve-pde", duct_h5, "-o", "grid.vts").err
    assert "method     winslow" in told
    assert "cycles" in told


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
    told = meshonet("solve-pde", source, "--method", "thomas-middlecoff", "-o", "g.vts", "--json").only
    assert (told["method"], told["folded"]) == ("thomas-middlecoff", 0)
    (grid,) = read_grids("g.vts")
    first = np.diff(grid.y, axis=1)[:, 0]
    meshonet("solve-pde", source, "-o", "plain.vts")
    (plain,) = read_grids("plain.vts")
    assert first.max() < 0.2 * np.diff(plain.y, axis=1)[:, 0].max()
    told = meshonet(
        "solve-pde", source, "--method", "thomas-middlecoff", "--coarse", "17", "-o", "c.vts", "--json"
    ).only
    (coarse,) = read_grids("c.vts")
    assert told["folded"] == 0
    np.testing.assert_allclose(coarse.nodes, grid.nodes, atol=5e-3)


HEIGHTS = {"south": 1e-4, "north": 2e-3, "west": 5e-3, "east": 1e-3}


@pytest.mark.parametrize("method", ["auto", "winslow", "variational", "thomas-middlecoff"])
def test_first_cells_off_any_side_are_as_high_as_asked(
    meshonet: Meshonet, duct_h5: Path, method: str
) -> None:
    words = [word for side, h in HEIGHTS.items() for word in (f"--spacing-{side}", h)]
    told = meshonet(
        "solve-pde", duct_h5, "--res", "65x65", "--method", method, *words, "-o", "g.h5", "--json"
    ).only
    assert told["folded"] == 0
    (grid,) = read_grids("g.h5")
    for side, height in HEIGHTS.items():
        rows = grid.nodes if side in ("west", "east") else np.swapaxes(grid.nodes, 0, 1)
        wall, next_to = (rows[0], rows[1]) if side in ("west", "south") else (rows[-1], rows[-2])
        np.testing.assert_allclose(np.linalg.norm(next_to - wall, axis=1), height, rtol=1e-8)
    assert "0.0001 off south, 0.001 off east, 0.002 off north, 0.005 off west" in told["notes"][-1]


def test_a_body_can_have_an_elliptic_grid_with_layers(meshonet: Meshonet, body_h5: Path) -> None:
    words = ("--method", "winslow", "--wall-spacing", "1e-4", "--res", "81x60")
    told = meshonet("solve-pde", body_h5, *words, "-o", "g.h5", "--json").only
    assert (told["method"], told["folded"]) == ("winslow", 0)
    (grid,) = read_grids("g.h5")
    first = np.linalg.norm(grid.nodes[:, 1] - grid.nodes[:, 0], axis=1)
    np.testing.assert_allclose(first, 1e-4 * grid.provenance["spacing_south"] / 1e-4, rtol=1e-8)
    assert first[0] == pytest.approx(1e-4 * np.linalg.norm(np.ptp(grid.nodes[:, 0, 0])), rel=1e-2)


def _roof_lean(nodes: np.ndarray, bump: float = 0.2) -> float:
    """Largest angle in degrees between first cells and the normal of the duct's floor, away from its ends."""
    x = nodes[3:-3, 0, 0]
    slope = -40 * (x - 1) * bump * np.exp(-20 * (x - 1) ** 2)
    out = nodes[3:-3, 1] - nodes[3:-3, 0]
    sine = (out[:, 0] + slope * out[:, 1]) / np.hypot(1, slope) / np.hypot(*out.T)
    return float(np.degrees(np.arcsin(np.abs(sine).max())))


def test_walls_of_channels_slide(meshonet: Meshonet, tmp_path: Path) -> None:
    """Nodes sampled here do; given ones when it is said."""
    source = dataset(tmp_path / "duct.h5", "quad", duct(201, 41))
    slid, kept = "wall nodes slid along south and north", ("--no-slide",)
    words = ("solve-pde", source, "--wall-spacing", "1e-5", "-o", "g.h5", "--json", "--res")
    leans = {}
    for name, more in {"own": ("181x61",), "kept": ("181x61", *kept), "given": ("201x41",)}.items():
        told = meshonet(*words, *more).only
        (grid,) = read_grids("g.h5")
        leans[name] = _roof_lean(grid.nodes)
        assert (slid in told["notes"]) == (name == "own")
        assert told["method"] == ("winslow" if name == "own" else "steger-sorenson")
        assert told["folded"] == 0
    assert leans["own"] < 1.0
    assert leans["kept"] < 1.0  # sources turn the lines instead
    told = meshonet(*words, "181x61", "--no-slide", "--method", "winslow").only
    (grid,) = read_grids("g.h5")
    assert _roof_lean(grid.nodes) > 10
    for method in ("winslow", "thomas-middlecoff", "variational"):
        told = meshonet(*words, "201x41", "--method", method, "--slide").only
        assert slid in told["notes"]
        assert told["folded"] == 0


@pytest.mark.parametrize("angle", [90, 75])
def test_steger_sorenson_turns_the_lines_at_walls(meshonet: Meshonet, tmp_path: Path, angle: int) -> None:
    source = dataset(tmp_path / "duct.h5", "quad", duct(121, 61, bump=0.0))
    words = ("--method", "steger-sorenson", "--wall-angle", angle, "--spacing-south", "1e-4")
    told = meshonet("solve-pde", source, *words, "-o", "g.h5", "--json").only
    assert (told["method"], told["folded"]) == ("steger-sorenson", 0)
    (grid,) = read_grids("g.h5")
    out = grid.nodes[:, 1] - grid.nodes[:, 0]
    np.testing.assert_allclose(np.hypot(*out.T), 1e-4, rtol=1e-8)
    np.testing.assert_allclose(np.degrees(np.arctan2(out[10:-10, 1], out[10:-10, 0])), angle, atol=1.0)
    assert any(f"lines leave south at {angle} degrees" in note for note in told["notes"])


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--wall-angle", "80"), "--wall-angle: method auto sets no angle; use --method steger-sorenson"),
        (("--method", "steger-sorenson", "--wall-angle", "10"), "an angle of 10 degrees at walls; use 30 to"),
        (("--method", "steger-sorenson", "--wall-angle", "nan"), "an angle of nan degrees at walls; use 30"),
        (("--method", "steger-sorenson", "--tol", "3"), "--tol: 3 is not between 0 and 1"),
        (("--method", "thomas-middlecoff", "--initial", "missing.vts"), "missing.vts: no such file"),
    ],
)
def test_angles_that_make_no_sense_get_a_line(
    meshonet: Meshonet, duct_h5: Path, words: tuple[str, ...], told: str
) -> None:
    done = meshonet("solve-pde", duct_h5, *words, "-o", "g.vts")
    assert done.code == 2
    assert told in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


def test_no_body_slides(meshonet: Meshonet, body_h5: Path) -> None:
    done = meshonet("solve-pde", body_h5, "--slide", "-o", "g.vts")
    assert done.code == 2
    assert "the wall of a o grid cannot slide; slide those of channels" in done.err
    assert not Path("g.vts").exists()


def test_growth_in_a_channel_takes_the_rows_it_needs(meshonet: Meshonet, tmp_path: Path) -> None:
    Path("channel.csv").write_text("0,0\n3,0\n3,1\n0,1\n")
    words = ("--topology", "quad", "--wall-spacing", "1e-3", "--growth", "1.2", "-o", "g.h5")
    told = meshonet("solve-pde", "channel.csv", *words, "--json").only
    (grid,) = read_grids("g.h5")
    steps = np.linalg.norm(np.diff(grid.nodes, axis=1), axis=-1)
    ratios = steps[:, 1:] / steps[:, :-1]
    assert np.maximum(ratios, 1 / ratios).max() < 1.2001
    assert 40 < told["nj"] < 60
    done = meshonet("solve-pde", "channel.csv", *words, "--res", "40x30")
    assert done.code == 2
    assert f"more than 1.2; use {told['nj']} or more" in done.err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--spacing-south", "0"), "--spacing-south: a first cell of 0; give a positive height"),
        (("--spacing-west", "-1"), "--spacing-west: a first cell of -1; give a positive height"),
        (("--spacing-north", "inf"), "--spacing-north: a first cell of inf; give a positive height"),
        (("--spacing-east", "x"), "spacing-east"),
        (("--spacing-south", "0.95"), "first cells of 0.95 fill west, which is 1 long; use smaller ones"),
        (
            ("--wall-spacing", "0.5"),
            "first cells of 0.5 and 0.5 fill west, which is 1 long; use smaller ones",
        ),
        (
            ("--spacing-south", "1e-3", "--refine", "2"),
            "--refine with first cells of given heights; use a fin",
        ),
        (("--spacing-south", "1e-12"), "cells that grow by"),
        (("--spacing-south", "1e-3", "--constant-layers", "10"), "11 nodes off south are too few for layers"),
        (
            ("--spacing-south", "1e-3", "--growth", "0.5"),
            "a growth of 0.5; give the ratio",
        ),
        (("--spacing-south", "1e-3", "--growth", "1.01", "--res", "21"), "more than 1.01; use"),
    ],
)
def test_heights_that_make_no_sense_get_a_line(
    meshonet: Meshonet, duct_h5: Path, words: tuple[str, ...], told: str
) -> None:
    done = meshonet("solve-pde", duct_h5, *words, "-o", "g.vts")
    assert done.code == 2
    assert told in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


def test_a_body_has_one_wall(meshonet: Meshonet, body_h5: Path) -> None:
    done = meshonet("solve-pde", body_h5, "--spacing-north", "1e-3", "-o", "g.vts")
    assert done.code == 2
    assert "--spacing-north: a height off a single side, around a body (topology o); use" in done.err
    assert not Path("g.vts").exists()


def test_a_march_needs_a_first_cell_and_takes_no_elliptic_options(meshonet: Meshonet, body_h5: Path) -> None:
    given = ("--wall-spacing", "1e-3", "--res", "41x60")
    assert meshonet("solve-pde", body_h5, "--method", "hyperbolic", *given, "-o", "g.vts").code == 0
    cases = {
        (
            "--method",
            "hyperbolic",
        ): "--method hyperbolic without a first cell; give --wall-spacing or --y-plus",
        ("--tol", "1e-6", *given): "--tol is of no use to a grid marched from the wall; drop --tol",
        ("--coarse", "33", *given): "--coarse is of no use to a grid marched from the wall",
    }
    for words, told in cases.items():
        done = meshonet("solve-pde", body_h5, *words, "-o", "none.vts")
        assert done.code == 2
        assert told in done.err
        assert not Path("none.vts").exists()


def test_where_interpolation_folds_it_does_not(meshonet: Meshonet, folding_h5: Path) -> None:
    done = meshonet("solve-pde", folding_h5, "-o", "grid.vts")
    assert done.code == 0
    (grid,) = read_grids("grid.vts")
    np.testing.assert_array_equal(grid.nodes[:, 0], wave()["south"])


def test_max_cycles_stops_it(meshonet: Meshonet, duct_h5: Path) -> None:
    told = meshonet("solve-pde", duct_h5, "-o", "g.vts", "--tol", "1e-14", "--max-cycles", "1", "--json").only
    assert told["cycles"] == 1
    assert told["residual"] > 1e-14


def test_initial_starts_from_a_grid(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("solve-pde", duct_h5, "-o", "first.vts", "--tol", "1e-9")
    told = meshonet(
        "solve-pde", duct_h5, "-o", "g.vts", "--initial", "first.vts", "--tol", "1e-8", "--json"
    ).only
    assert told["cycles"] == 0


def test_variational_angles_are_better(meshonet: Meshonet, duct_h5: Path) -> None:
    words = ("solve-pde", duct_h5, "--res", "65x33", "--json", "-o", "g.vts")
    winslow = meshonet(*words, "--method", "winslow").only
    for more in ((), ("--coarse", "33")):
        told = meshonet(*words, "--method", "variational", *more).only
        assert told["method"] == "variational"
        assert told["folded"] == 0
        assert told["quality"]["max_angle"]["mean"] < winslow["quality"]["max_angle"]["mean"]


@pytest.mark.parametrize("topology", ["o", "c"])
def test_variational_around_a_body(meshonet: Meshonet, topology: str) -> None:
    words = ("solve-pde", "naca:2412", "--topology", topology, "--res", "100x40", "--method", "variational")
    told = meshonet(*words, "--json", "-o", "g.vts").only
    assert (told["method"], told["topology"], told["folded"], told["path"]) == (
        "variational",
        topology,
        0,
        [],
    )
    assert told["quality"]["max_angle"]["mean"] < 93


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
    found = [next(read_grids(f"{k}.vts")).provenance.get("coarse") for k in range(4)]
    assert [None if one is None else list(one) for one in found] == [[coarse, nj], None, None, None]


def test_a_coarse_solve_is_evaluated_at_the_resolution(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("solve-pde", duct_h5, "--res", "80x60", "-o", "full.vts")
    told = meshonet("solve-pde", duct_h5, "--res", "80x60", "--coarse", "33", "-o", "g.vts", "--json").only
    assert (told["ni"], told["nj"], told["folded"], told["method"]) == (80, 60, 0, "winslow")
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


def test_refine_goes_with_a_first_grid_and_not_with_marching(meshonet: Meshonet, body_h5: Path) -> None:
    meshonet("solve-pde", body_h5, "-o", "start.vts")
    words = ("solve-pde", body_h5, "--refine", "1", "-o", "g.vts")
    assert meshonet(*words, "--initial", "start.vts").code == 0
    done = meshonet(*words, "--wall-spacing", "1e-3")
    assert done.code == 2
    assert "--refine is of no use to a grid marched from the wall; drop --refine" in done.err


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (
            ("--history", "cycles.txt"),
            "--history: cycles are written as a table of commas; name a file, F.csv",
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
def test_mistakes_get_a_line(meshonet: Meshonet, duct_h5: Path, words: tuple[str, ...], told: str) -> None:
    _interpolated(meshonet, duct_h5)
    done = meshonet("solve-pde", "duct.h5", "-o", "g.vts", *words)
    assert done.code == 2
    assert told in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


def test_a_wider_repair_moves_more(meshonet: Meshonet, tmp_path: Path) -> None:
    words = ("--family", "wrench", "--count", "1", "--range", "0.3:0.3", "--res", "41", "--quiet")
    assert meshonet("sample-boundary", *words, "-o", "wrench.h5").code == 0
    told = [
        meshonet("solve-pde", "wrench.h5", *more, "-o", f"g{k}.vts", "--json").only
        for k, more in enumerate([(), ("--repair-margin", "6"), ("--repair-margin", "12")])
    ]
    assert [one["folded"] for one in told] == [0, 0, 0]
    assert all(one["path"] == ["repair"] for one in told)
    own, six, twelve = (next(read_grids(f"g{k}.vts")).nodes for k in range(3))
    np.testing.assert_array_equal(own, six)
    assert np.abs(twelve - own).max() > 1e-3
    done = meshonet("solve-pde", "wrench.h5", "--repair-margin", "1", "-o", "no.vts")
    assert done.code == 2
    assert "repair-margin" in done.err
    assert not Path("no.vts").exists()


@pytest.mark.parametrize("res", ["100x50", "270x60"])
def test_lines_of_c_grids_do_not_lean_along_the_wake_unless_winslow_is_asked_for(
    meshonet: Meshonet, res: str
) -> None:
    words = ("solve-pde", "naca:2412", "--topology", "c", "--res", res, "--json", "-o", "g.vts")
    ways = (), ("--method", "variational"), ("--method", "winslow"), ("--tol", "1e-6")
    told, minimised, winslow, stopped = (meshonet(*words, *more).only for more in ways)
    methods = [one["method"] for one in (told, minimised, winslow, stopped)]
    assert methods == ["hyperbolic", "variational", "winslow", "winslow"]
    assert told["folded"] == minimised["folded"] == 0
    assert told["quality"]["max_angle"]["max"] < 115
    assert minimised["quality"]["max_angle"]["max"] < 140 < 155 < winslow["quality"]["max_angle"]["max"]
    for one in told, minimised:
        assert one["quality"]["max_angle"]["mean"] < winslow["quality"]["max_angle"]["mean"] - 5


@pytest.mark.parametrize("lean", [(-14.0, 14.0), (14.0, 14.0)])
def test_lines_leave_leaning_walls_of_a_channel_at_right_angles(
    meshonet: Meshonet, tmp_path: Path, lean: tuple[float, float]
) -> None:
    """But for the two ends, whose corners are not right ones."""
    south, north = np.tan(np.radians(lean))
    x = np.linspace(0.0, 3.0, 31)
    y = np.linspace(3.0 * south, 1.0 + 3.0 * north, 13)[1:-1]
    sides = [
        (x, south * x),
        (0 * y + 3.0, y),
        (x[::-1], 1.0 + north * x[::-1]),
        (0 * y, np.linspace(1, 0, 13)[1:-1]),
    ]
    np.savetxt(
        tmp_path / "duct.csv", np.concatenate([np.stack(side, axis=1) for side in sides]), delimiter=","
    )
    words = (
        "solve-pde",
        tmp_path / "duct.csv",
        "--topology",
        "quad",
        "--res",
        "61x41",
        "--wall-spacing",
        "1e-4",
    )
    told = meshonet(*words, "-o", "g.vts", "--json").only
    assert told["folded"] == 0
    (grid,) = read_grids("g.vts")
    for wall, near, angle in ((0, 1, lean[0]), (-1, -2, lean[1])):
        cell = grid.nodes[:, near] - grid.nodes[:, wall]
        np.testing.assert_allclose(np.hypot(*cell.T), 1e-4, rtol=1e-8)
        along = cell[1:-1] @ [np.cos(np.radians(angle)), np.sin(np.radians(angle))] / 1e-4
        assert np.degrees(np.abs(along)).max() < 1.0
