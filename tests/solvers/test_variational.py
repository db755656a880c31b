"""Variational grids: valid, never worse than Winslow's in angle, the same on finer meshes."""

from functools import partial

import numpy as np
import pytest
from functional_reference import energy
from random_quads import random_quad
from solver_shapes import (
    arch,
    bump,
    circle,
    folded,
    hexagon,
    hole,
    naca,
    quad,
    ring,
    seamount,
    segment,
    wrench,
)

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.families.bodies import boundary as random_body
from meshonet.geometry.quality.measure import Summary, measure
from meshonet.geometry.shapes.airfoil.naca import naca as naca_section
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.resample.grids import thinned
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.energy import descent as descent_module
from meshonet.solvers.energy import variational as module
from meshonet.solvers.energy.descent import descend, stiffness_of
from meshonet.solvers.energy.functional import Weights, aspect_of
from meshonet.solvers.energy.untangle import unfold
from meshonet.solvers.energy.variational import solve, winslow_start
from meshonet.solvers.pipeline.coarse import solve_coarse


def angle(nodes: Floats) -> Summary:
    return measure(Grid.from_nodes(nodes))["max_angle"]


def never_worse(result: Floats, reference: Floats) -> None:
    assert folded(result) == 0
    assert angle(result).max <= angle(reference).max + 1e-9
    assert angle(result).mean <= angle(reference).mean


# mean angle gained at least, in degrees: nine tenths of what the functional's minimum gains at 65x65
GAINS = [(arch, 5.6), (hexagon, 7.1), (bump, 4.8), (wrench, 12.0), (seamount, 6.0)]


@pytest.mark.parametrize(("make", "gain"), GAINS)
@pytest.mark.parametrize("n", [65, 100])
def test_angles_are_better_than_winslows(make, gain: float, n: int) -> None:  # type: ignore[no-untyped-def]
    boundary: Boundary = make(n, n)
    reference, result = winslow(boundary).grid.nodes, solve(boundary).grid.nodes
    never_worse(result, reference)
    assert angle(result).mean < angle(reference).mean - gain
    for side, edge in (("south", result[:, 0]), ("north", result[:, -1]), ("west", result[0])):
        assert np.array_equal(edge, getattr(boundary, side))


@pytest.mark.parametrize("n", [300, 400])
def test_kinks_do_not_reach_into_large_grids(n: int) -> None:
    boundary = hexagon(n, n)
    solution, reference = solve(boundary), winslow(boundary).grid.nodes
    never_worse(solution.grid.nodes, reference)  # 135 is the boundary's own angle
    assert angle(solution.grid.nodes).mean < angle(reference).mean - 7
    assert (solution.cycles or 0) <= module.FEW


def test_a_tolerance_takes_large_grids_to_their_minimum() -> None:
    boundary, weights = bump(140, 140), Weights()
    few, full = solve(boundary), solve(boundary, tol=1e-5)
    assert (few.cycles or 0) <= module.FEW < (full.cycles or 0)
    aspect = aspect_of(few.grid.nodes)
    assert energy(full.grid.nodes, aspect, weights) < energy(few.grid.nodes, aspect, weights)
    assert solve(boundary, tol=1e-5, max_cycles=2).cycles == 2


@pytest.mark.parametrize(("make", "ni", "nj"), [(hexagon, 17, 17), (wrench, 17, 13), (arch, 40, 30)])
def test_the_coarsest_level_starts_from_winslows_solution(make, ni: int, nj: int) -> None:  # type: ignore[no-untyped-def]
    boundary = make(ni, nj)
    exact = winslow(boundary, tol=1e-10, max_cycles=100).grid.nodes
    change = np.abs(exact - tfi(boundary).nodes).max()
    assert np.abs(winslow_start(boundary) - exact).max() < 0.02 * change


def test_a_minimum_that_folds_on_finer_levels_gives_way_to_the_other() -> None:
    boundary = random_quad(171, 65, 65)
    assert boundary is not None
    assert folded(winslow(boundary).grid.nodes) > 100
    result = solve(boundary)
    assert result.notes == ()
    assert folded(result.grid.nodes) == 0


