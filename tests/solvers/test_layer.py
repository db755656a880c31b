"""Grids as layers: batches in torch equal the compiled solvers, and their gradients are true."""

import subprocess
import sys
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from converged_o_grids import converged
from random_quads import random_quad

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.families import procedural
from meshonet.geometry.families.family import family
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
from meshonet import layer  # noqa: E402 - it imports torch
from meshonet.solvers.neural.differentiable.functional import Functional, aspect_of  # noqa: E402
from meshonet.solvers.neural.differentiable.variational import BlockCholesky  # noqa: E402

LIFTED = partial(layer.winslow, coarse=9), partial(layer.variational, coarse=9)
QUADS = (layer.transfinite, layer.winslow, layer.variational, layer.QuadGrids(), *LIFTED)
NETWORKS = layer.BodyGrids(), layer.AirfoilGrids()
AROUND = (layer.conformal, *NETWORKS)
NAMES = ("south", "north", "west", "east")


def domains(ni: int, nj: int, count: int) -> list[Boundary]:
    drawn = [random_quad(seed, ni, nj) for seed in range(count)]
    return [boundary for boundary in drawn if boundary is not None]


def sides_of(boundaries: list[Boundary]) -> list[Any]:
    return [torch.tensor(np.stack([getattr(b, name) for b in boundaries])) for name in NAMES]


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


def inputs(function: Any, count: int) -> tuple[Any, list[Any]]:
    """Return the function of the sides alone, and sides of `count` members."""
    if function in QUADS:
        counts = (14, 11) if function in LIFTED else (9, 8)
        return function, sides_of(domains(*counts, 2 * count)[:count])
    names = ("2412", "4412-sharp", "23012", "0024", "6409", "1408", "2424", "0010-sharp")[:count]
    sections = [naca(name).boundary(Sampling(25, 6, "o", far_field=3.0)) for name in names]
    if function in (layer.conformal, NETWORKS[1]):
        return lambda south, north: function(south, north, 6), sides_of(sections)[:2]
    holes = [family("hole").boundary(0.1 + 0.2 * k / count, 25, 6) for k in range(count)]
    return lambda south, north: function(south, north, 6), sides_of(holes)[:2]


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_gradients_are_those_of_finite_differences(function: Any) -> None:
    nodes, given = inputs(function, 2)
    given = [side.requires_grad_() for side in given]
    assert torch.autograd.gradcheck(nodes, given, fast_mode=True)


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_members_through_vmap_are_those_alone(function: Any) -> None:
    nodes, given = inputs(function, 8)

    def loss(*sides: Any) -> Any:
        return (nodes(*sides) ** 3).sum()

    together = torch.func.vmap(nodes)(*given)
    slopes = torch.func.vmap(torch.func.grad(loss))(*given)
    for k in (0, 3, 7):
        alone = [side[k].clone().requires_grad_() for side in given]
        torch.testing.assert_close(together[k], nodes(*alone).detach(), rtol=0, atol=1e-11)
        loss(*alone).backward()
        torch.testing.assert_close(slopes[k], alone[0].grad, rtol=1e-9, atol=1e-8)


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_single_precision_has_the_nodes_of_double_precision_rounded(function: Any) -> None:
    nodes, given = inputs(function, 2)
    single = [side.float() for side in given]
    assert nodes(*single).dtype == torch.float32
    assert torch.equal(nodes(*single), nodes(*(side.double() for side in single)).float())


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
    given = sides_of(domains(10, 9, 4))
    with pytest.raises(InputError, match=r"8 coarse nodes along a direction are too few"):
        layer.winslow(*given, coarse=8)
    assert torch.equal(layer.winslow(*given, coarse=10), layer.winslow(*given))


def uneven() -> Boundary:
    """Return an airfoil with nodes so uneven that 60 plain Picard steps change its grid."""
    return procedural.boundary(np.random.default_rng(20_000_004), 33, 9)


def test_conformal_nodes_are_those_of_the_converged_compiled_iteration() -> None:
    sections = [naca(name).boundary(Sampling(33, 9, "o")) for name in ("2412", "4412-sharp", "23012")]
    sections.append(uneven())
    assert o_grids(sections[3:], 60)[0].residual > 1e-5
    nodes = layer.conformal(*sides_of(sections)[:2], 9)
    for own, boundary in zip(nodes.numpy(), sections, strict=True):
        np.testing.assert_allclose(
            own, converged(boundary), rtol=0, atol=1e-11 * np.abs(boundary.north).max()
        )


