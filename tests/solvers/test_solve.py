"""Winslow's solver against conformal maps, plain numpy and its own promises."""

import numpy as np
import pytest
from solver_shapes import arch, corner_jacobians, folded, hexagon, hole, naca, quad, spike, wrench
from winslow_reference import residual, root_mean_square

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic import solve as module
from meshonet.solvers.elliptic.solve import solve


def conformal_quad(ni: int, nj: int) -> np.ndarray:
    """Nodes of z = exp ζ over a rectangle: ξ and η are harmonic, so this is the exact solution."""
    zeta = np.linspace(0, 1.5, ni)[:, None] + 1j * np.linspace(0, 1, nj)
    z = np.exp(zeta)
    return np.stack([z.real, z.imag], axis=-1)


def conformal_ring(ni: int, nj: int) -> np.ndarray:
    """Nodes of a Möbius image of an annulus: two circles that do not share their centre."""
    zeta = np.exp(np.linspace(0, 1, nj)[None, :] - 2j * np.pi * np.linspace(0, 1, ni)[:, None])
    z = zeta / (1 - 0.15 * zeta)
    nodes = np.stack([z.real, z.imag], axis=-1)
    nodes[-1] = nodes[0]
    return nodes


def edges_of(nodes: np.ndarray, periodic: bool) -> Boundary:
    return Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1], "o" if periodic else "quad")


def relative_residual(boundary: Boundary, nodes: np.ndarray) -> float:
    """Residual over that of the transfinite interpolation, by the numpy reference."""
    start = tfi(boundary).nodes
    if boundary.topology == "o":
        nodes, start = (np.concatenate([n, n[1:2]]) for n in (nodes, start))
    return root_mean_square(residual(nodes)) / root_mean_square(residual(start))


@pytest.mark.parametrize(("exact", "periodic"), [(conformal_quad, False), (conformal_ring, True)])
def test_error_against_a_conformal_map_is_of_second_order(exact, periodic) -> None:  # type: ignore[no-untyped-def]
    counts = np.array([17, 33, 65, 129])
    errors = []
    for n in counts:
        nodes = exact(2 * n - 1, n)
        result = solve(edges_of(nodes, periodic), tol=1e-10).grid.nodes
        errors.append(np.abs(result - nodes).max())
    slope = -np.polyfit(np.log(counts - 1), np.log(errors), 1)[0]
    assert 1.9 < slope < 2.3
    assert errors[-1] < 1e-3


SIZES = [(100, 100), (101, 37), (128, 129), (300, 60), (17, 5), (3, 3), (2, 5), (5, 2)]


@pytest.mark.parametrize("make", [arch, hexagon, wrench])
@pytest.mark.parametrize(("ni", "nj"), SIZES)
def test_any_counts_reach_the_tolerance(make, ni: int, nj: int) -> None:  # type: ignore[no-untyped-def]
    boundary = make(ni, nj)
    solution = solve(boundary, tol=1e-8)
    assert solution.residual is not None
    assert solution.residual <= 1e-8
    assert solution.method == "winslow"
    if min(ni, nj) > 3:
        assert relative_residual(boundary, solution.grid.nodes) <= 1.01e-8
    assert np.array_equal(solution.grid.nodes[:, 0], boundary.south)
    assert np.array_equal(solution.grid.nodes[:, -1], boundary.north)
    assert np.array_equal(solution.grid.nodes[0], boundary.west)
    assert np.array_equal(solution.grid.nodes[-1], boundary.east)


@pytest.mark.parametrize("make", [naca, hole])
@pytest.mark.parametrize(("ni", "nj"), [(100, 100), (101, 37), (130, 33), (33, 9)])
def test_rings_reach_the_tolerance_and_stay_closed(make, ni: int, nj: int) -> None:  # type: ignore[no-untyped-def]
    boundary = make(ni, nj)
    nodes = solve(boundary, tol=1e-8).grid.nodes
    assert relative_residual(boundary, nodes) <= 1.01e-8
    assert np.array_equal(nodes[0], nodes[-1])
    assert np.array_equal(nodes[:, 0], boundary.south)
    assert np.array_equal(nodes[:, -1], boundary.north)


