"""Sizes of cells along lines of a level, and along lines beyond a tip."""

import numpy as np
from aircraft_shapes import body

from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.level_lines import lines_between, ways_between
from meshonet.solvers.aircraft.tip_cells import arcs_beyond
from meshonet.solvers.rows.span_spacing import smooth_cells

MOST = 1.25


def test_cells_on_lines_that_rise_steeply_are_even_in_space() -> None:
    space = BodyMap(body(), 30.0)
    theta = np.linspace(1.2, 2.8, 5)
    begin = np.stack([np.full(5, 5.0), theta, np.full(5, 0.05)], axis=1)
    end = np.stack([np.full(5, 7.0), theta - 0.2, np.full(5, 0.3)], axis=1)
    sizes = np.full(5, 0.08), np.full(5, 0.05)
    cells = smooth_cells(*ways_between(space.points, begin, end, sizes), MOST, 6)
    nodes = lines_between(space.points, begin, end, sizes, cells)
    assert np.array_equal(nodes[:, 0], begin)
    assert np.array_equal(nodes[:, -1], end)
    steps = np.linalg.norm(np.diff(space.points(nodes), axis=1), axis=-1)
    ratios = steps[:, 1:] / steps[:, :-1]
    assert np.maximum(ratios, 1.0 / ratios).max() < 1.1 * MOST


def test_first_cells_beyond_a_tip_are_as_given_and_lines_are_filled() -> None:
    lengths, first = np.array([10.0, 11.0, 12.0]), np.array([1e-4, 1e-3, 1e-2])
    arcs = arcs_beyond(lengths, first, 60)
    assert np.abs(arcs[:, -1] - lengths).max() == 0.0
    assert np.abs(arcs[:, 1] / first - 1.0).max() < 1e-9
    steps = np.diff(arcs)
    assert (steps[:, 1:] >= steps[:, :-1]).all()


def test_levels_beyond_a_tip_are_parallel_where_cells_are_larger_than_first_ones() -> None:
    arcs = arcs_beyond(np.array([10.0, 10.0]), np.array([1e-4, 5e-3]), 60)
    thin, thick = np.diff(arcs)
    larger = thin > 2.0 * 5e-3
    assert larger.sum() > 15
    assert np.abs(thick[larger] / thin[larger] - 1.0).max() < 0.1
