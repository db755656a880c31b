"""Hyperbolic marching: against circles, whose levels follow a scalar recursion; on airfoils."""

from dataclasses import replace

import numpy as np
import pytest
from march_shapes import airfoil, circle, deviation, ellipse, first_cells

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.families import procedural
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.far_field import o_boundary
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.growth import growing_steps
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.kernels._native import hyperbolic_march
from meshonet.solvers.hyperbolic import march as module
from meshonet.solvers.hyperbolic.march import hyperbolic
from meshonet.solvers.pipeline.fallback import guard

DISSIPATION, THETA, BEND = 0.5, 0.5, 0.04


def radii_of_levels(n: int, radius: float, steps: Floats) -> list[float]:
    """The equations of the march, written down for concentric levels: one unknown a level."""
    turn = 2 * np.pi / n
    radii, before = [radius], 0.0
    for level, step in enumerate(steps):
        r, growth = radii[-1], np.sqrt(min(level + 1, round(0.75 * len(steps))) / len(steps))
        width = 2 * r * np.sin(turn / 2)
        eps = DISSIPATION * growth * step / width
        if level:
            eps *= np.clip((before / width) ** (2 / growth), 0.1, 50.0)
        eps += BEND * step * steps[: level + 1].sum() / width**2
        bend = 2 - 2 * np.cos(turn)
        advance = (step - eps * bend * r) / (1 + (1 + THETA) * step / width * np.sin(turn) + 2 * eps * bend)
        radii.append(r + advance)
        before = width
    return radii


@pytest.mark.parametrize(("n", "even"), [(3, 1.0), (4, 0.0), (7, 0.3), (64, 0.0), (250, 1.0)])
def test_around_a_circle_levels_are_the_circles_of_the_recursion(n: int, even: float) -> None:
    steps = growing_steps(1e-4, 3.0, 40)
    levels = np.empty((2, 41, n))
    levels[:, 0] = circle(n)[:-1].T
    knobs = DISSIPATION, even, np.inf, BEND, 1 + THETA, 0.16, 10, 30
    hyperbolic_march(levels[0], levels[1], steps, *knobs)
    expected = np.multiply.outer(radii_of_levels(n, 0.5, steps), circle(n, 1.0)[:-1])
    np.testing.assert_allclose(np.moveaxis(levels, 0, -1), expected, rtol=0, atol=1e-11)


def test_around_a_circle_lines_are_radial_and_cells_grow_evenly() -> None:
    boundary = o_boundary(circle(100), 60, np.zeros(2), 15.0)
    nodes = hyperbolic(boundary, wall_spacing=1e-4).grid.nodes
    radius = np.hypot(nodes[..., 0], nodes[..., 1])
    np.testing.assert_allclose(
        nodes / radius[..., None], np.repeat(nodes[:, :1] / 0.5, 60, axis=1), atol=1e-12
    )
    np.testing.assert_allclose(radius, np.tile(radius[0], (100 + 1, 1)), rtol=1e-11)
    heights = np.diff(radius[0])
    assert heights[0] == pytest.approx(1e-4, rel=1e-10)
    assert np.ptp(heights[1:] / heights[:-1]) < 0.05
    assert radius[0, -1] == pytest.approx(15.0, rel=0.01)


@pytest.mark.parametrize("spacing", [1e-3, 1e-5, 1e-6])
def test_the_first_cell_is_what_was_asked_for_at_every_wall_node(spacing: float) -> None:
    for name in ("0012", "4415"):
        boundary = airfoil(name, nj=120)
        nodes = hyperbolic(boundary, wall_spacing=spacing).grid.nodes
        np.testing.assert_allclose(first_cells(nodes), spacing * boundary.chord, rtol=1e-8)
        assert count_folded(nodes) == 0


def test_wall_and_seam_are_met_bitwise() -> None:
    boundary = airfoil()
    solution = hyperbolic(boundary, wall_spacing=1e-5)
    nodes = solution.grid.nodes
    np.testing.assert_array_equal(nodes[:, 0], boundary.south)
    np.testing.assert_array_equal(nodes[0], nodes[-1])
    assert solution.method == "hyperbolic"
    assert solution.boundary is not None
    np.testing.assert_array_equal(solution.boundary.north, nodes[:, -1])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_no_cell_is_folded_around_procedural_airfoils(seed: int) -> None:
    rng = np.random.default_rng(seed)
    for spacing in (1e-4, 1e-5, 1e-6):
        for _ in range(6):
            drawn = procedural.boundary(rng, 160, 90)
            nodes = hyperbolic(drawn, wall_spacing=spacing).grid.nodes
            assert count_folded(nodes) == 0
            np.testing.assert_allclose(first_cells(nodes), spacing * drawn.chord, rtol=1e-8)


