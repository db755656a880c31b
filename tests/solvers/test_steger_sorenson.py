"""Sources at edges: angles of lines, heights of first cells, an exact map, kinks, and what cannot be."""

import numpy as np
import pytest
from solver_shapes import (
    arch,
    bump,
    folded,
    hexagon,
    hole,
    horseshoe,
    l_shape,
    naca,
    quad,
    seamount,
    segment,
    wrench,
)
from test_slide_nodes import CHANNELS, channel, leans

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.elliptic import steger_sorenson as module
from meshonet.solvers.elliptic.solve import solve
from meshonet.solvers.elliptic.steger_sorenson import solve_steger_sorenson
from meshonet.solvers.elliptic.wall_control import ControlledEdge
from meshonet.solvers.layers.first_cells import Heights
from meshonet.solvers.layers.redistribute import spread


def wall_lines(nodes: Floats) -> Floats:
    """Angle of the lines at south in degrees, by parabolas through three nodes."""
    a, b, c = nodes[:, 0], nodes[:, 1], nodes[:, 2]
    out = -1.5 * a + 2 * b - 0.5 * c
    return np.degrees(np.arctan2(out[:, 1], out[:, 0]))


@pytest.mark.parametrize("boundary", CHANNELS, ids=lambda b: b.name)
def test_lines_leave_fixed_wall_nodes_at_right_angles_into_thin_layers(boundary: Boundary) -> None:
    heights = {"south": 1e-5, "north": 1e-5}
    made = spread(solve_steger_sorenson(boundary, heights=heights), boundary, Heights(**heights))
    nodes = made.grid.nodes
    assert folded(nodes) == 0
    assert leans(nodes, boundary).max() < 1.0
    np.testing.assert_array_equal(nodes[:, 0], boundary.south)
    np.testing.assert_array_equal(nodes[:, -1], boundary.north)
    for one, two in ((0, 1), (-1, -2)):
        np.testing.assert_allclose(np.hypot(*(nodes[:, two] - nodes[:, one]).T), 1e-5, rtol=1e-8)


@pytest.mark.parametrize("angle", [60.0, 90.0, 110.0])
def test_lines_can_be_asked_to_lean(angle: float) -> None:
    floor, roof = segment((0, 0), (3, 0), 121), segment((0, 1), (3, 1), 121)
    square = quad(floor, roof, segment((0, 0), (0, 1), 41), segment((3, 0), (3, 1), 41))
    nodes = solve_steger_sorenson(square, heights={"south": 0.0}, angle=angle).grid.nodes
    np.testing.assert_allclose(wall_lines(nodes)[6:-6], angle, atol=1.0)
    assert folded(nodes) == 0


def test_sources_alone_hold_cells_that_are_not_too_thin() -> None:
    boundary = channel("bump", 129, 65)
    nodes = solve_steger_sorenson(boundary, heights={"south": 0.01}).grid.nodes
    first = np.hypot(*(nodes[:, 1] - nodes[:, 0]).T)
    np.testing.assert_allclose(first[6:-6], 0.01, rtol=0.02)
    plain = solve(boundary).grid.nodes
    assert np.hypot(*(plain[:, 1] - plain[:, 0]).T)[6:-6].max() > 0.0105


def test_a_grid_that_is_right_needs_no_sources() -> None:
    """Circles and rays: conformal, so Winslow's equations have it and its lines are upright."""
    zeta = np.linspace(0, 1, 61)[:, None] * np.pi / 2 + 1j * np.linspace(0, 0.6, 33)
    z = 2 * np.exp(1j * zeta)
    nodes = np.stack([z.real, z.imag], axis=-1)
    boundary = Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1])
    edge = ControlledEdge("south", boundary.south, 33, 90.0, 0.0, False)
    lean, _ = edge.errors(nodes)
    assert np.abs(lean).max() < 1e-3
    result = solve_steger_sorenson(boundary).grid.nodes
    np.testing.assert_allclose(result, solve(boundary).grid.nodes, atol=2e-3)


@pytest.mark.parametrize("make", [arch, hexagon, bump, seamount, l_shape, horseshoe])
@pytest.mark.parametrize("counts", [(97, 65), (161, 81)])
def test_kinks_and_oblique_corners_fold_nothing_and_most_lines_stand(make, counts: tuple[int, int]) -> None:  # type: ignore[no-untyped-def]
    boundary = make(*counts)
    before, solution = solve(boundary).grid.nodes, solve_steger_sorenson(boundary)
    assert folded(solution.grid.nodes) == 0
    assert "weakened" not in solution.notes[-1]
    assert leans(solution.grid.nodes, boundary).mean() < 0.35 * leans(before, boundary).mean()


