"""``meshonet sweep``: cross-sections along paths."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

import meshonet as library
from meshonet.formats.registry import read_grids

BEND = """
[[pieces]]
line = 1
[[pieces]]
arc = 90
radius = 2
towards = [0, 1, 0]
"""


@pytest.fixture(autouse=True)
def inputs(tmp_path: Path) -> None:
    (tmp_path / "bend.toml").write_text(BEND)
    (tmp_path / "path.csv").write_text("0,0,0\n1,0,0\n3,1,0\n4,3,0\n")
    (tmp_path / "box.csv").write_text("0,0\n1,0\n1,0.5\n0,0.5\n")
    angle = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    ellipse = np.stack([0.6 * np.cos(angle), 0.4 * np.sin(angle)], axis=1)
    np.savetxt(tmp_path / "ellipse.csv", ellipse, delimiter=",")
    (tmp_path / "rings.wkt").write_text(
        "POLYGON ((-1 -1, 1 -1, 1 1, -1 1, -1 -1), (-.3 -.3, -.3 .3, .3 .3, .3 -.3, -.3 -.3))"
    )


def swept(meshonet: Meshonet, *words: str):
    done = meshonet("sweep", *words, "-o", "made.h5", "-q")
    assert done.code == 0, done.err
    (grid,) = read_grids("made.h5")
    return grid


def test_a_circle_becomes_a_pipe_of_five_blocks(meshonet: Meshonet) -> None:
    grid = swept(meshonet, "circle:0.5", "bend.toml", "--around", "24", "--planes", "21")
    assert len(grid.blocks) == 5
    assert {(patch.name, patch.kind) for patch in grid.patches} == {
        ("wall", "wall"), ("inlet", "inlet"), ("outlet", "outlet"),
    }  # fmt: skip
    assert all(block.counts[2] == 21 for block in grid.blocks)


def test_the_report_says_what_a_pipe_has_at_its_wall(meshonet: Meshonet) -> None:
    words = "sweep circle:0.5 bend.toml --cells 800 --first-cell 2e-4 -o p.h5"
    done = meshonet(*words.split())
    assert done.code == 0, done.err
    assert "wall: first cells 0.0002, growth up to 1.192 along lines from it" in done.err
    assert "a circle has 3129 cells or more instead of 800: 84 around keep its area within 0.1 %" in done.err


def test_growth_beyond_its_limit_is_told_with_its_place(meshonet: Meshonet) -> None:
    words = "sweep circle:0.5 bend.toml --around 200 --first-cell .05 --growth 1.1 -o p.h5"
    done = meshonet(*words.split())
    assert done.code == 0, done.err
    place = r"along \w+ at block=\d, i=\d+, j=\d+ \(\S+, \S+\)"
    assert re.search(rf"the largest growth ratio is 1\.164, {place}", done.err)
    assert "above the limit of 1.1" in done.err


def test_a_closed_curve_is_filled_with_blocks_and_a_four_sided_one_with_one(meshonet: Meshonet) -> None:
    assert len(swept(meshonet, "ellipse.csv", "bend.toml", "--cells", "200").blocks) >= 5
    box = swept(meshonet, "box.csv", "bend.toml", "--res", "21x11", "--first-cell", "0.004")
    assert box.blocks[0].counts[:2] == (21, 11)
    first = np.linalg.norm(box.blocks[0].nodes[:, 1] - box.blocks[0].nodes[:, 0], axis=-1)
    assert first == pytest.approx(np.full(first.shape, 0.004), rel=1e-6)


def test_a_duct_with_rounded_corners_is_as_wide_as_its_outline(meshonet: Meshonet) -> None:
    angle = np.linspace(0.0, 0.5 * np.pi, 25)
    arc = 0.1 * np.exp(1j * angle)
    rounded = np.concatenate(
        [middle + arc * 1j**k for k, middle in enumerate((0.3 + 0.1j, -0.3 + 0.1j, -0.3 - 0.1j, 0.3 - 0.1j))]
    )
    np.savetxt("duct.csv", np.stack([rounded.real, rounded.imag], axis=1))
    Path("straight.csv").write_text("0,0,0\n0,0,3\n")
    words = ("straight.csv", "--up", "0,1,0", "--cells", "1000", "--planes", "3")
    nodes = np.concatenate(
        [block.nodes.reshape(-1, 3) for block in swept(meshonet, "duct.csv", *words).blocks]
    )
    np.testing.assert_allclose(np.ptp(nodes, axis=0), [0.8, 0.4, 3], rtol=1e-6)


def test_a_section_says_how_far_its_smooth_curve_leaves_its_points(meshonet: Meshonet) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 14, endpoint=False)
    np.savetxt("coarse.csv", np.stack([np.cos(angle), np.sin(angle)], axis=1))
    done = meshonet("sweep", "coarse.csv", "bend.toml", "--cells", "1000", "-o", "made.h5")
    assert "the sides are smooth curves through the points, up to 0.025 away" in done.err
    assert "more cells help" not in done.err


@pytest.mark.parametrize(("words", "counts"), [("", (65, 53)), ("--res 81 --growth 1.15", (81, 65))])
def test_growth_is_a_limit_in_four_sided_sections_too(
    meshonet: Meshonet, words: str, counts: tuple[int, int]
) -> None:
    Path("straight.csv").write_text("0,0,0\n0,0,3\n")
    Path("wide.csv").write_text("0,0\n2,0\n2,1\n0,1\n")
    box = swept(meshonet, "wide.csv", "straight.csv", "--planes", "3", "--first-cell", "1e-3", *words.split())
    assert box.blocks[0].counts[:2] == counts
    steps = np.linalg.norm(np.diff(box.blocks[0].nodes[:, :, 0], axis=1), axis=-1)
    growth = steps[:, 1:] / steps[:, :-1]
    assert np.maximum(growth, 1 / growth).max() <= float((words or "1.2").split()[-1])
    refused = meshonet("sweep", "wide.csv", "straight.csv", "--first-cell", "1e-3", "--res", "41",
                       "--growth", "1.2", "-o", "g.h5")  # fmt: skip
    assert (refused.code, Path("g.h5").exists()) == (2, False)
    assert "41 nodes across 2 need cells that grow by 1.34, more than 1.2; use 60 or more" in refused.err


def test_a_domain_with_a_hole_keeps_the_names_of_its_loops(meshonet: Meshonet) -> None:
    grid = swept(meshonet, "rings.wkt", "bend.toml", "--cells", "200")
    assert {patch.name for patch in grid.patches} == {"wall", "body", "inlet", "outlet"}
    assert {patch.kind for patch in grid.patches if patch.name == "body"} == {"wall"}


def test_a_planar_grid_is_swept_as_it_is(meshonet: Meshonet) -> None:
    assert meshonet("tfi", "box.csv", "--res", "9x5", "-o", "box.h5", "-q").code == 0
    grid = swept(meshonet, "box.h5", "path.csv")
    assert grid.blocks[0].counts[:2] == (9, 5)


def test_several_sections_go_along_one_path(meshonet: Meshonet) -> None:
    done = meshonet(
        "sweep", "circle:0.5", "circle:0.3", "path.csv", "--around", "24", "-o", "{index}.h5", "-q"
    )
    assert done.code == 0, done.err
    assert {path.name for path in Path().glob("*.h5")} == {"0.h5", "1.h5"}


def test_the_function_makes_what_the_command_writes(meshonet: Meshonet) -> None:
    written = swept(meshonet, "circle:0.5", "path.csv", "--around", "24", "--twist", "20")
    points = np.loadtxt("path.csv", delimiter=",")
    made = library.sweep("circle:0.5", points, around=24, twist=20.0)
    for one, two in zip(written.blocks, made.blocks, strict=True):
        assert np.array_equal(one.nodes, two.nodes)


def test_a_section_can_be_turned_about_an_axis_instead(meshonet: Meshonet) -> None:
    words = "--revolve", "90", "--axis", "0,-2,1,0"
    grid = swept(meshonet, "circle:0.5", "--around", "32", *words)
    assert {(patch.name, patch.kind) for patch in grid.patches} == {
        ("wall", "wall"), ("inlet", "inlet"), ("outlet", "outlet"),
    }  # fmt: skip
    assert np.hypot(grid.blocks[0].nodes[..., 1] + 2.0, grid.blocks[0].nodes[..., 2]).min() > 1.5
    whole = swept(meshonet, "circle:0.5", "--around", "32", "--revolve", "360", *words[2:])
    assert {patch.name for patch in whole.patches} == {"wall"}


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("circle:0.5", "--revolve", "90"), "--axis: the axis runs through the grid, from 0.5 to one side"),
        (("circle:0.5", "bend.toml", "--axis", "y"), "--axis: nothing is turned; give --revolve as well"),
        (("circle:0.5", "--revolve", "90", "--twist", "9"), "--up, --twist and --scale belong to a path"),
        (("circle:0.5", "--revolve", "90", "--axis", "z"), "--axis: 'z' is not an axis"),
        (("circle:3", "bend.toml"), "the path bends with a radius of 2 at (1"),
        (("bend.toml",), "there is no path"),
        (("circle:x", "bend.toml"), "'x' is no radius"),
        (("circle:-1", "bend.toml"), "a circle of radius -1"),
        (("circle:0.5", "none.csv"), "none.csv"),
        (("circle:0.5", "box.csv"), "line 1: '0,0' is not x, y and z"),
        (("circle:0.5", "bend.toml", "--up", "1,0,0"), "--up: points along the path"),
        (("circle:0.5", "bend.toml", "--up", "north"), "--up: 'north' is not a direction"),
        (("circle:0.5", "bend.toml", "--res", "9"), "--res: a circle is made of five blocks"),
        (("circle:0.5", "bend.toml", "--around", "30"), "--around: 30 cells around a circle"),
        (("circle:0.5", "bend.toml", "--around", "32", "--cells", "99"), "--cells and --around both say"),
        (("ellipse.csv", "bend.toml", "--around", "32"), "--around: cells around are counted in circles"),
        (("circle:0.5", "bend.toml", "--planes", "1"), "--planes"),
        (("circle:0.5", "bend.toml", "--scale", "0"), "--scale: 0"),
        (("circle:0.5", "bend.toml", "--first-cell", "0.4"), "--first-cell: 0.4 in a circle"),
    ],
)
def test_what_cannot_be_swept_gets_a_line(meshonet: Meshonet, words: tuple[str, ...], problem: str) -> None:
    done = meshonet("sweep", *words, "-o", "made.h5")
    assert (done.code, done.err.count("\n")) == (2, 1), done.err
    assert problem in done.err
    assert not Path("made.h5").exists()


def test_first_cells_of_a_taper_are_those_along_the_whole_path(meshonet: Meshonet) -> None:
    Path("line.csv").write_text("0 0 0\n5 0 0\n10 0 0\n")
    words = ("sweep", "circle:1", "line.csv", "--first-cell", "0.01", "--planes", "6", "-o", "pipe.h5")
    plain = meshonet(*words).err
    assert "  wall: first cells 0.01, growth" in plain
    assert "taper" not in plain
    half = meshonet(*words, "--scale", ".5").err
    assert "  at the start of the path: wall: first cells 0.01, growth" in half
    assert "  wall: first cells 0.005 to 0.01 along the path" in half
    assert "taper" not in half
    needle = meshonet(*words, "--scale", ".001").err
    assert "  wall: first cells 1e-05 to 0.01 along the path" in needle
    assert "the section ends 0.001 times as large as it begins: this --scale is a taper" in needle