def test_cells_come_closer_to_right_angles_as_the_grid_is_refined() -> None:
    n = np.array([50, 100, 200])
    mean = [deviation(hyperbolic(ellipse(k, k // 2), wall_spacing=0.05 / k).grid.nodes).mean() for k in n]
    slope = -np.polyfit(np.log(n), np.log(mean), 1)[0]
    assert slope > 0.8
    assert mean[-1] < 1.0


def test_the_grid_moves_turns_and_grows_with_the_body() -> None:
    boundary = ellipse(80, 40)
    nodes = hyperbolic(boundary, wall_spacing=1e-4).grid.nodes
    turn = np.array([[0.6, 0.8], [-0.8, 0.6]])
    moved = [30.0 * edge @ turn + [5.0, -7.0] for edge in (boundary.south, boundary.north, boundary.west)]
    for edge in moved[:2]:
        edge[-1] = edge[0]
    moved[2][0], moved[2][-1] = moved[0][0], moved[1][0]
    other = Boundary(moved[0], moved[1], moved[2], moved[2], topology="o")
    result = hyperbolic(other, wall_spacing=1e-4).grid.nodes
    np.testing.assert_allclose(result, 30.0 * nodes @ turn + [5.0, -7.0], atol=1e-6)


def test_free_rows_are_few_more_than_the_growth_needs() -> None:
    boundary = airfoil()
    free = hyperbolic(boundary, wall_spacing=1e-5, growth=1.1, free_rows=True).grid
    assert free.nj > boundary.nj
    needed = hyperbolic(airfoil(nj=free.nj), wall_spacing=1e-5, growth=1.1).grid
    np.testing.assert_array_equal(needed.nodes, free.nodes)
    heights = np.hypot(*np.moveaxis(np.diff(free.nodes, axis=1), -1, 0))
    assert np.median(heights[:, 1:] / heights[:, :-1]) == pytest.approx(1.1, abs=0.01)
    with pytest.raises(InputError, match="rows or more") as error:
        hyperbolic(airfoil(nj=boundary.nj), wall_spacing=1e-5, growth=1.1)
    least = int(str(error.value).split("use ")[1].split()[0])
    assert 1 <= free.nj - least <= 6
    with pytest.raises(InputError, match=f"use {least} rows or more"):
        hyperbolic(airfoil(nj=least - 1), wall_spacing=1e-5, growth=1.1)


def test_three_nodes_are_enough_two_rows_are_not() -> None:
    boundary = o_boundary(circle(3), 2, np.zeros(2), 2.0)
    with pytest.raises(
        InputError, match=r"2 rows of nodes cannot reach the far field growing by 1[.]5 each; use 11 rows"
    ):
        hyperbolic(boundary, wall_spacing=0.01)
    assert hyperbolic(o_boundary(circle(3), 9, np.zeros(2), 2.0), wall_spacing=0.05).grid.nj == 9


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"wall_spacing": 0.0}, "a first cell of 0 chords; use 1e-9 to 0.1"),
        ({"wall_spacing": float("nan")}, "a first cell of nan chords; use 1e-9 to 0.1"),
        (
            {"wall_spacing": 1e-5, "growth": 0.2},
            "a growth of 0.2; give the ratio of neighbouring cells, such as",
        ),
        (
            {"wall_spacing": 1e-5, "growth": 1.01},
            "40 rows of nodes cannot reach the far field growing by 1.01 each; use ",
        ),
        ({"wall_spacing": 0.1}, "cells, of which the first is"),
    ],
)
def test_values_out_of_range_are_named(settings: dict[str, float], message: str) -> None:
    with pytest.raises(InputError) as error:
        hyperbolic(ellipse(80, 120 if settings["wall_spacing"] == 0.1 else 40), **settings)
    assert message in str(error.value)


def test_a_four_sided_domain_is_refused() -> None:
    t = np.linspace(0.0, 1.0, 9)
    south, west = np.stack([t, 0 * t], axis=1), np.stack([0 * t, t], axis=1)
    quad = Boundary(south, south + np.array([0, 1]), west, west + np.array([1, 0]))
    with pytest.raises(
        InputError, match="hyperbolic marching cannot make topology quad; use it around a body"
    ):
        hyperbolic(quad, wall_spacing=1e-3)


def test_a_march_that_is_not_finite_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    def spoilt(x: Floats, *rest: object) -> None:
        x[1:] = np.nan

    monkeypatch.setattr(module, "hyperbolic_march", spoilt)
    with pytest.raises(SolverError, match="the march diverged from every start; use more nodes"):
        hyperbolic(ellipse(20, 20), wall_spacing=1e-2)


def test_spacings_are_in_chords_of_the_body() -> None:
    points = naca("2412").curve.points * 40.0 + 3.0
    assert Airfoil(points).boundary(Sampling(80, 60)).chord == pytest.approx(40.0, rel=1e-4)
    assert naca("2412").boundary(Sampling(80, 60)).chord == 1.0
    box = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]])
    assert Outline(box).boundary(Sampling(80, 60, topology="o")).chord == 4.0
    assert ellipse(80, 40).chord == pytest.approx(1.0)


