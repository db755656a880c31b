"""Grids as layers: batches in torch have the nodes of the compiled solvers."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from converged_o_grids import converged
from random_quads import random_quad

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.families import procedural
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.conformal.solve import solve as o_grids
from meshonet.solvers.derivatives.optimum import OptimumDerivative
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.energy.functional import Weights, value
from meshonet.solvers.energy.variational import solve as least
from meshonet.solvers.pipeline.coarse import solve_coarse

torch = pytest.importorskip("torch")
from layer_inputs import domains, sides_of, uneven  # noqa: E402 - it imports torch

from meshonet import layer  # noqa: E402
from meshonet.solvers.neural.differentiable.functional import Functional, aspect_of  # noqa: E402
from meshonet.solvers.neural.differentiable.variational import BlockCholesky  # noqa: E402


def test_transfinite_nodes_are_those_of_the_compiled_interpolation() -> None:
    some = domains(30, 21, 12)
    for nodes, boundary in zip(layer.transfinite(*sides_of(some)).numpy(), some, strict=True):
        np.testing.assert_allclose(nodes, tfi(boundary).nodes, rtol=0, atol=1e-13)


@pytest.mark.parametrize(("ni", "nj"), [(33, 33), (50, 19), (12, 40)])
def test_winslow_nodes_are_those_of_the_compiled_multigrid(ni: int, nj: int) -> None:
    some = domains(ni, nj, 24)
    for nodes, boundary in zip(layer.winslow(*sides_of(some)).numpy(), some, strict=True):
        exact = solve(boundary, tol=1e-12, max_cycles=60).grid.nodes
        np.testing.assert_allclose(nodes, exact, rtol=0, atol=1e-10)


@pytest.mark.parametrize(("ni", "nj"), [(17, 17), (12, 23), (24, 21)])
def test_variational_nodes_are_those_of_the_converged_compiled_minimisation(ni: int, nj: int) -> None:
    some = domains(ni, nj, 8)
    for nodes, boundary in zip(layer.variational(*sides_of(some)).numpy(), some, strict=True):
        grid = least(boundary, tol=1e-8, max_cycles=1000).grid
        np.testing.assert_allclose(nodes, grid.nodes, rtol=0, atol=3e-3)
        weights = Weights(smoothness=grid.provenance["smoothness"])
        assert value(nodes, weights) <= value(grid.nodes, weights) + 1e-14
        exact = OptimumDerivative(grid.with_nodes(nodes)).grid.nodes  # Newton's method on the compiled slope
        np.testing.assert_allclose(nodes, exact, rtol=0, atol=1e-10)


def test_nearly_degenerate_domains_converge_to_an_optimum_too() -> None:
    """There the compiled minimisation still falls after 1,000 iterations, along a bent valley."""
    narrow = random_quad(1102, 15, 15)
    assert narrow is not None
    nodes = layer.variational(*sides_of([narrow, *domains(15, 15, 2)]))[0].numpy()
    grid = least(narrow, tol=1e-8, max_cycles=1000).grid
    assert grid.provenance["cycles"] == 1000
    assert value(nodes, Weights()) < value(grid.nodes, Weights()) - 0.5
    exact = OptimumDerivative(grid.with_nodes(nodes)).grid.nodes
    np.testing.assert_allclose(nodes, exact, rtol=0, atol=1e-10)


@pytest.mark.slow
def test_an_optimum_is_found_where_sides_nearly_meet_in_a_bent_gap() -> None:
    """There steps end at the rounding of nodes before they are small beside the shortest edges."""
    bent = random_quad(1622, 25, 25)
    assert bent is not None
    nodes = layer.variational(*(side[0] for side in sides_of([bent]))).numpy()
    compiled = least(bent, tol=1e-8, max_cycles=1000).grid
    weights = Weights(smoothness=compiled.provenance["smoothness"])
    assert value(nodes, weights) < value(compiled.nodes, weights)


@pytest.mark.parametrize("counts", [(9, 7), (8, 10)])
def test_convex_systems_are_positive_where_those_of_the_functional_are_not(counts: tuple[int, int]) -> None:
    nodes = layer.transfinite(*sides_of(domains(*counts, 6))).movedim(-1, 1)
    functional, ratios = Functional(0.97, 3e-3 * torch.ones(len(nodes)).double()), aspect_of(nodes)
    stencils = [functional.hessian(nodes, ratios, convex=part) for part in (False, True)]
    assert [bool(BlockCholesky(stencil).positive.all()) for stencil in stencils] == [False, True]


@pytest.mark.parametrize("counts", [(9, 7), (8, 10)])
def test_variational_systems_are_those_of_twofold_differentiation(counts: tuple[int, int]) -> None:
    nodes = layer.variational(*sides_of(domains(*counts, 4))).movedim(-1, 1).requires_grad_()
    functional, ratios = Functional(0.97, 3e-3 * torch.ones(len(nodes)).double()), aspect_of(nodes.detach())
    (slope,) = torch.autograd.grad(functional.value(nodes, ratios).sum(), nodes, create_graph=True)
    move = torch.randn(len(nodes), 2, counts[0] - 2, counts[1] - 2, dtype=nodes.dtype)
    (change,) = torch.autograd.grad(slope, nodes, torch.nn.functional.pad(move, (1, 1, 1, 1)))
    factor = BlockCholesky(functional.hessian(nodes.detach(), ratios))
    assert factor.positive.all()
    torch.testing.assert_close(factor.solve(change[..., 1:-1, 1:-1]), move)


@pytest.mark.parametrize(("ni", "nj"), [(40, 33), (21, 12)])
def test_coarse_optima_are_lifted_as_the_compiled_ones(ni: int, nj: int) -> None:
    some = domains(ni, nj, 6)
    for own, boundary in zip(layer.variational(*sides_of(some), coarse=12).numpy(), some, strict=True):
        solution = solve_coarse(boundary, most_exactly, 12, smooth=False)
        np.testing.assert_allclose(own, solution.grid.nodes, rtol=0, atol=1e-10)


def most_exactly(boundary: Boundary) -> Any:
    """Return the compiled minimum, moved by Newton's method on the compiled slope."""
    solution = least(boundary, tol=1e-8, max_cycles=1000)
    return replace(solution, grid=OptimumDerivative(solution.grid).grid)


