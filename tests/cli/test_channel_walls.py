"""`solve-pde` in channels: first cells off any side, walls along which nodes slide, lines that are turned."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, dataset, duct

from meshonet.formats.registry import read_grids

HEIGHTS = {"south": 1e-4, "north": 2e-3, "west": 5e-3, "east": 1e-3}


def refused(meshonet: Meshonet, source: Path, words: tuple[str, ...], message: str) -> None:
    """Assert that solve-pde tells of `words` in one line and writes nothing."""
    done = meshonet("solve-pde", source, *words, "-o", "g.vts")
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not Path("g.vts").exists()


@pytest.mark.parametrize("method", ["auto", "winslow", "variational", "thomas-middlecoff"])
def test_first_cells_off_any_side_are_as_high_as_asked(
    meshonet: Meshonet, duct_h5: Path, method: str
) -> None:
    words = [word for side, h in HEIGHTS.items() for word in (f"--spacing-{side}", h)]
    report = meshonet(
        "solve-pde", duct_h5, "--res", "65x65", "--method", method, *words, "-o", "g.h5", "--json"
    ).only
    assert report["folded"] == 0
    (grid,) = read_grids("g.h5")
    for side, height in HEIGHTS.items():
        rows = grid.nodes if side in ("west", "east") else np.swapaxes(grid.nodes, 0, 1)
        wall, next_to = (rows[0], rows[1]) if side in ("west", "south") else (rows[-1], rows[-2])
        np.testing.assert_allclose(np.linalg.norm(next_to - wall, axis=1), height, rtol=1e-8)
    assert "0.0001 off south, 0.001 off east, 0.002 off north, 0.005 off west" in report["notes"][-1]


def test_a_body_can_have_an_elliptic_grid_with_layers(meshonet: Meshonet, body_h5: Path) -> None:
    words = ("--method", "winslow", "--wall-spacing", "1e-4", "--res", "81x60")
    report = meshonet("solve-pde", body_h5, *words, "-o", "g.h5", "--json").only
    assert (report["method"], report["folded"]) == ("winslow", 0)
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
        report = meshonet(*words, *more).only
        (grid,) = read_grids("g.h5")
        leans[name] = _roof_lean(grid.nodes)
        assert (slid in report["notes"]) == (name == "own")
        assert report["method"] == ("winslow" if name == "own" else "steger-sorenson")
        assert report["folded"] == 0
    assert leans["own"] < 1.0
    assert leans["kept"] < 1.0  # sources turn the lines instead
    report = meshonet(*words, "181x61", "--no-slide", "--method", "winslow").only
    (grid,) = read_grids("g.h5")
    assert _roof_lean(grid.nodes) > 10
    for method in ("winslow", "thomas-middlecoff", "variational"):
        report = meshonet(*words, "201x41", "--method", method, "--slide").only
        assert slid in report["notes"]
        assert report["folded"] == 0


@pytest.mark.parametrize("angle", [90, 75])
def test_steger_sorenson_turns_the_lines_at_walls(meshonet: Meshonet, tmp_path: Path, angle: int) -> None:
    source = dataset(tmp_path / "duct.h5", "quad", duct(121, 61, bump=0.0))
    words = ("--method", "steger-sorenson", "--wall-angle", angle, "--spacing-south", "1e-4")
    report = meshonet("solve-pde", source, *words, "-o", "g.h5", "--json").only
    assert (report["method"], report["folded"]) == ("steger-sorenson", 0)
    (grid,) = read_grids("g.h5")
    out = grid.nodes[:, 1] - grid.nodes[:, 0]
    np.testing.assert_allclose(np.hypot(*out.T), 1e-4, rtol=1e-8)
    np.testing.assert_allclose(np.degrees(np.arctan2(out[10:-10, 1], out[10:-10, 0])), angle, atol=1.0)
    assert any(f"lines leave south at {angle} degrees" in note for note in report["notes"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--wall-angle", "80"), "--wall-angle: method auto sets no angle; use --method steger-sorenson"),
        (("--method", "steger-sorenson", "--wall-angle", "10"), "an angle of 10 degrees at walls; use 30 to"),
        (("--method", "steger-sorenson", "--wall-angle", "nan"), "an angle of nan degrees at walls; use 30"),
        (("--method", "steger-sorenson", "--tol", "3"), "--tol: 3 is not between 0 and 1"),
        (("--method", "thomas-middlecoff", "--initial", "missing.vts"), "missing.vts: no such file"),
    ],
)
def test_angles_that_make_no_sense_get_a_line(
    meshonet: Meshonet, duct_h5: Path, words: tuple[str, ...], message: str
) -> None:
    refused(meshonet, duct_h5, words, message)


def test_no_body_slides(meshonet: Meshonet, body_h5: Path) -> None:
    refused(meshonet, body_h5, ("--slide",), "walls of topology o cannot slide; slide those of channels")


def test_growth_in_a_channel_takes_the_rows_it_needs(meshonet: Meshonet, tmp_path: Path) -> None:
    Path("channel.csv").write_text("0,0\n3,0\n3,1\n0,1\n")
    words = ("--topology", "quad", "--wall-spacing", "1e-3", "--growth", "1.2", "-o", "g.h5")
    report = meshonet("solve-pde", "channel.csv", *words, "--json").only
    (grid,) = read_grids("g.h5")
    steps = np.linalg.norm(np.diff(grid.nodes, axis=1), axis=-1)
    ratios = steps[:, 1:] / steps[:, :-1]
    assert np.maximum(ratios, 1 / ratios).max() < 1.2001
    assert 40 < report["nj"] < 60
    done = meshonet("solve-pde", "channel.csv", *words, "--res", "40x30")
    assert done.code == 2
    assert f"more than 1.2; use {report['nj']} or more" in done.err


@pytest.mark.parametrize(
    ("words", "message"),
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
        (("--spacing-south", "1e-3", "--growth", "1.01", "--res", "21x21"), "more than 1.01; use"),
    ],
)
def test_heights_that_make_no_sense_get_a_line(
    meshonet: Meshonet, duct_h5: Path, words: tuple[str, ...], message: str
) -> None:
    refused(meshonet, duct_h5, words, message)


def test_a_body_has_one_wall(meshonet: Meshonet, body_h5: Path) -> None:
    message = "--spacing-north: a height off a single side, around a body (topology o); use"
    refused(meshonet, body_h5, ("--spacing-north", "1e-3"), message)


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
    report = meshonet(*words, "-o", "g.vts", "--json").only
    assert report["folded"] == 0
    (grid,) = read_grids("g.vts")
    for wall, near, angle in ((0, 1, lean[0]), (-1, -2, lean[1])):
        cell = grid.nodes[:, near] - grid.nodes[:, wall]
        np.testing.assert_allclose(np.hypot(*cell.T), 1e-4, rtol=1e-8)
        along = cell[1:-1] @ [np.cos(np.radians(angle)), np.sin(np.radians(angle))] / 1e-4
        assert np.degrees(np.abs(along)).max() < 1.0


def test_a_venturi_has_the_same_walls_in_one_block_and_in_many(meshonet: Meshonet) -> None:
    wall = np.array([[0, 0.25], [1, 0.25], [1.674, 0.125], [1.924, 0.125], [2.873, 0.25], [4.373, 0.25]])
    Path("v.csv").write_text(
        "# axis\n0 0\n4.373 0\n\n# wall\n" + "".join(f"{x} {y}\n" for x, y in wall.tolist())
    )
    for words, near in (("--res 201x21", 1e-12), ("--cells 3000", 0.05)):
        assert meshonet("solve-pde", "v.csv", *words.split(), "--first-cell", "1e-3", "-o", "v.h5").code == 0
        (grid,) = read_grids("v.h5")
        blocks = getattr(grid, "blocks", None) or [grid]
        nodes = np.concatenate([block.nodes.reshape(-1, block.nodes.shape[-1])[:, :2] for block in blocks])
        above = nodes[:, 1] - np.interp(nodes[:, 0], *wall.T)
        assert above.max() < 1e-9, words
        assert max(np.abs(nodes - kink).max(axis=1).min() for kink in wall) < near


def test_lines_of_default_grids_leave_slid_walls_as_upright_as_those_of_elliptic_grids(
    meshonet: Meshonet, tmp_path: Path
) -> None:
    """A bell nozzle: the variational method, the default without layers, leaves them 3 degrees off."""
    x = np.linspace(-4, 7, 40)
    wall = 1.5 - 0.5 * np.exp(-(x**2)) + 0.1 * np.maximum(x, 0)
    lines = ["# axis", "-4 0", "7 0", "", "# wall", *(f"{a} {b}" for a, b in zip(x, wall, strict=True))]
    Path("nozzle.csv").write_text("\n".join(lines) + "\n")
    for command in ("infer", "solve-pde"):
        report = meshonet(
            command, "nozzle.csv", "--res", "201x81", "--first-cell", "1e-3", "-o", f"{command}.vts", "--json"
        ).only
        assert report["method"] == "winslow"
    (one,), (other,) = read_grids("infer.vts"), read_grids("solve-pde.vts")
    np.testing.assert_allclose(one.nodes, other.nodes, atol=1e-6)
