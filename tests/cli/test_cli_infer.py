"""`meshonet infer`."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, ellipse, wave

from meshonet.formats.registry import read_grids


def test_a_body_becomes_a_valid_o_grid(meshonet: Meshonet, body_h5: Path) -> None:
    report = meshonet("infer", body_h5, "-o", "grid.vts", "--json").only
    assert report["folded"] == 0
    assert report["topology"] == "o"
    (grid,) = read_grids("grid.vts")
    np.testing.assert_array_equal(grid.nodes[:, 0], ellipse()["south"])
    np.testing.assert_array_equal(grid.nodes[-1], grid.nodes[0])


def test_base_is_the_conformal_map_without_network(meshonet: Meshonet, body_h5: Path) -> None:
    report = meshonet("infer", body_h5, "-o", "grid.vts", "--model", "base", "--polish", "off", "--json").only
    assert (report["method"], report["model"], report["cycles"]) == ("conformal", None, 0)


def test_reports_say_that_an_o_grid_comes_of_a_conformal_map(meshonet: Meshonet, body_h5: Path) -> None:
    assert "  method     conformal map\n" in meshonet("infer", body_h5, "-o", "grid.vts").err
    lines = meshonet("infer", body_h5, body_h5, "-o", "{index}.vts").err.splitlines()
    assert ", conformal map, " in lines[0]
    assert (
        meshonet("solve-pde", body_h5, "--method", "conformal", "-o", "g.h5", "--json").only["method"]
        == "conformal"
    )
    (grid,) = read_grids("grid.vts")
    assert grid.provenance["method"] == "conformal"
    named = meshonet("infer", body_h5, "-o", "grid.vts", "--model", "airfoil-o").err
    assert "  method     operator, model airfoil-o\n" in named


def test_polish_takes_the_steps_it_is_told(meshonet: Meshonet, body_h5: Path) -> None:
    report = meshonet("infer", body_h5, "-o", "grid.vts", "--model", "base", "--polish", "2", "--json").only
    assert report["cycles"] == 2


def test_a_channel_becomes_a_valid_grid_too(meshonet: Meshonet, folding_h5: Path) -> None:
    report = meshonet("infer", folding_h5, "-o", "grid.vts", "--json").only
    assert report["folded"] == 0
    (grid,) = read_grids("grid.vts")
    np.testing.assert_array_equal(grid.nodes[:, 0], wave()["south"])
    assert report["method"] == "variational"
    winslow = meshonet("solve-pde", folding_h5, "-o", "winslow.vts", "--json").only
    for figure in ("mean", "max"):
        assert report["quality"]["max_angle"][figure] < winslow["quality"]["max_angle"][figure]


@pytest.mark.parametrize("option", ["--model=base", "--polish=2", "--answer=raw"])
def test_an_operator_is_refused_where_sources_turn_the_lines(
    meshonet: Meshonet, folding_h5: Path, option: str
) -> None:
    done = meshonet("infer", folding_h5, "-o", "g.vts", "--wall-spacing", "1e-4", option)
    name = option.split("=")[0]
    assert done.code == 2
    assert f"{name} is of no use to a channel with given wall nodes; drop {name}" in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


def test_a_designation_needs_no_file(meshonet: Meshonet) -> None:
    report = meshonet("infer", "naca:2412", "-o", "{stem}.vts", "--res", "80x40", "--json").only
    assert (report["ni"], report["nj"], report["folded"], report["output"]) == (80, 40, 0, "naca2412.vts")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--model", "nothing"), "no model 'nothing'"),
        (
            ("--wall-spacing", "1e-3", "--model", "base"),
            "--model is of no use to a grid marched from the wall",
        ),
        (
            ("--wall-spacing", "1e-3", "--polish", "2"),
            "--polish is of no use to a grid marched from the wall",
        ),
        (("--polish", "much"), "--polish: 'much' is not a number of steps; use auto, off or e.g. 2"),
    ],
)
def test_mistakes_get_a_line(meshonet: Meshonet, body_h5: Path, words: tuple[str, ...], message: str) -> None:
    done = meshonet("infer", body_h5, "-o", "g.vts", *words)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


@pytest.mark.parametrize(
    ("words", "topology"), [(("--te", "wedge"), "c"), ((), "o"), (("--te", "wedge", "--topology", "o"), "o")]
)
def test_thin_cells_at_a_sharp_edge_are_marched_from_wall_and_wake(
    meshonet: Meshonet, words: tuple[str, ...], topology: str
) -> None:
    given = ("naca:0012", "--wall-spacing", "1e-4", "--res", "140x60", "--json", "-o", "g.vts")
    report = meshonet("infer", *given, *words).only
    assert (report["topology"], report["method"], report["folded"]) == (topology, "hyperbolic", 0)
    (grid,) = read_grids("g.vts")
    names = {part.name for part in grid.patches}
    assert names == ({"wall", "wake", "farfield"} if topology == "c" else {"wall", "farfield"})


def test_c_grids_without_a_first_cell_are_marched_and_the_report_says_so(meshonet: Meshonet) -> None:
    report = meshonet(
        "infer", "naca:0012", "--topology", "c", "--res", "120x40", "--json", "-o", "g.vts"
    ).only
    assert report["folded"] == 0
    assert report["topology"] == "c"
    assert report["method"] == "hyperbolic"
    assert any("--first-cell is not given: the first-cell height follows" in note for note in report["notes"])


def test_repair_is_a_switch_here_too(meshonet: Meshonet, folding_h5: Path) -> None:
    words = ("infer", folding_h5, "--model", "quad-winslow", "--polish", "off", "-o", "g.vts")
    assert meshonet(*words, "--repair").code == 0
    refused = meshonet(*words, "--no-repair")
    if refused.code:  # the network's own grid is folded
        assert "cells are folded; use --repair" in refused.err
    done = meshonet(*words, "--repair", "--answer", "raw")
    assert done.code == 2
    assert "--repair would change a raw answer; leave one of --repair and --answer out" in done.err


def test_a_bent_body_by_the_model_for_bodies(meshonet: Meshonet) -> None:
    """Its centroid is outside it. The report says what unfolded the network's answer, if it was folded."""
    bend = np.linspace(-2.2, 2.2, 40)
    plate = np.concatenate([1.05 * np.exp(1j * bend), 0.95 * np.exp(-1j * bend)])
    np.savetxt("clip.csv", np.stack([plate.real, plate.imag], 1)[np.r_[:80, 0]], delimiter=",")
    words = ("infer", "clip.csv", "--topology", "o", "--res", "129x33", "--model", "hole-o", "--json")
    alone = meshonet(*words, "--polish", "off", "-o", "alone.vts").only
    assert (alone["model"], alone["folded"]) == ("hole-o", 0)
    assert alone["path"] in (["repair"], [])
    after = meshonet(*words, "-o", "after.vts").only
    assert (after["model"], after["folded"], after["path"]) == ("hole-o", 0, [])
    assert after["quality"]["max_angle"]["mean"] < alone["quality"]["max_angle"]["mean"]
