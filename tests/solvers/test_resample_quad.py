"""A valid grid on few nodes stays valid when it is evaluated at many; a smooth one is met to fourth order."""

import numpy as np
import pytest
from random_quads import random_quad

from meshonet.geometry.arrays import Floats
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.resample.grids import thinned
from meshonet.solvers.algebraic.resample.quad import mended, refine_quad
from meshonet.solvers.energy.variational import solve
from meshonet.solvers.neural.quad.coarse_grids import rims, sides_of


def planes(nodes: Floats) -> Floats:
    return np.ascontiguousarray(np.moveaxis(nodes, -1, 0))


def smooth(n: int) -> Floats:
    """Return planes (2, n, n) of a grid between four curves."""
    xi, eta = np.meshgrid(np.linspace(0, 1, n), np.linspace(0, 1, n), indexing="ij")
    return np.array([xi + 0.2 * np.sin(2 * eta + xi), eta * (1 + 0.3 * xi**2) + 0.1 * np.cos(3 * xi)])


def bunched(n: int, ratio: float) -> Floats:
    """Return planes (2, n, n) whose lines along xi stand far apart but for two pairs of them."""
    xi, eta = np.meshgrid(np.linspace(0, 1, n), np.arange(n, dtype=float), indexing="ij")
    steps = np.full(n - 1, 1.0)
    steps[[n // 2, n // 2 + 1]] = ratio
    return np.array([100 * xi, np.concatenate([[0.0], np.cumsum(steps)])[eta.astype(int)]])


def straight_edges(coarse: Floats, n: int) -> list[Floats]:
    """Return sides (1, 2, n) that are straight between the nodes of a grid's rim."""
    at = np.linspace(0, coarse.shape[1] - 1, n)
    knots = np.arange(coarse.shape[1])
    return [np.array([[np.interp(at, knots, row) for row in rim]]) for (rim,) in rims(coarse[None])]


def test_smooth_grids_are_met_to_fourth_order() -> None:
    full = smooth(129)
    sides = rims(full[None])
    errors = [
        np.abs(refine_quad(np.ascontiguousarray(full[None, :, ::step, ::step]), sides) - full).max()
        for step in (16, 8, 4)
    ]
    assert np.log2(errors[0] / errors[1]) > 3.5
    assert np.log2(errors[1] / errors[2]) > 3.5


@pytest.mark.parametrize("ratio", [0.5, 0.01])
def test_lines_become_straight_where_a_spline_would_fold(ratio: float) -> None:
    coarse = bunched(17, ratio)
    sides = straight_edges(coarse, 65)
    (nodes,) = refine_quad(coarse[None], (sides[0], sides[1], sides[2], sides[3]))
    assert count_folded(np.moveaxis(nodes, 0, -1)) == 0
    swing = nodes[1, 32] - np.interp(np.linspace(0, 16, 65), np.arange(17), coarse[1, 8])
    assert (np.abs(swing[32:41]).max() < 1e-12) == (ratio < 0.1)


@pytest.mark.parametrize("seed", [30056, 30291])
def test_a_valid_variational_grid_between_narrow_walls_stays_valid(seed: int) -> None:
    boundary = random_quad(seed, 193, 193)
    assert boundary is not None
    coarse = solve(thinned(boundary, 33, 33)).grid.nodes
    assert count_folded(coarse) == 0
    (nodes,) = refine_quad(planes(coarse)[None], sides_of([boundary]))
    assert count_folded(np.moveaxis(nodes, 0, -1)) == 0


def test_folded_grids_are_left_as_splines_make_them() -> None:
    coarse = bunched(17, -0.5)
    sides = straight_edges(coarse, 65)
    (nodes,) = refine_quad(coarse[None], (sides[0], sides[1], sides[2], sides[3]))
    before = nodes.copy()
    assert mended(coarse, tuple(side[0] for side in sides), nodes) is None
    assert np.array_equal(nodes, before)


@pytest.mark.parametrize("m", [3, 4, 9, 17])
def test_what_memory_held_before_does_not_matter(m: int) -> None:
    coarse = smooth(m)
    sides = tuple(straight_edges(coarse, 33))
    expected = refine_quad(coarse[None], sides)
    sizes = np.random.default_rng(0).integers(100, 20000, 60)
    for _ in range(10):
        held = [np.full(size, np.nan) for size in sizes]
        del held
        np.testing.assert_array_equal(refine_quad(coarse[None], sides), expected)
