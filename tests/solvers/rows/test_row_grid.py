"""Grids of rows: valid, first cells exact in space, periodic, the blade where its profiles are."""

import math
import re
from functools import cache

import blade_row
import numpy as np
import pytest
import radial_rows

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.rows.row import Row
from meshonet.solvers.pipeline.rows import make_row
from meshonet.solvers.rows.key_tables import key_tables
from meshonet.solvers.rows.request import RowRequest

FIRST = 1e-3
GAPS = {"none": (0.0, 0.0), "tip": (0.02, 0.0), "hub": (0.0, 0.02)}


@cache
def made(gap: str = "none", threads: int = 1) -> Grid:
    request = RowRequest(first_cell=FIRST, cells=40_000, threads=threads)
    return make_row(blade_row.blade_row(*GAPS[gap]), request).grid


@pytest.mark.parametrize("gap", GAPS)
def test_cells_are_valid_with_good_angles(gap: str) -> None:
    quality = made(gap).quality()
    assert quality.folded == 0
    assert quality.metrics["max_angle"].max < 150.0


@pytest.mark.parametrize("staggers", [(-42, -64, -65, -65), (59, 60, 50, 45)])
def test_fans_of_high_stagger_and_low_solidity_have_valid_gaps(staggers: tuple[float, ...]) -> None:
    """All nodes at the tip are opposite each other; moved far around the blade for that, cells fold."""
    profiles = [blade_row.profile(r, s) for r, s in zip((1.95, 2.3, 2.7, 3.02), staggers, strict=True)]
    row = Row(tuple(profiles), blade_row.HUB, blade_row.SHROUD, 12, tip_gap=0.025)
    quality = make_row(row, RowRequest(first_cell=FIRST, cells=20_000)).grid.quality()
    assert quality.folded == 0
    assert quality.metrics["scaled_jacobian"].min > 0.2


@pytest.mark.parametrize(
    ("gap", "ends"), [("none", set()), ("tip", {"tip"}), ("hub", {"foot"})], ids=["none", "tip", "hub"]
)
def test_patches_have_their_names_and_nothing_is_without(gap: str, ends: set[str]) -> None:
    grid = made(gap)
    names = {"blade", "hub", "shroud", "inlet", "outlet"} | ends
    assert {patch.name for patch in grid.outer_patches()} == names
    assert {patch.name for patch in grid.patches} == names | {"periodic1", "periodic2"}


@pytest.mark.parametrize("gap", GAPS)
def test_first_cells_have_their_height_in_space_at_every_wall(gap: str) -> None:
    grid = made(gap)
    wanted = FIRST * blade_row.blade_row().chord
    for name in {patch.name for patch in grid.outer_patches()} - {"inlet", "outlet"}:
        assert blade_row.off_walls(grid, name) == pytest.approx(wanted, rel=1e-9), name


def test_the_second_periodic_side_is_the_first_turned_by_the_pitch() -> None:
    grid = made("tip")
    periodic = [each for each in grid.connections if each.transform]
    assert periodic
    angle = 2.0 * math.pi / blade_row.BLADES
    for each in periodic:
        own, donor = (face.reshape(-1, 3) for face in each.reversed().reversed().nodes(grid.face))
        first = grid.face(each.block, each.side).reshape(-1, 3)
        turned = np.arctan2(donor[:, 1], donor[:, 2]) - np.arctan2(first[:, 1], first[:, 2])
        radius = np.hypot(donor[:, 1], donor[:, 2])
        if len(first) == len(donor) and np.allclose(np.abs(turned), angle):
            assert np.abs(turned) == pytest.approx(angle, abs=1e-13)
        assert np.abs(own - donor).max() <= 1e-14 * radius.max()


def test_hub_casing_inlet_and_outlet_are_where_their_curves_are() -> None:
    grid = made("tip")
    for name, curve in (("hub", blade_row.HUB), ("shroud", blade_row.SHROUD)):
        x, y, z = np.concatenate([grid.at(p).reshape(-1, 3) for p in grid.patches if p.name == name]).T
        slope = (curve[-1, 1] - curve[0, 1]) / (curve[-1, 0] - curve[0, 0])
        assert np.hypot(y, z) == pytest.approx(curve[0, 1] + slope * (x - curve[0, 0]), abs=1e-12)
    for name, x in (("inlet", -1.0), ("outlet", 2.0)):
        nodes = np.concatenate([grid.at(p).reshape(-1, 3) for p in grid.patches if p.name == name])
        assert nodes[:, 0] == pytest.approx(x, abs=1e-12)


