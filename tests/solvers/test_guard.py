"""The guard returns valid grids, says how, and refuses in words."""

import numpy as np
import pytest
from solver_shapes import (
    arch,
    circle,
    folded,
    hexagon,
    hole,
    horseshoe,
    l_shape,
    naca,
    quad,
    ring,
    seamount,
    segment,
    spike,
    wrench,
)

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import NoValidGridError
from meshonet.solvers.algebraic.tfi import solve as interpolate
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.pipeline.fallback import ORDER, guard
from meshonet.solvers.solution import Outcome, Solution


def cusp(ni: int, nj: int) -> Boundary:
    """Joukowski section: the two sides meet at its trailing edge without an angle."""
    c, h = 0.08, 0.05
    radius = np.hypot(1 + c, h)
    z = complex(-c, h) + radius * np.exp(-1j * (np.linspace(0, 2 * np.pi, ni) + np.arcsin(h / radius)))
    w = (z + 1 / z) / 4 + 0.5
    return ring(np.stack([w.real, w.imag], axis=1), circle(15.0, ni, (0.5, 0.0)), nj, "cusp")


SHAPES = [arch, hexagon, wrench, l_shape, horseshoe, spike, hole, naca, cusp]


@pytest.mark.slow
@pytest.mark.parametrize("make", SHAPES)
@pytest.mark.parametrize("n", [40, 100])
@pytest.mark.parametrize("start", [interpolate, solve], ids=["tfi", "winslow"])
def test_every_shape_ends_valid_inside_its_boundary(make, n: int, start) -> None:  # type: ignore[no-untyped-def]
    boundary = make(n, n)
    made = guard(start(boundary), boundary)
    grid, path = made.grid, made.path
    assert folded(grid.nodes) == 0
    assert set(path) <= {"repair", *ORDER}
    assert np.array_equal(grid.nodes[:, 0], boundary.south)
    assert np.array_equal(grid.nodes[:, -1], boundary.north)


@pytest.mark.parametrize("make", [interpolate, solve], ids=["tfi", "winslow"])
def test_the_seamount_on_which_elliptic_grids_fold_elsewhere_is_valid(make) -> None:  # type: ignore[no-untyped-def]
    boundary = seamount()
    assert folded(guard(make(boundary), boundary).grid.nodes) == 0


def test_a_valid_grid_comes_back_itself() -> None:
    boundary = arch(30, 20)
    solution = interpolate(boundary)
    assert guard(solution, boundary) is solution


def test_a_repaired_grid_says_so_and_keeps_its_names() -> None:
    boundary = wrench(60, 60)
    made = guard(solve(boundary), boundary)
    grid, path = made.grid, made.path
    assert path == ("repair",)
    assert grid.provenance["path"] == ("repair",)
    assert (grid.name, grid.patches) == ("wrench", boundary.patches)


def test_a_grid_beyond_repair_is_made_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("meshonet.solvers.energy.repair.repair", lambda nodes, *_: folded(nodes))
    boundary = arch(30, 20)
    nodes = tfi(boundary).nodes.copy()
    nodes[1:-1, 1:-1] = nodes[-2:0:-1, 1:-1]
    made = guard(Solution(Grid.from_nodes(nodes), "tfi"), boundary)
    grid, path = made.grid, made.path
    assert folded(grid.nodes) == 0
    assert path in {(name,) for name in ORDER}


def inside_out(ni: int, nj: int) -> Boundary:
    """Quad one corner of which opens by 240 degrees: no grid is valid."""
    a, b, c, d = (0.0, 0.0), (2.0, 0.0), (0.6, 0.4), (0.0, 2.0)
    return quad(segment(a, b, ni), segment(d, c, ni), segment(a, d, nj), segment(b, c, nj), "inside out")


def test_an_impossible_corner_is_named_at_once() -> None:
    boundary = inside_out(20, 20)
    with pytest.raises(
        NoValidGridError, match=r"corner at \(0.6, 0.4\) opens by 180 degrees or more; choose other corners"
    ):
        guard(interpolate(boundary), boundary)


def test_failure_counts_and_places_the_worst_cells(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("meshonet.solvers.pipeline.fallback.ORDER", ("winslow", "tfi"))
    monkeypatch.setattr("meshonet.solvers.energy.repair.repair", lambda nodes, *_: folded(nodes))
    boundary = wrench(60, 60)
    with pytest.raises(
        NoValidGridError, match=r"\d+ of 3481 cells stay folded after repair, then tfi; use more"
    ) as caught:
        guard(solve(boundary), boundary)
    assert 0 < len(caught.value.worst) <= 10
    least = min(folded(solve(boundary).grid.nodes), folded(tfi(boundary).nodes))
    assert str(caught.value).startswith(f"{least} of")  # those of the best try


def test_winslows_equations_are_not_solved_again_for_their_own_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    boundary = wrench(60, 60)
    solution, asked = solve(boundary), []
    monkeypatch.setattr("meshonet.solvers.pipeline.fallback.ORDER", ("winslow", "tfi"))
    monkeypatch.setattr("meshonet.solvers.energy.repair.repair", lambda nodes, *_: folded(nodes))
    monkeypatch.setattr(
        "meshonet.solvers.elliptic.solve.solve", lambda *_, **__: asked.append(1) or solve(boundary)
    )
    for made, times in ((solution, 0), (interpolate(boundary), 1)):
        asked.clear()
        guard(made, boundary, allow_invalid=True)
        assert len(asked) == times


def test_an_invalid_grid_may_be_asked_for() -> None:
    boundary = inside_out(20, 20)
    made = guard(interpolate(boundary), boundary, allow_invalid=True)
    assert (made.path, made.outcome) == ((), Outcome.FOLDED)
    np.testing.assert_array_equal(made.grid.nodes, tfi(boundary).nodes)
