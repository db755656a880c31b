"""Families of grids: solved coarse, refined, and coarsened again."""

import numpy as np
import pytest

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.transform import coarser_grid
from meshonet.geometry.errors import InputError
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.energy.variational import solve as minimise
from meshonet.solvers.pipeline.coarse import solve_refined
from meshonet.solvers.solution import Solution


def bump(ni: int, nj: int) -> Boundary:
    x, y = np.linspace(0, 2, ni), np.linspace(0, 1, nj)
    floor = 0.3 * np.exp(-20 * (x - 1) ** 2)
    floor[[0, -1]] = 0
    return Boundary(
        np.stack([x, floor], axis=-1), np.stack([x, np.ones(ni)], axis=-1),
        np.stack([np.zeros(nj), y], axis=-1), np.stack([np.full(nj, 2.0), y], axis=-1),
    )  # fmt: skip


def ring(ni: int, nj: int) -> Boundary:
    turn = -np.linspace(0, 2 * np.pi, ni)
    around = np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    around[-1] = around[0]
    wall, far = 0.5 * around * [1, 0.3], 5 * around
    cut = np.linspace(wall[0], far[0], nj)
    return Boundary(wall, far, cut, cut, topology="o")


@pytest.mark.parametrize("make", [bump, ring])
def test_the_finest_grid_is_the_solution(make: object) -> None:
    boundary: Boundary = make(65, 33)  # type: ignore[operator]
    alone = solve(boundary, tol=1e-10).grid.nodes
    refined = solve_refined(boundary, lambda b, **more: solve(b, tol=1e-10, **more), 2)
    np.testing.assert_allclose(refined.grid.nodes, alone, atol=1e-8)
    assert refined.grid.provenance["refined"] == 2
    assert refined.notes[-1].startswith("refined: 17x9 in ")
    assert "33x17 in" in refined.notes[-1]
    assert "65x33 in" in refined.notes[-1]


def test_each_solve_starts_close_to_its_solution() -> None:
    starts: list[tuple[Boundary, Grid | None]] = []

    def method(boundary: Boundary, *, initial: Grid | None = None) -> Solution:
        starts.append((boundary, initial))
        return solve(boundary, tol=1e-9, initial=initial)

    solve_refined(bump(129, 65), method, 2)
    assert [boundary.ni for boundary, _ in starts] == [33, 65, 129]
    assert starts[0][1] is None
    away = []
    for boundary, initial in starts[1:]:
        assert initial is not None
        np.testing.assert_array_equal(initial.nodes[:, 0], boundary.south)
        away.append(np.abs(initial.nodes - solve(boundary, tol=1e-9).grid.nodes).max())
    assert away[1] < 0.4 * away[0] < 0.01  # second order, from one level to the next


def test_other_methods_can_be_refined() -> None:
    refined = solve_refined(bump(33, 33), minimise, 1)
    assert refined.method == "variational"
    np.testing.assert_allclose(refined.grid.nodes, minimise(bump(33, 33)).grid.nodes, atol=5e-3)


def test_coarsened_members_are_nested_and_converge() -> None:
    finest = solve_refined(bump(129, 65), lambda b, **more: solve(b, tol=1e-9, **more), 2).grid
    middle, coarse = coarser_grid(finest, 2), coarser_grid(finest, 4)
    np.testing.assert_array_equal(coarser_grid(middle, 2).nodes, coarse.nodes)
    own = [np.abs(solve(bump(n, m), tol=1e-9).grid.nodes - g.nodes).max() for n, m, g in
           ((65, 33, middle), (33, 17, coarse))]  # fmt: skip
    assert own[1] / own[0] > 3  # what each would be on its own differs by a second-order error


def test_counts_must_halve() -> None:
    with pytest.raises(InputError, match="34x33 nodes are 33x32 cells, which 2 does not divide"):
        solve_refined(bump(34, 33), solve, 1)