def square(n: int = 30) -> Floats:
    side = np.linspace(0.0, 1.0, n, endpoint=False)[:, None]
    corners = np.array([[1.0, -0.5], [0.0, -0.5], [0.0, 0.5], [1.0, 0.5]])
    return np.concatenate([a + side * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)])


def star(points: int = 5, depth: float = 0.55) -> Floats:
    angle = np.linspace(0, 2 * np.pi, 2 * points, endpoint=False)
    radius = np.where(np.arange(2 * points) % 2 == 0, 1.0, depth)
    return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


BODIES = {
    "square": square(),
    "L": np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 0.7], [0.7, 0.7], [0.7, 2.0], [0.0, 2.0]]),
    "star": star(),
    "bluff": np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.6], [0.4, 0.6], [0.2, 0.5], [0.0, 0.3]]),
}


def test_first_cells_nearly_as_high_as_long_at_a_sharp_edge_do_not_fold() -> None:
    boundary = naca("0012-sharp").boundary(Sampling(800, 120, "o", "cosine"))
    assert np.hypot(*np.diff(boundary.south[:2], axis=0).T)[0] < 2e-5
    nodes = hyperbolic(boundary, wall_spacing=1e-5).grid.nodes
    assert count_folded(nodes) == 0
    np.testing.assert_allclose(first_cells(nodes), 1e-5, rtol=1e-8)


@pytest.mark.parametrize("name", BODIES)
@pytest.mark.parametrize("height", [1e-3, 1e-5])
def test_bodies_that_are_no_airfoils_get_valid_grids(name: str, height: float) -> None:
    """Convex corners, re-entrant ones (L, star) and both: by the march, or the guard after it."""
    boundary = Outline(BODIES[name]).boundary(Sampling(241, 100, topology="o"))
    solution = hyperbolic(boundary, wall_spacing=height)
    assert solution.boundary is not None
    made = guard(solution, boundary)
    grid, path = made.grid, made.path
    assert count_folded(grid.nodes) == 0
    np.testing.assert_array_equal(grid.nodes[:, 0], boundary.south)
    if not path:
        np.testing.assert_allclose(first_cells(grid.nodes), height * boundary.chord, rtol=1e-8)


@pytest.mark.parametrize("topology", ["o", "c"])
def test_folded_cells_of_a_march_are_repaired_by_the_guard(topology: Topology) -> None:
    boundary = naca("0012").boundary(Sampling(121, 50, topology))
    solution = hyperbolic(boundary, wall_spacing=1e-3)
    nodes = solution.grid.nodes.copy(order="K")
    nodes[30, 20] += 2.5 * (nodes[31, 20] - nodes[30, 20])
    folded = solution.grid.with_nodes(nodes)
    assert count_folded(nodes) > 0
    assert solution.boundary is not None
    made = guard(replace(solution, grid=folded), boundary)
    grid, path = made.grid, made.path
    assert path == ("repair",)
    assert count_folded(grid.nodes) == 0
    np.testing.assert_array_equal(grid.nodes[:, 0], boundary.south)


@pytest.mark.parametrize(("ni", "nj", "height"), [(250, 100, 1e-5), (800, 200, 1e-5), (250, 120, 1e-6)])
@pytest.mark.parametrize("topology", ["o", "c"])
def test_airfoils_are_marched_once(
    topology: Topology, ni: int, nj: int, height: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The distance to march is known so well that no second march has to correct it."""
    marches = []
    monkeypatch.setattr(
        module, "hyperbolic_march", lambda *args: (marches.append(1), hyperbolic_march(*args))
    )
    wall = naca("2412").boundary(Sampling(ni, nj, topology, "curvature", te="wedge"))
    hyperbolic(wall, wall_spacing=height)
    assert len(marches) == 1


@pytest.mark.parametrize(("topology", "te"), [("o", "round"), ("o", "exact"), ("c", "wedge")])
def test_constant_layers_are_equal_at_every_wall_node(topology: Topology, te: str) -> None:
    wall = naca("4415").boundary(Sampling(160, 70, topology, "curvature", te=te))  # type: ignore[arg-type]
    nodes = hyperbolic(wall, wall_spacing=1e-5, constant=6).grid.nodes
    height = np.hypot(*np.moveaxis(np.diff(nodes, axis=1), -1, 0))
    behind = wall.wake
    at_wall = height[behind : len(height) - behind]
    np.testing.assert_allclose(at_wall[:, 1:6], np.repeat(at_wall[:, :1], 5, axis=1), rtol=1e-6)
    assert (at_wall[:, 6:] / at_wall[:, 5:-1]).min() > 0.8
    assert count_folded(nodes) == 0