@pytest.mark.parametrize("gap", ["none", "tip"])
def test_the_blade_is_the_bent_ellipse_of_its_profiles(gap: str) -> None:
    grid = made(gap)
    x, y, z = np.concatenate([grid.at(p).reshape(-1, 3) for p in grid.patches if p.name == "blade"]).T
    r = np.hypot(y, z)
    stagger = np.radians(20.0 * (r - 1.0))
    along, across = x - 0.5, r * np.arctan2(y, z)
    a = along * np.cos(stagger) + across * np.sin(stagger)
    b = across * np.cos(stagger) - along * np.sin(stagger) - 0.06 * (1.0 - 4.0 * a * a)
    assert np.hypot(a / 0.5, b / 0.04) == pytest.approx(1.0, abs=0.02)  # of half the thickness


def test_the_gap_has_rows_enough_and_narrow_ones_lower_first_cells_and_say_so() -> None:
    result = make_row(
        blade_row.blade_row(0.005), RowRequest(first_cell=FIRST, cells=20_000, threads=1, allow_invalid=True)
    )
    assert blade_row.off_walls(result.grid, "tip") == pytest.approx(0.005 / 17, rel=1e-9)
    assert any("first cells at the walls of a gap are" in note for note in result.notes)
    tip = next(p for p in result.grid.patches if p.name == "tip")
    assert result.grid.blocks[tip.block].counts[2] >= 18


def test_more_cells_than_asked_for_are_said_with_the_number_that_growth_needs() -> None:
    result = make_row(blade_row.blade_row(), RowRequest(first_cell=FIRST, cells=20_000, threads=1))
    (note,) = (each for each in result.notes if "instead of 20000" in each)
    needed = int(re.search(r"need about (\d+)$", note)[1])  # type: ignore[index]
    assert cells_of(result.grid) == pytest.approx(needed, rel=0.15)


@pytest.mark.parametrize(
    ("row", "cells"), [(radial_rows.eckardt(), 500_000), (radial_rows.diffuser(7), 250_000)]
)
def test_there_are_about_as_many_cells_as_asked_for(row: Row, cells: int) -> None:
    result = make_row(row, RowRequest(first_cell=1e-3, cells=cells, threads=1))
    assert cells_of(result.grid) == pytest.approx(cells, rel=0.15)
    assert not any("instead of" in note and "cells in a passage" in note for note in result.notes)


def cells_of(grid: Grid) -> int:
    return sum(math.prod(n - 1 for n in block.counts) for block in grid.blocks)


@pytest.mark.parametrize("gap", GAPS)
def test_cells_grow_by_a_limited_ratio_along_lines_inside_blocks(gap: str) -> None:
    ratios = []
    for block in made(gap).blocks:
        for axis in range(3):
            steps = np.moveaxis(np.linalg.norm(np.diff(block.nodes, axis=axis), axis=-1), axis, 0)
            ratios.append((steps[1:] / steps[:-1]).ravel())
    growth = np.exp(np.abs(np.log(np.concatenate(ratios))))
    assert np.percentile(growth, 99.9) < (1.25 if gap == "none" else 1.3)
    assert growth.max() < (1.3 if gap == "none" else 1.5)


def test_lines_behind_the_blade_bend_into_the_direction_of_its_mean_line() -> None:
    """Halfway up that is the stagger of 29 degrees, less 13 at the end of the arc."""
    row = blade_row.blade_row()
    keys = key_tables(row, FIRST, 1.2, 1500)
    section = keys.sections[len(keys.sections) // 2]
    edge, end = section.plane.edges[1, 0], section.plane.map.length
    m = np.linspace(0.0, end, 2001)
    line = keys.plan.bent(section.plane, np.stack([m, np.zeros_like(m)], axis=1))
    assert (line[m < edge, 1] == 0.0).all()
    slope = np.gradient(line[:, 1], m)
    assert slope[-20:] == pytest.approx(math.tan(math.radians(16.0)), abs=0.05)
    assert np.abs(np.diff(slope)).max() < 0.01


def test_bits_do_not_depend_on_the_number_of_threads() -> None:
    one, two = made("none", 1), made("none", 2)
    assert all(np.array_equal(a.nodes, b.nodes) for a, b in zip(one.blocks, two.blocks, strict=True))


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"around": 65}, "a row has no around"),
        ({"cells": 5}, "cells: 5 cells; use 20000"),
        ({"first_cell": 0.2}, "first_cell: 0.2 chords"),
        ({"threads": 0}, "threads: 0 threads"),
        ({"growth": 0.5}, "growth"),
    ],
)
def test_parameters_out_of_range_are_refused(parameters, words: str) -> None:
    with pytest.raises(InputError, match=words):
        RowRequest.of(**parameters)
