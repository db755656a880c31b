"""Four-sided domains through a quad model of random weights: exact edges, symmetries, batches, polish."""

from dataclasses import replace

import numpy as np
import pytest
from inferred import infer
from quad_models import random_model
from random_quads import random_quad
from solver_shapes import arch, hexagon, ring, segment, wrench

from meshonet.geometry.arrays import SIDES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.threads import limited_to, thread_count
from meshonet.solvers.algebraic.resample.grids import refine_grid, thinned
from meshonet.solvers.algebraic.resample.quad import refine_quad
from meshonet.solvers.elliptic.solve import solve as winslow
from meshonet.solvers.neural.operator import in_batches
from meshonet.solvers.neural.quad import coarse_grids, operator
from meshonet.solvers.neural.quad.coarse_grids import sides_of
from meshonet.solvers.neural.quad.encoding import WINSLOW
from meshonet.solvers.neural.quad.polish import polished
from meshonet.solvers.neural.quad.symmetry import ELEMENTS, ORDER
from meshonet.solvers.neural.registry import load

SHAPES = [shape(ni, nj) for shape in (arch, hexagon, wrench) for ni, nj in ((33, 33), (65, 41), (20, 129))]


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(random_model(tmp_path_factory.mktemp("model") / "random.safetensors"))


def nodes(boundary: Boundary, model: str, polish: int = 0) -> Floats:
    return load(model).solve([boundary], polish)[0].grid.nodes


@pytest.mark.parametrize("polish", [0, 2])
@pytest.mark.parametrize("boundary", SHAPES, ids=lambda b: f"{b.name}-{b.ni}x{b.nj}")
def test_edges_are_met_bitwise(boundary: Boundary, model: str, polish: int) -> None:
    result = nodes(boundary, model, polish)
    edges = {"south": result[:, 0], "north": result[:, -1], "west": result[0], "east": result[-1]}
    for side, edge in edges.items():
        np.testing.assert_array_equal(edge, getattr(boundary, side))


def turned(boundary: Boundary, matrix: Floats, away: Floats) -> Boundary:
    return replace(
        boundary, patches=(), **{side: getattr(boundary, side) @ matrix.T + away for side in SIDES}
    )


@pytest.mark.parametrize("polish", [0, 2])
def test_a_domain_moved_turned_and_scaled_has_the_grid_moved_turned_and_scaled(
    model: str, polish: int
) -> None:
    boundary = random_quad(3, 65, 49)
    assert boundary is not None
    angle = 0.7
    matrix = 3.1 * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    away = np.array([5.0, -2.0])
    expected = nodes(boundary, model, polish) @ matrix.T + away
    result = nodes(turned(boundary, matrix, away), model, polish)
    close = 1e-12 if polish == 0 else 1e-7  # the descent's preconditioner is in single precision
    np.testing.assert_allclose(result, expected, rtol=0, atol=close * 10)


def relabelled(grid: Floats, element: int) -> Floats:
    """Return nodes (n, n, 2) with index axes and plane moved by an element of the symmetry group."""
    turn, n = ELEMENTS[element], len(grid)
    centred = np.arange(n) - (n - 1) / 2
    places = np.stack(np.meshgrid(centred, centred, indexing="ij")).reshape(2, -1)
    i, j = np.rint(turn @ places + (n - 1) / 2).astype(int)
    return np.asarray(grid[i, j].reshape(grid.shape) @ turn)


def rimmed(grid: Floats) -> Boundary:
    return Boundary(grid[:, 0], grid[:, -1], grid[0], grid[-1])


@pytest.mark.parametrize("n", [33, 50, 65])
@pytest.mark.parametrize("element", range(ORDER))
def test_a_relabelled_or_mirrored_domain_has_the_relabelled_grid(model: str, element: int, n: int) -> None:
    boundary = random_quad(5, n, n)
    assert boundary is not None
    plain = nodes(boundary, model)
    result = nodes(rimmed(relabelled(plain, element)), model)
    np.testing.assert_allclose(result, relabelled(plain, element), rtol=0, atol=1e-12)


def test_a_batch_has_the_grids_of_its_members_alone(model: str) -> None:
    together = load(model).solve(SHAPES, 1)
    for boundary, solution in zip(SHAPES, together, strict=True):
        assert solution.grid.name == boundary.name
        np.testing.assert_array_equal(solution.grid.nodes, nodes(boundary, model, 1))