def test_gradients_of_a_slow_conformal_grid_are_those_of_finite_differences() -> None:
    south, north = (side.requires_grad_() for side in sides_of([uneven()])[:2])
    assert torch.autograd.gradcheck(lambda *sides: layer.conformal(*sides, 9), (south, north), fast_mode=True)


def test_bodies_without_a_map_are_named() -> None:
    _, (south, north) = inputs(layer.conformal, 4)
    south[1], south[3] = 0.0, south[3] * torch.tensor([1.0, 0.0])
    with pytest.raises(SolverError, match=r"members 1, 3 of the batch: the body is a point") as caught:
        layer.conformal(south, north, 6)
    assert caught.value.members == (1, 3)


@pytest.mark.slow
def test_a_conformal_grid_converges_where_the_angle_on_the_wall_turns_back() -> None:
    """There accelerated steps stall."""
    rough = procedural.boundary(np.random.default_rng(20_000_632), 65, 5)
    south, north = (torch.tensor(side) for side in (rough.south, rough.north))
    nodes = layer.conformal(south, north, 5).numpy()
    exact = converged(rough)  # 50,000 plain steps
    np.testing.assert_allclose(nodes, exact, rtol=0, atol=1e-10 * np.ptp(rough.north))


@pytest.mark.slow
def test_an_optimum_is_found_where_sides_nearly_meet_in_a_bent_gap() -> None:
    """There steps end at the rounding of nodes before they are small beside the shortest edges."""
    bent = random_quad(1622, 25, 25)
    assert bent is not None
    nodes = layer.variational(*(side[0] for side in sides_of([bent]))).numpy()
    compiled = least(bent, tol=1e-8, max_cycles=1000).grid
    weights = Weights(smoothness=compiled.provenance["smoothness"])
    assert value(nodes, weights) < value(compiled.nodes, weights)


SOLVED = (*QUADS[1:3], *LIFTED, layer.conformal)


@pytest.mark.parametrize("function", SOLVED)
def test_members_without_a_grid_leave_the_others_as_they_are(function: Any) -> None:
    _, given = inputs(function, 4)
    more = (6,) if function is layer.conformal else ()
    broken = [side.clone() for side in given]
    broken[0][1, 4, 1] = torch.nan
    for side in broken:
        side[2] = 0.0
    result = function(*(side.requires_grad_() for side in broken), *more, failed="nan")
    assert result.isfinite().all((1, 2, 3)).tolist() == [True, False, False, True]
    few = [side[[0, 3]].requires_grad_() for side in given]
    alone = function(*few, *more)
    torch.testing.assert_close(result[[0, 3]], alone, rtol=0, atol=1e-11)
    result.square().sum().backward()
    alone.square().sum().backward()
    for side, own in zip(broken, few, strict=True):
        torch.testing.assert_close(side.grad[[0, 3]], own.grad, rtol=1e-9, atol=1e-9)
        assert not side.grad[1:3].any()


def test_a_batch_of_failures_alone_is_nan() -> None:
    given = [(0.0 * side).requires_grad_() for side in sides_of(domains(9, 8, 3))]
    nodes = layer.winslow(*given, failed="nan")
    assert nodes.shape[1:] == (9, 8, 2)
    assert nodes.isnan().all()
    nodes.sum().backward()
    assert not given[0].grad.any()


def test_an_unknown_word_for_failures_is_refused() -> None:
    with pytest.raises(InputError, match=r"""failed='skip'; use "raise" or "nan\""""):
        layer.winslow(*sides_of(domains(9, 8, 2)), failed="skip")  # type: ignore[arg-type]


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_grids_of_any_size_are_those_of_unit_size(function: Any) -> None:
    nodes, given = inputs(function, 2)
    for size in (2.0**-500, 2.0**500):
        scaled = [(side * size).requires_grad_() for side in given]
        result = nodes(*scaled)
        torch.testing.assert_close(result.detach() / size, nodes(*given), rtol=0, atol=1e-11)
        (result / size).sum().backward()
        assert all(bool(side.grad.isfinite().all()) for side in scaled)


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_an_empty_batch_has_no_grids(function: Any) -> None:
    nodes, given = inputs(function, 1)
    none = [side[:0].requires_grad_() for side in given]
    result = nodes(*none)
    assert result.shape == (0, *nodes(*given).shape[1:])
    result.sum().backward()
    assert none[0].grad.shape == none[0].shape


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_grids_are_made_in_inference_mode_too(function: Any) -> None:
    nodes, given = inputs(function, 1)
    with torch.inference_mode():
        result = nodes(*given)
    torch.testing.assert_close(result, nodes(*given), rtol=0, atol=1e-11)


