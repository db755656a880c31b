"""Circles in five blocks: their area, their first cells, and how cells grow from the wall to the middle."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import vertices
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.lines import lines
from meshonet.geometry.quality.measure import measure
from meshonet.solvers.sweeping.disc import Disc, butterfly

RADIUS = 0.5


def area(grid: Grid) -> float:
    """What the wall encloses, by the shoelace formula."""
    wall = np.concatenate([block.nodes[:-1, 0] for block in grid.blocks[1:]])
    x, y = wall.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def first_cells(grid: Grid) -> np.ndarray:
    steps = [block.nodes[:, 1] - block.nodes[:, 0] for block in grid.blocks[1:]]
    return np.linalg.norm(np.concatenate(steps), axis=-1)


def largest(grid: Grid) -> float:
    return max(each.max for each in lines(grid, vertices(grid)).growth.families().values())


@pytest.mark.parametrize("cells", [None, 200, 800, 2000, 6000, 20_000])
@pytest.mark.parametrize("first", [None, 5e-3, 2e-4, 1e-5])
@pytest.mark.parametrize("growth", [None, 1.1, 1.3])
def test_the_area_the_first_cells_and_the_growth_are_those_asked_for(cells, first, growth):
    grid = butterfly(Disc(RADIUS, cells, first, growth))
    quality = measure(grid)
    assert quality.folded == 0
    assert quality["max_angle"].max < 125.0
    assert area(grid) == pytest.approx(np.pi * RADIUS**2, rel=1e-3)
    assert largest(grid) <= (growth or 1.2) * (1 + 1e-9)
    if first:
        assert first_cells(grid) == pytest.approx(np.full(4 * len(grid.blocks[0].nodes), first), rel=1e-9)


@pytest.mark.parametrize("cells", [2000, 6000, 20_000])
def test_a_circle_has_about_the_cells_asked_for(cells):
    assert measure(butterfly(Disc(RADIUS, cells))).cells == pytest.approx(cells, rel=0.06)


@pytest.mark.parametrize("around", [8, 16, 24, 40, 60, 120])
@pytest.mark.parametrize("first", [None, 0.02, 1e-4])
def test_cells_around_are_as_many_as_asked_for_and_rows_adapt(around, first):
    grid = butterfly(Disc(RADIUS, None, first, around=around))
    assert sum(block.counts[0] - 1 for block in grid.blocks[1:]) == around
    assert largest(grid) <= 1.2 * (1 + 1e-9)


def test_lines_leave_the_wall_at_right_angles():
    grid = butterfly(Disc(RADIUS, first_cell=1e-3))
    for block in grid.blocks[1:]:
        out, step = block.nodes[:, 0] / RADIUS, block.nodes[:, 1] - block.nodes[:, 0]
        assert np.abs(out[:, 0] * step[:, 1] - out[:, 1] * step[:, 0]).max() < 1e-12


def test_more_cells_than_were_asked_for_have_a_note():
    assert Disc(RADIUS, 200).note.startswith("a circle has 945 cells or more instead of 200: 84 around")
    assert "{around} 72 makes 2556 cells, and an area 0.13 % too small" in Disc(40.0, 2500, 0.0167).note
    assert not Disc(RADIUS, 2000).note
    assert Disc(12.5, 2000, 0.05).side == 21  # the fewest with which the area is within 0.1 %
    note = Disc(RADIUS, 200).note.split()
    radius, around = float(note[-1]), int(note[note.index("{around}") + 1])
    assert area(butterfly(Disc(radius, around=around))) == pytest.approx(np.pi * RADIUS**2, rel=1e-9)
    assert not Disc(RADIUS, around=24).note


@pytest.mark.parametrize(
    ("values", "problem"),
    [
        ({"around": 42}, "42 cells around a circle; use a multiple of 4 from 8"),
        ({"around": 4}, "4 cells around a circle"),
        ({"around": 40, "cells": 200}, "cells and around both say how fine a circle is"),
    ],
)
def test_cells_around_that_cannot_be_are_refused(values, problem):
    with pytest.raises(InputError) as refusal:
        Disc(RADIUS, **values)
    assert problem in str(refusal.value)