def test_straight_lines_lead_on_where_splines_fold_too_much(monkeypatch: pytest.MonkeyPatch) -> None:
    """Between walls that nearly meet (random domain 171 on 129 nodes), splines leave what no repair mends."""
    boundary, smooth = arch(33, 33), module.refine_grid

    def swinging(nodes: Floats, boundary: Boundary) -> Floats:
        result = smooth(nodes, boundary)
        result[16, 16] += 1.0
        return result

    goal = solve(boundary, tol=1e-7).grid.nodes
    monkeypatch.setattr(module, "refine_grid", swinging)
    monkeypatch.setattr(descent_module, "_made_valid", lambda *_: False)
    result = solve(boundary, tol=1e-7)
    assert result.notes == ()
    np.testing.assert_allclose(result.grid.nodes, goal, atol=1e-5)


def test_of_several_minima_of_a_hard_domain_the_better_one_counts() -> None:
    boundary = random_quad(273, 17, 17)
    assert boundary is not None
    start = winslow_start(boundary)
    assert folded(start) > 0
    aspect, whole = aspect_of(start), start.copy(order="K")
    assert unfold(whole, Weights())[0]
    descend(whole, Weights(), module.STILL, 1000)
    result = solve(boundary, max_cycles=1000).grid.nodes
    assert folded(result) == 0
    assert energy(result, aspect, Weights()) < energy(whole, aspect, Weights()) - 0.05


def test_largest_angles_are_far_below_winslows() -> None:
    assert angle(solve(bump(65, 65)).grid.nodes).max < 138
    assert angle(solve(wrench(65, 65)).grid.nodes).max < 138


@pytest.mark.parametrize("seed", range(21))
def test_random_domains_are_never_worse(seed: int) -> None:
    boundary = random_quad(seed, 65, 65)
    if boundary is None:
        pytest.skip("no valid grid exists in this outline")
    never_worse(solve(boundary).grid.nodes, winslow(boundary).grid.nodes)


def wavy(ni: int, nj: int) -> Boundary:
    """Four smooth sides that meet at right angles."""
    t, s = np.linspace(0, 1, ni), np.linspace(0, 1, nj)
    south = np.stack([t, 0.2 * np.sin(np.pi * t) ** 2], axis=1)
    north = np.stack([t, 1 + 0.3 * np.sin(np.pi * t) ** 2], axis=1)
    west = np.stack([-0.2 * np.sin(np.pi * s) ** 2, s], axis=1)
    return quad(south, north, west, np.stack([1 + 0.1 * np.sin(np.pi * s) ** 2, s], axis=1))


@pytest.mark.parametrize("make", [wavy, partial(seamount, ni=129, nj=129)])
def test_it_converges_with_the_square_of_the_step(make) -> None:  # type: ignore[no-untyped-def]
    boundary = make(ni=129, nj=129)
    finest = solve(boundary, tol=2e-6, max_cycles=500).grid.nodes
    size, counts, errors = np.linalg.norm(finest - finest.mean(axis=(0, 1))), (17, 33, 65), []
    for n in counts:
        result = solve(thinned(boundary, n, n), tol=2e-6, max_cycles=500).grid.nodes
        every = 128 // (n - 1)
        errors.append(np.linalg.norm(result - finest[::every, ::every]) / size * every)
    assert errors[1] < 1e-3
    # the finest is no limit: with e = c h² - c h₁₂₉² the slopes of second order are 2.02 and 2.05
    slope = -np.polyfit(np.log([n - 1 for n in counts]), np.log(errors), 1)[0]
    assert 1.8 < slope < 2.4


@pytest.mark.parametrize(("ni", "nj"), [(65, 33), (40, 100), (5, 7), (3, 3), (2, 5), (200, 4)])
def test_any_counts_do(ni: int, nj: int) -> None:
    assert folded(solve(arch(ni, nj)).grid.nodes) == 0