def test_evaluation_is_that_of_coarse_solves(model: str) -> None:
    boundary = arch(90, 70)
    sides = sides_of([boundary])
    coarse = coarse_grids.coarse_grids(sides, load(model).network(), 1)
    (result,) = refine_quad(coarse, sides)
    expected = refine_grid(np.ascontiguousarray(np.moveaxis(coarse[0], 0, -1)), boundary)
    np.testing.assert_allclose(np.moveaxis(result, 0, -1), expected, rtol=0, atol=1e-14)
    thin = coarse_grids.thinned(sides, 33, 33)
    for name, side in zip(("south", "north", "west", "east"), thin, strict=True):
        np.testing.assert_allclose(side[0].T, getattr(thinned(boundary, 33, 33), name), atol=1e-15)


def test_single_precision_of_the_network_changes_the_sixth_digit(model: str) -> None:
    exact = load(model).solve(SHAPES, "off")
    rough = load(model).solve(SHAPES, "off", dtype="float32")
    for one, other in zip(exact, rough, strict=True):
        gap = np.abs(one.grid.nodes - other.grid.nodes).max()
        assert 0 < gap < 1e-5 * np.ptp(one.grid.nodes)


def test_the_report_names_model_and_steps(model: str) -> None:
    solution = infer(arch(40, 30), model=model, polish=2)
    assert (solution.method, solution.model, solution.cycles) == ("operator", "random", 2)
    assert solution.grid.provenance["model"] == "random"


def test_polish_descends_the_functional(model: str) -> None:
    from functional_reference import energy

    from meshonet.solvers.energy.functional import Weights, aspect_of

    boundary = arch(65, 65)
    values = []
    for steps in (0, 2, 5):
        result = nodes(boundary, model, steps)
        values.append(energy(result, aspect_of(result), Weights(), 1e-9))
    assert values[0] > values[1] > values[2]


def test_cycles_bring_the_winslow_answer_to_winslows_solution(model: str) -> None:
    operator = replace(load(model), head=WINSLOW)  # type: ignore[call-arg]
    boundary = arch(65, 65)
    goal = winslow(boundary, tol=1e-10).grid.nodes
    errors = [np.linalg.norm(operator.solve([boundary], steps)[0].grid.nodes - goal) for steps in (0, 1, 2)]
    assert errors[1] < 0.3 * errors[0]
    assert errors[2] < 0.3 * errors[1]


def test_other_topologies_are_refused(model: str) -> None:
    angle = -2 * np.pi * np.arange(21) / 20
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    with pytest.raises(InputError, match="makes quad grids, and this boundary is o; use another model"):
        infer(ring(circle, 4 * circle, 9), model=model)


def test_domains_far_from_any_in_training_give_finite_grids(model: str) -> None:
    sliver = Boundary(
        segment((0, 0), (1e3, 0), 40), segment((0, 1e-3), (1e3, 1e-3), 40),
        segment((0, 0), (0, 1e-3), 30), segment((1e3, 0), (1e3, 1e-3), 30),
    )  # fmt: skip
    assert np.isfinite(nodes(sliver, model)).all()


@pytest.mark.parametrize(
    ("count", "threads", "sizes"), [(70, 1, [35, 35]), (192, 2, 4 * [48]), (3, 4, [1, 1, 1])]
)
def test_batches_keep_every_thread_at_work_to_the_end(count: int, threads: int, sizes: list[int]) -> None:
    results = list(in_batches(count * [arch(5, 4)], threads))
    assert [len(batch) for batch in results] == sizes
    assert [k for batch in results for k in batch] == list(range(count))


@pytest.mark.parametrize("polish", [0, 2])
def test_threads_change_nothing(model: str, polish: int) -> None:
    sizes = [(33, 33), (41, 37), (33, 33), (25, 30)]
    boundaries = [arch(ni, nj) for ni, nj in sizes] + [hexagon(ni, nj) for ni, nj in sizes]
    alone = load(model).solve(boundaries, polish)
    together = load(model).solve(boundaries, polish, threads=3)
    for one, other in zip(alone, together, strict=True):
        np.testing.assert_array_equal(one.grid.nodes, other.grid.nodes)
        assert one.grid.name == other.grid.name


def test_batches_at_work_at_a_time_share_the_threads_of_kernels(
    model: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = []
    monkeypatch.setattr(operator, "polished", lambda *words: seen.append(thread_count()) or polished(*words))
    with limited_to(9):
        load(model).solve(4 * [arch(9, 9)], 0, threads=3)
    assert seen == [3, 3, 3]
