"""The reference length of the Reynolds number of every kind of grid that takes y+."""

import numpy as np
import pytest

import meshonet
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.y_plus import first_cell


def test_a_length_replaces_the_extent_of_holes() -> None:
    box = np.array([[0.0, 0.0], [8.0, 0.0], [8.0, 6.0], [0.0, 6.0]])
    turn = 2 * np.pi * np.arange(60) / 60
    domain = meshonet.Domain.of_polygons([box, np.stack([4 + np.cos(turn), 3 + np.sin(turn)], axis=1)])
    made = [
        meshonet.grid(domain, y_plus=5, reynolds=1e5, length=length, cells=2000)
        for length in (None, 2.0, 0.5)
    ]
    first, same, other = (least_step(grid) for grid in made)
    assert first == pytest.approx(first_cell(5, 1e5) * 2.0, rel=1e-6)  # the extent of the hole
    assert same == pytest.approx(first, rel=1e-6)
    assert other == pytest.approx(first / 4.0, rel=1e-6)


def test_a_length_is_in_chords_around_bodies_and_in_the_unit_of_a_four_sided_domain() -> None:
    body = meshonet.grid("naca:0012", y_plus=50, reynolds=1e5, length=0.5, res=(61, 31))
    assert off_wall(body) == pytest.approx(0.5 * first_cell(50, 1e5), rel=1e-6)
    duct = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]])
    for length, unit in ((None, 4.0), (0.25, 0.25)):
        grid = meshonet.grid(duct, y_plus=50, reynolds=1e5, length=length, res=(41, 41))
        assert off_wall(grid) == pytest.approx(unit * first_cell(50, 1e5), rel=1e-6)


def test_a_length_is_in_longest_chords_of_a_stack() -> None:
    section = meshonet.read("naca:0012")
    wing = meshonet.Stack((meshonet.Section(section, 2.0, 0.0), meshonet.Section(section, 1.0, 4.0)))
    made = {
        length: meshonet.stack(
            wing, around=49, span=9, layers=18, y_plus=90, reynolds=1e5, length=length, far_field=5
        )
        for length in (None, 0.5)
    }
    first, half = (
        np.hypot(*np.moveaxis(np.diff(g.blocks[0].nodes, axis=2)[:, :, 0, :2], -1, 0)) for g in made.values()
    )
    assert half.min() < 0.6 * first.min()


def test_a_length_needs_y_plus_and_is_positive() -> None:
    with pytest.raises(InputError, match="y_plus"):
        meshonet.grid("naca:0012", first_cell=1e-3, length=2.0)
    with pytest.raises(InputError, match="positive"):
        meshonet.grid("naca:0012", y_plus=1, reynolds=1e6, length=-2.0)


def off_wall(grid: meshonet.Grid) -> float:
    """The mean first-cell height at the south of a block."""
    return float(np.hypot(*np.moveaxis(grid.nodes[:, 1] - grid.nodes[:, 0], -1, 0)).mean())


def least_step(grid: meshonet.Grid) -> float:
    """The shortest step along grid lines, which is that off walls."""
    steps = [
        np.hypot(*np.moveaxis(np.diff(b.nodes, axis=a), -1, 0)).min() for b in grid.blocks for a in (0, 1)
    ]
    return float(min(steps))
