"""Options for boundary layers, the same in every command that has them."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids

SECTION = "naca:2412"
LAYER_COMMANDS = ("solve-pde", "infer")


def growth_off_the_wall(nodes: np.ndarray) -> float:
    """Return the largest ratio of neighbouring cells along the lines (ni, nj, 2) that leave south."""
    steps = np.linalg.norm(np.diff(nodes, axis=1), axis=-1)
    ratio = steps[:, 1:] / steps[:, :-1]
    return float(np.maximum(ratio, 1 / ratio).max())


@pytest.mark.parametrize("command", LAYER_COMMANDS)
def test_wall_spacing_is_the_height_of_every_first_cell(meshonet: Meshonet, command: str) -> None:
    words = (command, SECTION, "--res", "120x70", "--wall-spacing", "1e-5", "-o", "g.h5", "--json")
    report = meshonet(*words).only
    assert (report["method"], report["folded"], report["path"]) == ("hyperbolic", 0, [])
    (grid,) = read_grids("g.h5")
    heights = np.linalg.norm(grid.nodes[:, 1] - grid.nodes[:, 0], axis=1)
    np.testing.assert_allclose(heights, 1e-5, rtol=1e-8)
    assert "first-cell height is 1e-05 at every wall node" in report["notes"][-1]


@pytest.mark.parametrize("command", LAYER_COMMANDS)
def test_y_plus_is_a_height_by_the_flat_plate(meshonet: Meshonet, command: str) -> None:
    words = ("--y-plus", "2", "--reynolds", "6e6", "--chord-fraction", "0.25")
    done = meshonet(command, SECTION, "--res", "120x80", *words, "-o", "g.h5")
    assert done.code == 0
    assert "Cf = (2 log10(Re x/c) - 0.65)^-2.3 (Schlichting" in done.err
    (grid,) = read_grids("g.h5")
    friction = (2 * np.log10(1.5e6) - 0.65) ** -2.3
    expected = 2 / (6e6 * np.sqrt(friction / 2))
    np.testing.assert_allclose(
        np.linalg.norm(grid.nodes[:, 1] - grid.nodes[:, 0], axis=1), expected, rtol=1e-8
    )


@pytest.mark.parametrize("command", LAYER_COMMANDS)
def test_te_rounds_a_blunt_edge(meshonet: Meshonet, command: str) -> None:
    words = (command, SECTION, "--res", "200x80", "--wall-spacing", "1e-5", "-o", "g.h5", "--json")
    sharp, rounded = (
        meshonet(*words, "--te", te).only["quality"]["max_angle"]["max"] for te in ("exact", "round")
    )
    assert sharp > 125
    assert rounded < 102


@pytest.mark.parametrize("command", LAYER_COMMANDS)
def test_growth_takes_few_more_rows_than_it_needs(meshonet: Meshonet, command: str) -> None:
    words = (SECTION, "--wall-spacing", "1e-4", "--growth", "1.2", "-o", "g.vts")
    made = meshonet(command, *words, "--json").only
    assert 50 < made["nj"] <= 62
    done = meshonet(command, *words, "--res", "200x40")
    assert done.code == 2
    refusal = re.search(
        "40 rows of nodes cannot reach the far field growing by 1.2 each; use (.*) rows", done.err
    )
    assert refusal is not None
    assert 1 <= made["nj"] - int(refusal[1]) <= 4


@pytest.mark.parametrize(
    ("shape", "nodes"),
    [
        (f"{SECTION} --topology o", "81"),
        (f"{SECTION} --topology c", "301"),
        ("naca:2412-sharp", "121"),
        ("box.csv", "41"),
    ],
)
def test_one_number_of_nodes_is_along_xi_where_growth_chooses_the_rows(
    meshonet: Meshonet, shape: str, nodes: str
) -> None:
    Path("box.csv").write_text("0,0\n2,0\n2,1\n0,1\n")
    words = ("infer", *shape.split(), "--first-cell", "1e-3", "--growth", "1.2", "-o", "{name}.h5", "--json")
    for res, rows in ((nodes, range(25, 60)), (f"{nodes}x75", (75,))):
        made = meshonet(*words, "--res", res)
        assert made.code == 0, made.err
        (grid,) = read_grids(made.only["output"])
        ni, nj = grid.blocks[0].counts
        assert (ni, nj in rows) == (int(nodes), True)
        assert growth_off_the_wall(grid.blocks[0].nodes) <= 1.2


def test_growth_counts_rows_of_walls_along_eta_alone(meshonet: Meshonet) -> None:
    Path("box.csv").write_text("0,0\n2,0\n2,1\n0,1\n")
    words = ("tfi", "box.csv", "--res", "65", "--spacing-west", "1e-3", "--growth", "1.2", "-o", "g.h5")
    made = meshonet(*words, "--json").only
    assert (made["ni"], made["nj"]) == (65, 65)


@pytest.mark.parametrize("command", LAYER_COMMANDS)
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("--wall-spacing", "1e-5", "--y-plus", "1", "--reynolds", "1e6"),
            "both say how high the first cell is",
        ),
        (("--y-plus", "1"), "--y-plus without --reynolds; give --reynolds as well"),
        (("--reynolds", "1e6"), "--reynolds without --y-plus; give --y-plus as well"),
        (("--y-plus", "0", "--reynolds", "1e6"), "--y-plus: a y+ of 0; use more than 0 and at most 1e4"),
        (("--y-plus", "1", "--reynolds", "-3"), "--reynolds: a Reynolds number of -3; use 1e3 to 1e12"),
        (("--y-plus", "1", "--reynolds", "nan"), "--reynolds: a Reynolds number of nan; use 1e3 to 1e12"),
        (
            ("--y-plus", "1", "--reynolds", "1e6", "--chord-fraction", "2"),
            "--chord-fraction: 2 of the chord; use more than 0 and at most 1",
        ),
        (
            ("--y-plus", "1", "--reynolds", "2e3", "--chord-fraction", "0.1"),
            "--chord-fraction: a Reynolds number of 200 at 0.1 of the chord; use a larger part",
        ),
        (("--chord-fraction", "0.3"), "--chord-fraction without --y-plus; give --y-plus and --reynolds"),
        (("--growth", "1.2"), "--growth without a first cell; give --first-cell"),
        (
            ("--wall-spacing", "1e-5", "--growth", "0.2"),
            "--growth: a growth of 0.2; give the ratio of neighb",
        ),
        (("--wall-spacing", "-1"), "--first-cell: a first cell of -1; give a positive height"),
        (("--wall-spacing", "x"), "--first-cell: 'x' is not a number; use a number, or WALL=NUMBER"),
        (("--wall-spacing", "2"), "--first-cell: a first cell of 2 chords; use 1e-9 to 0.1"),
        (("--wall-spacing", "nan"), "--first-cell: a first cell of nan; give a positive height"),
        (("--constant-layers", "3"), "--constant-layers without a first cell; give --first-cell"),
        (("--wall-spacing", "1e-3", "--constant-layers", "0"), "constant-layers"),
        (("--wall-spacing", "0.02", "--constant-layers", "1000"), "1000 layers of 0.02 reach the far field"),
        (("--wall-spacing", "0.1", "--constant-layers", "200"), "100 nodes off south are too few for layers"),
        (("--wall-spacing", "1e-5", "--res", "90x10"), "10 rows of nodes cannot reach the far field growing"),
    ],
)
def test_first_cells_that_make_no_sense_get_a_line(
    meshonet: Meshonet, command: str, words: tuple[str, ...], message: str
) -> None:
    done = meshonet(command, SECTION, *words, "-o", "g.vts")
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


@pytest.mark.parametrize("command", LAYER_COMMANDS)
def test_in_a_channel_the_walls_are_south_and_north(meshonet: Meshonet, duct_h5: Path, command: str) -> None:
    words = ("--wall-spacing", "1e-4", "--res", "61x61", "--constant-layers", "3")
    report = meshonet(command, duct_h5, *words, "-o", "g.h5", "--json").only
    assert report["folded"] == 0
    assert any("0.0001 off south, 0.0001 off north" in note for note in report["notes"])
    (grid,) = read_grids("g.h5")
    steps = np.linalg.norm(np.diff(grid.nodes, axis=1), axis=-1)
    np.testing.assert_allclose(steps[:, [0, -1]], 1e-4, rtol=1e-8)
    np.testing.assert_allclose(steps[:, [1, 2, -2, -3]], 1e-4, rtol=1e-3)


@pytest.mark.parametrize("command", LAYER_COMMANDS)
def test_y_plus_in_a_channel_counts_in_its_length(meshonet: Meshonet, duct_h5: Path, command: str) -> None:
    words = ("--y-plus", "1", "--reynolds", "6e6", "--res", "61x81", "-o", "g.h5")
    done = meshonet(command, duct_h5, *words)
    assert "Cf = (2 log10(Re x/c) - 0.65)^-2.3 (Schlichting" in done.err
    (grid,) = read_grids("g.h5")
    friction = (2 * np.log10(3e6) - 0.65) ** -2.3
    first = np.linalg.norm(grid.nodes[:, [1, -2]] - grid.nodes[:, [0, -1]], axis=-1)
    np.testing.assert_allclose(first, 2.0 / (6e6 * np.sqrt(friction / 2)), rtol=1e-8)


def test_no_march_makes_a_channel(meshonet: Meshonet, duct_h5: Path) -> None:
    words = (duct_h5, "--wall-spacing", "1e-3", "--method", "hyperbolic", "-o", "g.vts")
    done = meshonet("solve-pde", *words)
    assert done.code == 2
    assert "hyperbolic marching cannot make topology quad; use it around a body (topology o or c)" in done.err


@pytest.mark.parametrize("command", LAYER_COMMANDS)
def test_constant_layers_are_equally_high(meshonet: Meshonet, command: str) -> None:
    words = ("--wall-spacing", "1e-4", "--constant-layers", "5", "--res", "120x70")
    assert meshonet(command, SECTION, *words, "-o", "g.h5").code == 0
    (grid,) = read_grids("g.h5")
    steps = np.linalg.norm(np.diff(grid.nodes, axis=1), axis=-1)
    np.testing.assert_allclose(steps[:, 0], 1e-4, rtol=1e-8)
    assert np.abs(steps[:, 1:5] / 1e-4 - 1).mean() < 0.02
    assert (steps[:, 8] > 1.2e-4).all()