@pytest.mark.parametrize("function", QUADS + AROUND)
def test_one_side_may_have_a_gradient_alone_and_any_memory_layout(function: Any) -> None:
    nodes, given = inputs(function, 2)
    for k in range(len(given)):
        some = [side.mT.contiguous().mT.requires_grad_(i == k) for i, side in enumerate(given)]
        every = [side.clone().requires_grad_() for side in given]
        for sides in (some, every):
            nodes(*sides).square().sum().backward()
        torch.testing.assert_close(some[k].grad, every[k].grad, rtol=1e-9, atol=1e-9)


def test_sides_keep_their_nodes_and_dtype() -> None:
    given = [side.float() for side in sides_of(domains(17, 9, 3))]
    nodes = layer.winslow(*given)
    assert nodes.dtype == torch.float32
    for side, edge in zip(given, (nodes[:, :, 0], nodes[:, :, -1], nodes[:, 0], nodes[:, -1]), strict=True):
        assert torch.equal(side, edge)


def test_one_side_serves_a_whole_batch() -> None:
    south, north, west, east = sides_of(domains(9, 8, 5)[:1])
    souths = south + torch.zeros(2, 3, 1, 1)
    assert layer.winslow(souths, north[0], west[0], east[0]).shape == (2, 3, 9, 8, 2)


@pytest.mark.parametrize("function", QUADS[1:] + AROUND)
def test_a_member_that_is_not_finite_is_named(function: Any) -> None:
    nodes, given = inputs(function, 2)
    given[0][1, 4, 1] = torch.nan
    with pytest.raises(SolverError, match=r"member 1 of the batch: a coordinate is not finite"):
        nodes(*given)


@pytest.mark.parametrize("function", QUADS[1:3])
def test_a_member_without_a_solution_is_named(function: Any) -> None:
    given = sides_of(domains(9, 8, 5))
    for side in given:
        side[1] = 0.0
    with pytest.raises(SolverError, match=r"member 1 of the batch"):
        function(*given)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda s: s[0].__getitem__((slice(None), slice(None, -1))), "opposite sides need equal counts"),
        (lambda s: s[0].float(), "of one type on one device"),
        (lambda s: s[0].long(), r"south is torch\.int64; give floating-point numbers"),
        (lambda s: s[0][..., :1], "n at least 3"),
        (lambda s: s[0][:2], "different batches"),
    ],
)
def test_sides_that_bound_no_batch_are_refused(change: Any, said: str) -> None:
    given = sides_of(domains(9, 8, 6))
    with pytest.raises(InputError, match=said):
        layer.winslow(change(given), *given[1:])


@pytest.mark.parametrize("function", [layer.transfinite, layer.winslow])
def test_gradients_at_a_repeated_node_are_finite(function: Any) -> None:
    given = sides_of(domains(9, 8, 4))
    given[0][1, 4] = given[0][1, 5]
    given = [side.requires_grad_() for side in given]
    function(*given).square().sum().backward()
    assert all(bool(side.grad.isfinite().all()) for side in given)


def test_arrays_that_are_no_tensors_are_refused() -> None:
    given = sides_of(domains(9, 8, 2))
    with pytest.raises(InputError, match=r"south is a ndarray; give tensors of torch"):
        layer.winslow(given[0].numpy(), *given[1:])


@pytest.mark.parametrize("function", [*QUADS[:3], layer.QuadGrids()])
def test_members_through_two_levels_of_vmap_are_those_of_one_batch(function: Any) -> None:
    given = [side[:4] for side in sides_of(domains(9, 8, 8))]
    nested = torch.func.vmap(torch.func.vmap(function))(*(side.unflatten(0, (2, 2)) for side in given))
    torch.testing.assert_close(nested.flatten(0, 1), function(*given), rtol=0, atol=1e-11)


@pytest.mark.parametrize("function", QUADS)
def test_sides_without_common_corners_are_refused_with_the_member(function: Any) -> None:
    sides = sides_of(domains(9, 9, 3))
    sides[3][2, -1, 0] += 0.1
    with pytest.raises(InputError, match=r"north and east of member 2 end 0\.1 apart"):
        function(*sides)


def test_without_torch_its_installation_is_said() -> None:
    words = "import sys; sys.modules['torch'] = None; from meshonet import layer"
    done = subprocess.run([sys.executable, "-c", words], capture_output=True, text=True)
    assert "ModuleNotFoundError: meshonet.layer needs torch; install" in done.stderr


def test_variational_grids_whose_systems_are_too_large_are_refused() -> None:
    given = sides_of(domains(601, 601, 1))
    with pytest.raises(InputError, match=r"the optimum of 601 x 601 nodes needs factors of 56 GB"):
        layer.variational(*given)