def test_descent_lowers_the_functional() -> None:
    start = winslow(arch(65, 65)).grid.nodes
    result = solve(arch(65, 65)).grid.nodes
    aspect = aspect_of(start)
    assert energy(result, aspect, Weights()) < energy(start, aspect, Weights()) - 0.1


def test_the_minimum_does_not_depend_on_the_start() -> None:
    boundary = bump(33, 33)
    nested = solve(boundary, tol=1e-7, max_cycles=1000).grid.nodes
    from_tfi = solve(boundary, tol=1e-7, max_cycles=1000, initial=tfi(boundary)).grid.nodes
    np.testing.assert_allclose(from_tfi, nested, atol=1e-4)


def test_smooth_moves_follow_the_coarsest_level() -> None:
    boundary, weights = arch(65, 65), Weights()
    start, coarse = winslow(boundary).grid.nodes, solve(thinned(boundary, 17, 17)).grid.nodes
    aspect = aspect_of(start)
    reached = []
    for stiffness in (stiffness_of(coarse, weights), None):
        nodes = start.copy(order="K")
        descend(nodes, weights, 1e-9, 15, stiffness=stiffness)
        reached.append(energy(nodes, aspect, weights))
    least = energy(solve(boundary, tol=1e-7, max_cycles=500).grid.nodes, aspect, weights)
    assert reached[0] - least < 0.3 * (reached[1] - least)


def test_a_folded_start_is_unfolded() -> None:
    boundary = arch(33, 33)
    nodes = tfi(boundary).nodes
    nodes[8:16, 8:16] = nodes[24:16:-1, 24:16:-1]
    assert folded(nodes) > 10
    result = solve(boundary, initial=Grid.from_nodes(nodes), max_cycles=1000)
    assert folded(result.grid.nodes) == 0
    assert result.notes == ()


