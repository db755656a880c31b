"""Curves of DXF drawings: areas and perimeters of the grids against those of the exact curves."""

import math
from pathlib import Path

import numpy as np
import pytest

import meshonet

ezdxf = pytest.importorskip("ezdxf")
BOX = [(-5, -4), (5, -4), (5, 4), (-5, 4)]


def area(grid: meshonet.Grid) -> float:
    """The area of all cells."""
    total = 0.0
    for block in grid.blocks:
        (one, other) = (
            np.moveaxis(step, -1, 0)
            for step in (
                block.nodes[1:, 1:] - block.nodes[:-1, :-1],
                block.nodes[:-1, 1:] - block.nodes[1:, :-1],
            )
        )
        total += 0.5 * float(np.abs(one[0] * other[1] - one[1] * other[0]).sum())
    return total


def made(draw: object, path: Path) -> meshonet.Grid:
    """The grid of a drawing."""
    drawing = ezdxf.new()
    draw(drawing, drawing.modelspace())  # type: ignore[operator]
    drawing.saveas(path / "drawing.dxf")
    return meshonet.grid(str(path / "drawing.dxf"), cells=2500)


def stadium(_, space) -> None:
    space.add_line((0, 0), (4, 0), dxfattribs={"layer": "floor"})
    space.add_arc((4, 1), 1, -90, 90, dxfattribs={"layer": "nose"})
    space.add_line((4, 2), (0, 2), dxfattribs={"layer": "roof"})
    space.add_line((0, 2), (0, 0), dxfattribs={"layer": "inlet"})


def bulges(_, space) -> None:
    points = [(0, 2, 0), (0, 0, 0), (4, 0, 1), (4, 2, 0)]
    space.add_lwpolyline(points, format="xyb", dxfattribs={"layer": "duct"})
    space.add_line((4, 2), (0, 2), dxfattribs={"layer": "lid"})


def in_box(draw):
    def drawn(drawing, space) -> None:
        space.add_lwpolyline(BOX, close=True, dxfattribs={"layer": "box"})
        draw(drawing, space)

    return drawn


def ellipse(_, space) -> None:
    space.add_ellipse((0, 0), (2, 0), 0.5, dxfattribs={"layer": "oval"})


def spline(_, space) -> None:
    turn = np.linspace(0, 2 * np.pi, 41)
    space.add_spline([(2 * math.cos(t), math.sin(t)) for t in turn], dxfattribs={"layer": "oval"})


def turned_over(_, space) -> None:
    space.add_circle((-1, 0), 1, dxfattribs={"extrusion": (0, 0, -1), "layer": "tube"})


def blocks(drawing, space) -> None:
    block = drawing.blocks.new("TUBE")
    block.add_circle((0, 0), 0.5, dxfattribs={"layer": "tube"})
    for place in ((-2, 0), (2, 1)):
        space.add_blockref("TUBE", place)


CASES = {
    "an arc": (stadium, 8 + math.pi / 2, {"floor", "nose", "roof", "inlet"}),
    "a bulge": (bulges, 8 + math.pi / 2, {"duct", "lid"}),
    "an ellipse": (in_box(ellipse), 80 - 2 * math.pi, {"box", "oval"}),
    "a spline": (in_box(spline), 80 - 2 * math.pi, {"box", "oval"}),
    "a circle seen from below": (in_box(turned_over), 80 - math.pi, {"box", "tube"}),
    "inserted blocks": (in_box(blocks), 80 - math.pi / 2, {"box", "tube"}),
}


@pytest.mark.parametrize("case", CASES)
def test_grids_follow_the_curves_and_have_the_names_of_layers(case: str, tmp_path: Path) -> None:
    draw, exact, names = CASES[case]
    grid = made(draw, tmp_path)
    assert {patch.name for patch in grid.patches} == names
    assert area(grid) == pytest.approx(exact, rel=1e-3)


OPEN = {
    "a line": ([((0, 0), (2, 1))], r"one edge ends at \(0, 0\); the boundary has to consist of closed"),
    "a corner": ([((0, 0), (2, 1)), ((2, 1), (2, 3))], r"one edge ends at \(0, 0\)"),
    "there and back": ([((0, 0), (2, 1)), ((2, 1), (0, 0))], "has 2 edges; a closed curve needs at least 3"),
}


@pytest.mark.parametrize("case", OPEN)
def test_open_ends_of_few_lines_are_named(case: str, tmp_path: Path) -> None:
    lines, message = OPEN[case]

    def draw(_, space) -> None:
        for line in lines:
            space.add_line(*line)

    with pytest.raises(meshonet.InputError, match=message):
        made(draw, tmp_path)
