"""Grids evaluated from a coarse solve: their edges, their distance to the full solve, what is refused."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline
from solver_shapes import arch, bump, folded, hexagon, hole, meets, naca, quad, seamount, wrench

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import measure
from meshonet.solvers.algebraic.resample.grids import divided, refine_grid, thinned
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.energy.variational import solve as variational
from meshonet.solvers.pipeline.coarse import solve_coarse
from meshonet.solvers.solution import Solution


def error(nodes: np.ndarray, reference: np.ndarray) -> float:
    """Relative L2 distance, free of the origin."""
    spread = reference - reference.mean(axis=(0, 1))
    return float(np.linalg.norm(nodes - reference) / np.linalg.norm(spread))


@pytest.mark.parametrize("make", [arch, hexagon, bump, wrench, hole, naca])
@pytest.mark.parametrize(("ni", "nj", "n"), [(200, 100, 33), (101, 150, 40), (65, 20, 33)])
def test_edges_are_those_given(make, ni: int, nj: int, n: int) -> None:  # type: ignore[no-untyped-def]
    boundary: Boundary = make(ni, nj)
    nodes = solve_coarse(boundary, solve, n, smooth=True).grid.nodes
    assert meets(nodes, boundary)


# about twice what they are; transfinite interpolation has 0.05 to 0.8
LIMITS = [(arch, 2e-3, 5e-4), (seamount, 2e-3, 5e-4), (hexagon, 6e-3, 3e-3), (bump, 4e-3, 1.5e-3)]


@pytest.mark.parametrize(("make", "from_33", "from_65"), [*LIMITS, (hole, 1.5e-2, 5e-3), (naca, 2e-2, 6e-3)])
def test_it_is_near_the_full_solve_and_nearer_from_more_nodes(make, from_33, from_65) -> None:  # type: ignore[no-untyped-def]
    boundary = make(257, 257)
    reference = solve(boundary, tol=1e-8).grid.nodes
    errors = []
    for n in (33, 65):
        nodes = solve_coarse(boundary, solve, n, smooth=True).grid.nodes
        assert folded(nodes) == 0
        errors.append(error(nodes, reference))
    assert errors[0] < from_33
    assert errors[1] < from_65
    assert errors[1] < 0.6 * errors[0]


def test_away_from_edges_it_is_the_spline_of_the_nodes() -> None:
    """The formula by scipy, on counts that thin exactly."""
    boundary = arch(97, 65)
    solved = solve(thinned(boundary, 33, 17)).grid.nodes
    ends = [np.linspace(0, 1, n) for n in (33, 17, 97, 65)]
    splines = [RectBivariateSpline(*ends[:2], solved[..., c], s=0)(*ends[2:]) for c in (0, 1)]
    off = np.abs(refine_grid(solved, boundary) - np.stack(splines, axis=-1))
    assert off[15:-15, 20:-20].max() < 1e-12
    assert 1e-7 < off.max() < 1e-4


def test_sweeps_around_kinks_come_nearer_to_the_solution() -> None:
    boundary = bump(401, 401)
    full = solve(boundary, tol=1e-6).grid
    plain, swept = (solve_coarse(boundary, solve, 65, smooth=smooth).grid for smooth in (False, True))
    assert error(swept.nodes, full.nodes) < 0.7 * error(plain.nodes, full.nodes)
    highest = [measure(grid)["max_angle"].max for grid in (full, swept, plain)]
    assert highest[1] < highest[0] + 1 < highest[2]


def test_a_kink_of_an_edge_between_coarse_nodes_is_met_and_forgotten_inside() -> None:
    """Further from it than two coarse steps nodes are those of the grid without the kink."""
    t = np.linspace(0, 1, 101)
    x, y = np.meshgrid(t, t, indexing="ij")
    even = np.stack([x, y], axis=-1)
    kinked = even.copy()
    kinked[:, 0, 1] -= 0.02 * np.maximum(0.0, 1.0 - np.abs(100 * t - 50) / 2)
    boundary = quad(kinked[:, 0], kinked[:, -1], kinked[0], kinked[-1])
    result = refine_grid(even[::4, ::4], boundary)
    assert result[50, 0, 1] == -0.02
    assert 0.004 < np.abs(result - even)[50, 4].max() < 0.016
    np.testing.assert_allclose(result[:, 8:], even[:, 8:], atol=1e-12)


def test_no_fewer_nodes_than_asked_for_is_the_method_itself() -> None:
    boundary = arch(33, 20)
    assert np.array_equal(
        solve_coarse(boundary, solve, 33, smooth=True).grid.nodes, solve(boundary).grid.nodes
    )


def test_a_direction_with_few_nodes_keeps_them() -> None:
    seen = []

    def spy(boundary: Boundary) -> Solution:
        seen.append((boundary.ni, boundary.nj))
        return solve(boundary)

    solve_coarse(arch(200, 20), spy, 33, smooth=True)
    assert seen == [(33, 20)]


def test_provenance_name_and_parts_are_kept() -> None:
    grid = solve_coarse(arch(100, 100), solve, 33, smooth=True).grid
    assert grid.provenance["coarse"] == (33, 33)
    assert grid.provenance["method"] == "winslow"
    assert grid.name == "arch"
    assert grid.patches == Grid.from_nodes(grid.nodes).patches


def test_too_few_coarse_nodes_are_refused() -> None:
    with pytest.raises(InputError, match="8 coarse nodes along a direction are too few; use at least 9"):
        solve_coarse(arch(100, 100), solve, 8, smooth=True)


def test_straight_lines_keep_valid_cells_valid() -> None:
    fine = wrench(97, 65)
    coarse = variational(thinned(fine, 13, 9)).grid.nodes
    nodes = divided(coarse, fine)
    np.testing.assert_allclose(nodes[8:-8:8, 8:-8:8], coarse[1:-1, 1:-1], atol=1e-12)
    np.testing.assert_array_equal(nodes[:, 0], fine.south)
    np.testing.assert_array_equal(nodes[-1], fine.east)
    assert folded(nodes[8:-8, 8:-8]) == 0


def test_what_kinks_fold_sweeps_unfold() -> None:
    from meshonet.solvers.energy.variational import solve as minimise

    boundary = wrench(400, 400)
    assert folded(solve_coarse(boundary, minimise, 65, smooth=True).grid.nodes) == 0


@pytest.mark.parametrize("shape", [wrench, hexagon, bump])
def test_kinks_of_a_variational_grid_are_relaxed_where_its_largest_angle_gains(
    shape: Callable[[int, int], Boundary],
) -> None:
    plain, relaxed = (
        measure(solve_coarse(shape(400, 400), variational, 65, smooth=smooth).grid)["max_angle"].max
        for smooth in (False, True)
    )
    assert relaxed <= plain
    if shape is wrench:
        assert relaxed < plain - 0.5