def test_the_regularised_barrier_unfolds_what_repair_leaves(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(descent_module, "repair", lambda nodes, periodic: folded(nodes))
    boundary = wrench(33, 33)
    assert folded(tfi(boundary).nodes) > 10
    result = solve(boundary, initial=tfi(boundary), max_cycles=1000)
    assert folded(result.grid.nodes) == 0
    assert result.notes == ()


def test_a_corner_of_180_degrees_is_told() -> None:
    turned = segment((0, 0), (1, 0), 33), segment((-0.5, 0), (1, 1), 33)
    boundary = quad(*turned, segment((0, 0), (-0.5, 0), 33), segment((1, 0), (1, 1), 33))
    result = solve(boundary)
    assert result.notes == ("no valid start was found; the grid is not the minimum",)
    assert folded(result.grid.nodes) > 0


def test_a_coarse_minimum_keeps_the_gain_at_any_resolution() -> None:
    boundary = bump(129, 129)
    own, reference = solve(boundary).grid.nodes, winslow(boundary).grid.nodes
    result = solve_coarse(boundary, solve, 33, smooth=True).grid.nodes
    assert folded(result) == 0
    gain = angle(reference).mean - angle(own).mean
    assert angle(reference).mean - angle(result).mean > 0.9 * gain


def test_provenance_names_method_and_weights() -> None:
    facts = solve(arch(17, 17)).grid.provenance
    assert (facts["method"], facts["shape"], facts["smoothness"]) == ("variational", 0.97, 2.5e-3)


@pytest.mark.parametrize("make", [hole, naca, partial(naca, thickness=0.3, far=5.0)])
@pytest.mark.parametrize(("ni", "nj"), [(129, 65), (100, 40)])
def test_around_a_body_the_cut_moves(make, ni: int, nj: int) -> None:  # type: ignore[no-untyped-def]
    boundary = make(ni, nj)
    reference, solution = winslow(boundary).grid, solve(boundary)
    result = solution.grid.nodes
    assert solution.notes == ()
    assert folded(result) == 0
    # a sharp edge bounds the maximum, and Winslow's line halves it exactly on symmetric bodies
    assert angle(result).max < angle(reference.nodes).max + 0.05
    assert angle(result).mean < angle(reference.nodes).mean
    assert np.array_equal(result[0], result[-1])
    assert np.array_equal(result[:, 0], boundary.south)
    assert np.array_equal(result[:, -1], boundary.north)


def body(seed: int, ni: int, nj: int) -> Boundary:
    return random_body(np.random.default_rng([1000, seed]), ni, nj)


def test_large_grids_around_bodies_end_early_with_the_same_angles() -> None:
    boundary = body(4, 161, 81)
    few, full = solve(boundary), solve(boundary, tol=1e-4)
    assert few.cycles == module.FEW_AROUND[1] < (full.cycles or 0)
    assert folded(few.grid.nodes) == folded(full.grid.nodes) == 0
    assert angle(few.grid.nodes).mean < angle(full.grid.nodes).mean + 0.05
    assert angle(few.grid.nodes).max < angle(full.grid.nodes).max + 1.0


def test_hard_bodies_descend_on() -> None:
    solution = solve(body(15, 65, 33))
    assert solution.notes == ()
    assert (solution.cycles or 0) > module.FEW_AROUND[0]
    assert angle(solution.grid.nodes).mean < 97


def test_where_winslows_equations_have_no_solution_the_start_is_interpolated() -> None:
    boundary = body(8, 65, 33)
    with pytest.raises(SolverError):
        winslow(boundary)
    solution = solve(boundary)
    assert solution.notes == ()
    assert folded(solution.grid.nodes) == 0
    assert angle(solution.grid.nodes).mean < 96


def test_around_a_body_it_does_not_matter_where_nodes_begin() -> None:
    boundary, shift = hole(97, 41), 30
    south, north = (
        np.concatenate([np.roll(wall[:-1], -shift, axis=0), wall[shift : shift + 1]])
        for wall in (boundary.south, boundary.north)
    )
    moved = ring(south, north, 41)
    one, other = (solve(b, tol=1e-6, max_cycles=500).grid.nodes for b in (boundary, moved))
    np.testing.assert_allclose(np.roll(one[:-1], -shift, axis=0), other[:-1], atol=2e-3)


def test_behind_a_sharp_edge_the_wake_stays() -> None:
    boundary = naca_section("0012").boundary(Sampling(101, 41, topology="c"))
    reference, result = tfi(boundary), solve(boundary).grid
    assert result.topology == "c"
    assert result.patches == reference.patches
    assert np.array_equal(result.nodes[:, 0], boundary.south)
    never_worse(result.nodes, reference.nodes)
    assert angle(result.nodes).mean < 93


def test_a_bent_cut_is_straightened() -> None:
    """Of a round body in a round far field the minimum is known: circles and rays."""
    walls = circle(1.0, 65), circle(4.0, 65)
    boundary = ring(*walls, 33)
    bent = tfi(boundary).nodes.copy(order="K")
    angle = 0.4 * np.sin(np.pi * np.linspace(0, 1, 33))
    x, y = bent[..., 0].copy(), bent[..., 1].copy()
    bent[..., 0], bent[..., 1] = (
        np.cos(angle) * x - np.sin(angle) * y,
        np.sin(angle) * x + np.cos(angle) * y,
    )
    result = solve(boundary, initial=Grid.from_nodes(bent, "o"), tol=1e-6).grid.nodes
    rays = np.arctan2(result[..., 1], result[..., 0]) - np.arctan2(walls[0][:, 1], walls[0][:, 0])[:, None]
    assert np.abs((rays + np.pi) % (2 * np.pi) - np.pi).max() < 1e-4
    assert np.ptp(np.hypot(result[..., 0], result[..., 1]), axis=0).max() < 1e-4


@pytest.mark.parametrize("bad", [{"tol": 0.0}, {"tol": 2.0}, {"max_cycles": 0}])
def test_senseless_limits_are_refused(bad: dict[str, float]) -> None:
    with pytest.raises(InputError, match=r"tolerance|cycles"):
        solve(arch(9, 9), **bad)  # type: ignore[arg-type]


def test_an_initial_grid_of_other_counts_is_refused() -> None:
    with pytest.raises(InputError, match="the initial grid has 9x9 nodes, not 9x8"):
        solve(arch(9, 8), initial=tfi(arch(9, 9)))