@pytest.mark.parametrize("make", [arch, hexagon, wrench, hole, naca])
def test_default_stop_leaves_less_error_than_the_discretisation(make) -> None:  # type: ignore[no-untyped-def]
    n = 129
    stopped = solve(make(n, n)).grid.nodes
    converged = solve(make(n, n), tol=1e-10, max_cycles=60).grid.nodes
    coarser = solve(make((n + 1) // 2, (n + 1) // 2), tol=1e-10, max_cycles=60).grid.nodes
    algebraic = root_mean_square(stopped - converged)
    discretisation = (
        root_mean_square(coarser - converged[::2, ::2]) / 3
    )  # second order: e(2h) - e(h) = 3 e(h)
    assert algebraic < discretisation


def test_smooth_shapes_come_out_without_folded_cells() -> None:
    for boundary in (arch(100, 60), hexagon(101, 80), hole(120, 60), naca(160, 60)):
        assert folded(solve(boundary).grid.nodes) == 0
        assert (corner_jacobians(tfi(boundary).nodes) > 0).any()


def test_the_solution_does_not_depend_on_the_start() -> None:
    boundary = arch(60, 40)
    nested = solve(boundary, tol=1e-9)
    from_tfi = solve(boundary, tol=1e-9, initial=tfi(boundary, "linear"))
    np.testing.assert_allclose(from_tfi.grid.nodes, nested.grid.nodes, atol=1e-8)


def test_a_solved_grid_as_start_needs_no_cycle() -> None:
    boundary = arch(60, 40)
    first = solve(boundary, tol=1e-9)
    again = solve(boundary, tol=1e-8, initial=first.grid)
    assert again.cycles == 0
    np.testing.assert_array_equal(again.grid.nodes, first.grid.nodes)


def test_a_rectangle_is_already_solved() -> None:
    t = np.linspace(0, 1, 9)
    zero, one = np.zeros(9), np.ones(9)
    boundary = quad(*(np.stack(edge, axis=1) for edge in ((t, zero), (t, one), (zero, t), (one, t))))
    solution = solve(boundary)
    np.testing.assert_allclose(solution.grid.nodes, tfi(boundary).nodes, atol=1e-15)


def test_turning_moving_and_scaling_the_boundary_turns_moves_and_scales_the_grid() -> None:
    boundary = hexagon(60, 50)
    turn = 1e3 * np.array([[0.6, 0.8], [-0.8, 0.6]])
    moved = quad(*(getattr(boundary, side) @ turn + 7.0 for side in ("south", "north", "west", "east")))
    np.testing.assert_allclose(solve(moved).grid.nodes, solve(boundary).grid.nodes @ turn + 7.0, atol=1e-7)


@pytest.mark.parametrize("bad", [{"tol": 0.0}, {"tol": 2.0}, {"max_cycles": 0}])
def test_senseless_limits_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(InputError, match=r"tolerance|cycles"):
        solve(arch(9, 9), **bad)  # type: ignore[arg-type]


def test_an_initial_grid_of_other_counts_is_refused() -> None:
    with pytest.raises(InputError, match="the initial grid has 9x9 nodes, not 9x8"):
        solve(arch(9, 8), initial=tfi(arch(9, 9)))


def test_divergence_is_tried_again_and_told(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = module.Multigrid.cycle
    calls = []

    def spoiled(self: module.Multigrid, k: int = 0, forced: bool = False) -> float:
        correction = honest(self, k, forced)
        if k == 0 and self.settings == module.ATTEMPTS[0]:
            calls.append(k)
            self.levels[0].x[1, 1] = np.nan
        return correction

    monkeypatch.setattr(module.Multigrid, "cycle", spoiled)
    solution = solve(arch(100, 100))
    assert calls == [0]
    assert "diverged" in solution.notes[0]
    assert folded(solution.grid.nodes) == 0


def test_divergence_from_every_start_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def spoiled(self: module.Multigrid, k: int = 0, forced: bool = False) -> float:
        self.levels[0].x[1, 1] = np.inf
        return 1.0

    monkeypatch.setattr(module.Multigrid, "cycle", spoiled)
    with pytest.raises(SolverError, match=r"diverged from every start .* use more nodes, variational or tfi"):
        solve(arch(100, 100))


@pytest.mark.parametrize("n", [101, 200])
def test_a_spike_that_one_sweep_diverges_on_is_solved_by_more(n: int) -> None:
    solution = solve(spike(n, n), tol=1e-8, max_cycles=60)
    assert "diverged" in solution.notes[0]
    assert solution.residual is not None
    assert solution.residual <= 1e-8


def test_cycles_that_do_not_reach_the_tolerance_are_told() -> None:
    solution = solve(wrench(100, 100), tol=1e-10, max_cycles=4)
    assert solution.cycles == 4
    assert solution.notes == (f"stopped after 4 cycles at residual {solution.residual:.1e}, short of 1e-10",)


def test_a_far_from_valid_start_still_ends_at_the_solution() -> None:
    boundary = arch(65, 65)
    rng = np.random.default_rng(3)
    start = tfi(boundary).nodes + rng.normal(0, 0.05, (65, 65, 2))
    result = solve(boundary, tol=1e-8, max_cycles=60, initial=Grid.from_nodes(start)).grid.nodes
    np.testing.assert_allclose(result, solve(boundary, tol=1e-8).grid.nodes, atol=1e-6)


@pytest.mark.parametrize("offset", [0.0, 1e4])
@pytest.mark.parametrize("tol", [None, 1e-10])
def test_a_rectangle_is_solved_by_its_interpolation_wherever_it_lies(
    tol: float | None, offset: float
) -> None:
    side = np.linspace(0, 1, 12) + offset
    low, high = np.full(12, offset), np.full(12, offset + 1)
    rectangle = Boundary(
        np.stack([side, low], 1),
        np.stack([side, high], 1),
        np.stack([low, side], 1),
        np.stack([high, side], 1),
    )
    solution = solve(rectangle, tol=tol)
    assert solution.cycles == 0
    np.testing.assert_allclose(solution.grid.x, np.broadcast_to(side[:, None], (12, 12)), rtol=1e-13)


@pytest.mark.parametrize(
    ("corner", "size", "counts"),
    [((3.3, 3.3), (2, 1), (5, 37)), ((3.3, 3.3), (1, 1), (41, 9)), ((-100.0, 7.0), (1, 1), (41, 5))],
)
def test_interpolation_solves_a_rectangle_wherever_it_lies(
    corner: tuple[float, float], size: tuple[float, float], counts: tuple[int, int]
) -> None:
    """Its residual is round-off, which no cycle reduces: the solver must not count it as divergence."""
    x, y = (np.linspace(a, a + h, n) for a, h, n in zip(corner, size, counts, strict=True))
    box = edges_of(np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1), periodic=False)
    assert solve(box).cycles == 0