@pytest.mark.parametrize("make", [naca, hole])
def test_a_body_is_controlled_around_its_seam(make) -> None:  # type: ignore[no-untyped-def]
    boundary = make(129, 65)
    solution = solve_steger_sorenson(boundary, heights={"south": 1e-3})
    nodes = spread(solution, boundary, Heights(south=1e-3)).grid.nodes
    assert folded(nodes) == 0
    np.testing.assert_array_equal(nodes[0], nodes[-1])


def test_west_and_east_are_edges_too() -> None:
    boundary = channel("bump", 81, 65)
    turned = Boundary(boundary.west[::-1], boundary.east[::-1], boundary.north, boundary.south)
    one = solve_steger_sorenson(boundary, tol=1e-9, max_cycles=60).grid.nodes
    other = solve_steger_sorenson(
        turned, heights={"west": 0.0, "east": 0.0}, tol=1e-9, max_cycles=60
    ).grid.nodes
    np.testing.assert_allclose(np.swapaxes(other, 0, 1)[:, ::-1], one, atol=2e-3)


def test_sources_that_fold_are_weakened_and_that_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    boundary = channel("bump", 65, 33)
    real, parts = module.solve, []

    def refuses(boundary: Boundary, **settings: object):  # type: ignore[no-untyped-def]
        controls = settings.get("controls")
        if controls is not None:
            parts.append(float(np.abs(controls.phi.values()).max()))  # type: ignore[attr-defined]
            if len(parts) < 3:
                raise SolverError("spoiled")
        return real(boundary, **settings)  # type: ignore[arg-type]

    monkeypatch.setattr(module, "solve", refuses)
    solution = solve_steger_sorenson(boundary)
    np.testing.assert_allclose(parts, parts[0] * np.array([1.0, 0.5, 0.25]))
    assert "sources weakened to 0.25 of what that takes" in solution.notes[-1]


def test_a_start_from_a_grid(monkeypatch: pytest.MonkeyPatch) -> None:
    boundary = channel("bump", 65, 33)
    first = solve_steger_sorenson(boundary, tol=1e-8)
    again = solve_steger_sorenson(boundary, tol=1e-8, initial=first.grid)
    np.testing.assert_allclose(again.grid.nodes, first.grid.nodes, atol=5e-3)


def test_going_astray_ends_at_the_best(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cycles that spoil the nodes after the fifth: the result is no worse than Winslow's."""
    boundary = channel("bump", 65, 33)
    honest, calls = module.Multigrid.cycle, []

    def spoiled(self: module.Multigrid, k: int = 0, forced: bool = False) -> float:
        done = honest(self, k, forced)
        if k == 0 and self.levels[0].x.shape == (65, 33):
            calls.append(1)
            if 5 < len(calls) < 12:
                self.levels[0].x[5, 5] = np.nan
        return done

    monkeypatch.setattr(module.Multigrid, "cycle", spoiled)
    nodes = solve_steger_sorenson(boundary).grid.nodes
    assert np.isfinite(nodes).all()
    assert folded(nodes) == 0
    assert leans(nodes, boundary).max() <= leans(solve(boundary).grid.nodes, boundary).max()


@pytest.mark.parametrize(
    ("make", "settings", "message"),
    [
        (arch, {"angle": 5.0}, "an angle of 5 degrees at walls; use 30 to 150"),
        (
            hole,
            {"heights": {"north": 0.1}},
            "north in topology o cannot be controlled; control its wall, south",
        ),
        (arch, {"tol": 2.0}, "tolerance 2 is not between 0 and 1"),
    ],
)
def test_what_cannot_be_controlled_is_refused(make, settings: dict[str, object], message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=message):
        solve_steger_sorenson(make(41, 21), **settings)  # type: ignore[arg-type]


def test_a_notch_ends_in_a_grid_for_the_guard() -> None:
    boundary = wrench(121, 81)
    solution = solve_steger_sorenson(boundary)
    assert np.isfinite(solution.grid.nodes).all()
    assert folded(solution.grid.nodes) <= folded(solve(boundary).grid.nodes)


def test_sides_of_two_nodes_are_refused() -> None:
    t = np.linspace(0.0, 1.0, 2)
    south, west = np.stack([t, 0 * t], axis=1), np.stack([0 * t, t], axis=1)
    quad = Boundary(south, south + np.array([0, 1]), west, west + np.array([1, 0]))
    with pytest.raises(InputError, match="2x2 nodes are too few to control lines at walls; use at least 3x3"):
        solve_steger_sorenson(quad)
