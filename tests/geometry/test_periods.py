"""Periods of grids: angle or shift, and how far nodes are apart after it."""

import numpy as np
import pytest

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.copies import copied
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.revolve import AxisLine, Revolution, revolved
from meshonet.geometry.quality.periodic import periods


def sector(degrees: float, axis: AxisLine | None = None) -> Grid:
    x, r = np.meshgrid(np.linspace(0.0, 2.0, 4), [1.0, 1.4, 2.0], indexing="ij")
    flat = Grid((Block(np.stack([x, r], axis=-1)),))
    return revolved(flat, Revolution(degrees, 5, axis or AxisLine()))


@pytest.mark.parametrize("axis", [None, AxisLine(0.0, -3.0, 1.0, 0.2)])
@pytest.mark.parametrize("degrees", [360.0 / 7, 33.0])
def test_a_turn_has_its_angle_and_no_mismatch(degrees: float, axis: AxisLine | None) -> None:
    (period,) = periods(sector(degrees, axis))
    assert (period.angle, period.shift) == (pytest.approx(degrees, rel=1e-14), 0.0)
    assert period.mismatch < 2e-15
    (doubled,) = periods(copied(sector(degrees, axis), 2))
    assert doubled.angle == pytest.approx(2.0 * degrees, rel=1e-14)


def test_an_angle_that_is_not_quite_a_part_of_the_turn_is_a_mismatch() -> None:
    nodes, angle = sector(30.0).nodes.copy(), np.radians(30.0) * (1.0 + 1e-10)
    c, s = np.cos(angle), np.sin(angle)
    motion = Motion((), ((1.0, 0.0, 0.0), (0.0, c, -s), (0.0, s, c)))
    nodes[:, :, -1] = motion(nodes[:, :, 0])
    whole = tuple((0, n - 1) for n in nodes.shape[:2])
    joined = Connection(0, "bottom", whole, 0, "top", whole, (1, 2), motion)
    (period,) = periods(Grid((Block(nodes),), (), (joined,)))
    assert period.mismatch == pytest.approx(np.radians(30.0) * 1e-10, rel=1e-4)


def test_a_shift_has_its_length() -> None:
    line = np.stack([np.linspace(0.0, 1.0, 6), 0.1 * np.sin(np.arange(6.0))], axis=-1)
    nodes = np.stack([line, line + np.array([0.1, 0.2]), Motion((0.3, 0.4))(line)], axis=1)
    ends = (0, "south", ((0, 5),)), (0, "north", ((0, 5),))
    grid = Grid((Block(nodes),), (), (Connection(*ends[0], *ends[1], (1,), Motion((0.3, 0.4))),))
    (period,) = periods(grid)
    assert (period.angle, period.shift) == (0.0, pytest.approx(0.5, rel=1e-15))
    assert period.along == pytest.approx((0.6, 0.8, 0.0))
    assert period.mismatch < 1e-15


def test_a_grid_without_periodic_sides_has_no_period() -> None:
    assert periods(sector(360.0)) == ()
