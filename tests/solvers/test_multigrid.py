"""One sweep, one residual, one restriction: the compiled kernels against plain numpy."""

import tracemalloc

import numpy as np
import pytest
from solver_shapes import arch, hole, naca
from winslow_reference import metric_terms, residual

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.multigrid import Multigrid, Settings
from meshonet.solvers.elliptic.solve import solve, solve_thomas_middlecoff


def prepared(boundary: Boundary, noise: float = 0.002) -> tuple[Floats, Multigrid]:
    """Hierarchy whose finest level holds a slightly disturbed interpolation."""
    nodes = tfi(boundary).nodes.copy(order="K")
    start = nodes.copy(order="K")
    periodic = boundary.topology == "o"
    rng = np.random.default_rng(5)
    rows = slice(None) if periodic else slice(1, -1)
    start[rows, 1:-1] += rng.normal(0, noise, start[rows, 1:-1].shape)
    if periodic:
        start[-1] = start[0]
    levels = Multigrid(nodes, (boundary.south, boundary.north, boundary.west, boundary.east), periodic)
    nodes[...] = start
    return nodes, levels


def interior(nodes: Floats, periodic: bool) -> Floats:
    """Nodes with what lies beyond the seam appended, so that column 0 is an inner one."""
    return np.concatenate([nodes[-2:-1], nodes]) if periodic else nodes


BOUNDARIES = [arch(41, 30), arch(20, 19), hole(38, 23), naca(47, 20), naca(20, 21)]


@pytest.mark.parametrize("boundary", BOUNDARIES, ids=lambda b: f"{b.name}-{b.ni}x{b.nj}")
def test_residual_is_that_of_the_numpy_reference(boundary: Boundary) -> None:
    nodes, levels = prepared(boundary)
    expected = residual(interior(nodes, boundary.topology == "o"))
    assert levels.levels[0].residual(False) == pytest.approx((expected**2).sum(), rel=1e-12)


def relaxed(nodes: Floats, periodic: bool) -> Floats:
    """Zebra relaxation, one dense system a line: eta lines of one colour, of the other; xi lines likewise."""
    x = nodes.copy()
    ni, nj = x.shape[:2]
    count = ni - 1 if periodic else ni - 2
    first = 0 if periodic else 1
    for along_eta in (True, False):
        lines = range(first, first + count) if along_eta else range(1, nj - 1)
        for colour in (0, 1):
            for line in list(lines)[colour::2]:
                _relax_line(x, line, along_eta, periodic)
                x[-1] = x[0] if periodic else x[-1]
    return x


def _relax_line(x: Floats, line: int, along_eta: bool, periodic: bool) -> None:
    ni, nj = x.shape[:2]
    around = ni - 1
    unknown = (
        [(line, j) for j in range(1, nj - 1)]
        if along_eta
        else [(i, line) for i in (range(around) if periodic else range(1, ni - 1))]
    )
    place = {node: k for k, node in enumerate(unknown)}
    matrix, right = np.zeros((len(unknown), len(unknown))), np.zeros((len(unknown), 2))
    for (i, j), k in place.items():
        w, e = ((i - 1) % around, (i + 1) % around) if periodic else (i - 1, i + 1)
        around_node = np.stack([x[w, j - 1 : j + 2], x[i, j - 1 : j + 2], x[e, j - 1 : j + 2]])
        alpha, beta, gamma = (float(term[0, 0]) for term in metric_terms(around_node))
        cross = (x[e, j + 1] - x[e, j - 1] - x[w, j + 1] + x[w, j - 1]) / 4
        matrix[k, k] = -2 * (alpha + gamma)
        right[k] = 2 * beta * cross
        for node, weight in (((w, j), alpha), ((e, j), alpha), ((i, j - 1), gamma), ((i, j + 1), gamma)):
            if node in place:
                matrix[k, place[node]] += weight
            else:
                right[k] -= weight * x[node]
    solved = np.linalg.solve(matrix, right)
    for node, k in place.items():
        x[node] = solved[k]


@pytest.mark.parametrize(("ni", "nj"), [(23, 18), (40, 9), (18, 41), (6, 7)])
@pytest.mark.parametrize("make", [arch, hole])
def test_a_sweep_is_alternating_zebra_line_relaxation(make, ni: int, nj: int) -> None:  # type: ignore[no-untyped-def]
    if make is hole and ni % 2 == 0:
        ni += 1  # an odd ring has neighbouring lines of one colour, whose order is free
    boundary = make(ni, nj)
    nodes, levels = prepared(boundary)
    expected = relaxed(nodes, boundary.topology == "o")
    levels.levels[0].smooth(False)
    np.testing.assert_allclose(nodes, expected, atol=1e-13)


def test_a_cycle_leaves_a_solved_grid_alone() -> None:
    nodes, levels = prepared(arch(65, 65))
    levels.nested_iteration()
    for _ in range(30):
        levels.cycle()
    solved = nodes.copy()
    assert levels.cycle() < 1e-13
    np.testing.assert_allclose(nodes, solved, atol=1e-13)


@pytest.mark.parametrize("boundary", [arch(65, 49), naca(66, 40)], ids=lambda b: b.name)
def test_cycles_shrink_the_residual_by_a_third_at_least(boundary: Boundary) -> None:
    _, levels = prepared(boundary)
    levels.nested_iteration()
    levels.cycle()
    before = levels.residual()
    for _ in range(5):
        levels.cycle()
    assert levels.residual() < before / 3**5


def test_settings_choose_the_coarsest_level() -> None:
    boundary = arch(129, 129)
    edges = boundary.south, boundary.north, boundary.west, boundary.east
    for coarsest, count in ((16, 4), (32, 3), (200, 1)):
        levels = Multigrid(tfi(boundary).nodes.copy(order="K"), edges, False, Settings(coarsest=coarsest))
        assert len(levels.levels) == count


@pytest.mark.parametrize("method", [solve, solve_thomas_middlecoff])
def test_solving_takes_six_numbers_a_node_at_the_most(method) -> None:  # type: ignore[no-untyped-def]
    """The grid included; with control functions too, as they are products."""
    boundary = arch(401, 401)
    tracemalloc.start()
    method(boundary)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 6 * 8 * 401**2