def test_coarse_winslow_grids_are_lifted_as_the_compiled_ones() -> None:
    some = domains(40, 33, 8)
    for own, boundary in zip(layer.winslow(*sides_of(some), coarse=17).numpy(), some, strict=True):
        exact = solve_coarse(boundary, lambda few: solve(few, tol=1e-12, max_cycles=60), 17, smooth=False)
        np.testing.assert_allclose(own, exact.grid.nodes, rtol=0, atol=1e-10)


def test_few_coarse_nodes_are_refused_and_many_change_nothing() -> None:
    sides = sides_of(domains(10, 9, 4))
    with pytest.raises(InputError, match=r"8 coarse nodes along a direction are too few"):
        layer.winslow(*sides, coarse=8)
    assert torch.equal(layer.winslow(*sides, coarse=10), layer.winslow(*sides))


def test_conformal_nodes_are_those_of_the_converged_compiled_iteration() -> None:
    sections = [naca(name).boundary(Sampling(33, 9, "o")) for name in ("2412", "4412-sharp", "23012")]
    sections.append(uneven())
    assert o_grids(sections[3:], 60)[0].residual > 1e-5
    nodes = layer.conformal(*sides_of(sections)[:2], 9)
    for own, boundary in zip(nodes.numpy(), sections, strict=True):
        np.testing.assert_allclose(
            own, converged(boundary), rtol=0, atol=1e-11 * np.abs(boundary.north).max()
        )


@pytest.mark.slow
def test_a_conformal_grid_converges_where_the_angle_on_the_wall_turns_back() -> None:
    """There accelerated steps stall."""
    rough = procedural.boundary(np.random.default_rng(20_000_632), 65, 5)
    south, north = (torch.tensor(side) for side in (rough.south, rough.north))
    nodes = layer.conformal(south, north, 5).numpy()
    exact = converged(rough)
    np.testing.assert_allclose(nodes, exact, rtol=0, atol=1e-10 * np.ptp(rough.north))
