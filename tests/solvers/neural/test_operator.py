"""The operator's promises: exact walls, a bitwise seam, invariance, agreement with the elliptic solver."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from inferred import infer, infer_many

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.families import procedural
from meshonet.geometry.families.family import family
from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.far_field import o_boundary
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.laws import LAWS
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.elliptic.solve import solve

SECTIONS = ("0012", "0012-sharp", "4412", "23012", "6424-sharp")


def boundary(designation: str, ni: int = 120, nj: int = 90, **settings: object) -> Boundary:
    return naca(designation).boundary(Sampling(ni=ni, nj=nj, **settings))  # type: ignore[arg-type]


@pytest.mark.parametrize("polish", ["auto", "off", 2])
@pytest.mark.parametrize("designation", SECTIONS)
def test_boundary_nodes_are_kept_bitwise_and_nothing_folds(designation: str, polish: object) -> None:
    edges = boundary(designation)
    solution = infer(edges, polish=polish)  # type: ignore[arg-type]
    nodes = solution.grid.nodes
    assert solution.method == ("conformal" if polish == "auto" else "operator")
    np.testing.assert_array_equal(nodes[:, 0], edges.south)
    np.testing.assert_array_equal(nodes[:, -1], edges.north)
    np.testing.assert_array_equal(nodes[0], nodes[-1])
    assert count_folded(nodes) == 0


@pytest.mark.parametrize(("ni", "nj"), [(20, 10), (41, 300), (301, 7), (200, 4), (64, 2)])
def test_any_resolution_is_valid(ni: int, nj: int) -> None:
    assert count_folded(infer(boundary("2412", ni, nj)).grid.nodes) == 0


@pytest.mark.parametrize("spacing", [law for law in LAWS if law != "auto"])
def test_it_agrees_with_the_elliptic_solver_for_every_spacing(spacing: str) -> None:
    edges = boundary("4412", 160, 160, spacing=spacing)
    reference = solve(edges, tol=1e-8).grid.nodes
    result = infer(edges).grid.nodes
    near = np.hypot(reference[..., 0] - 0.5, reference[..., 1]) < 1.5
    size = np.hypot(reference[..., 0] - 0.5, reference[..., 1])
    miss = np.hypot(*np.moveaxis(result - reference, -1, 0))
    # either is off the converged solution, by 1.4e-3 at most (even spacing leaves the nose to few nodes)
    assert np.sqrt((miss[near] ** 2).sum() / (size[near] ** 2).sum()) < 2.5e-3


def test_the_difference_to_the_elliptic_solver_is_its_second_order_error() -> None:
    misses = []
    for n in (81, 161, 321):
        edges = boundary("0012-sharp", n, n)
        miss = infer(edges).grid.nodes - solve(edges, tol=1e-9).grid.nodes
        misses.append(np.abs(miss[:, : n // 3]).max())
    order = np.log2(np.array(misses[:-1]) / misses[1:])
    assert np.all(order > 1.7), order


@pytest.mark.parametrize("designation", ["4412", "0012-sharp", "0015"])
def test_translation_rotation_and_scale_carry_over(designation: str) -> None:
    edges = boundary(designation, 100, 60)
    turn = np.array([[np.cos(0.4), np.sin(0.4)], [-np.sin(0.4), np.cos(0.4)]])

    def moved(nodes: np.ndarray) -> np.ndarray:
        return 250.0 * nodes @ turn + np.array([3000.0, -700.0])

    sides = {side: moved(getattr(edges, side)) for side in ("south", "north", "west", "east")}
    result = infer(replace(edges, **sides, wall=None)).grid.nodes
    wanted = moved(infer(edges).grid.nodes)
    assert np.abs(result - wanted).max() < 1e-12 * np.abs(wanted).max()


@pytest.mark.parametrize("designation", ["4412-sharp", "2412", "0012", "0012-sharp"])
@pytest.mark.parametrize("ni", [100, 101])
def test_a_mirrored_boundary_gets_the_mirrored_grid(designation: str, ni: int) -> None:
    edges = boundary(designation, ni, 60)
    sides = {side: getattr(edges, side)[::-1] * [1.0, -1.0] for side in ("south", "north")}
    cut = {side: getattr(edges, side) * [1.0, -1.0] for side in ("west", "east")}
    one = infer(edges).grid.nodes
    other = infer(replace(edges, **sides, **cut, wall=None)).grid.nodes[::-1] * [1.0, -1.0]
    assert np.abs(other - one).max() < 1e-12 * np.abs(one).max()


@pytest.mark.parametrize("model", ["base", None])
def test_lines_off_a_sharp_edge_halve_its_angle(model: str | None) -> None:
    nodes = infer(boundary("6412-sharp"), model=model).grid.nodes
    z = nodes[..., 0] + 1j * nodes[..., 1]
    ahead, line, behind = z[1, 0] - z[0, 0], z[0, 1] - z[0, 0], z[-2, 0] - z[0, 0]
    one, other = np.mod(np.angle([line / ahead, behind / line]), 2 * np.pi)
    assert abs(one - other) < np.radians(0.1)


def test_polish_brings_the_network_closer_to_the_solution_than_the_base() -> None:
    """Winslow - found, in the strip, over procedural airfoils the model was not trained on."""
    rng = np.random.default_rng(987)
    gains = []
    for _ in range(6):
        edges = procedural.boundary(rng, 161, 60)
        best = infer(edges, model="base", polish=12).grid.nodes
        base = infer(edges, model="base", polish="off").grid.nodes
        network = infer(edges, polish="off").grid.nodes
        gains.append(np.linalg.norm(network - best) / np.linalg.norm(base - best))
    assert np.median(gains) < 0.35, gains


@pytest.mark.parametrize("designation", ["0006", "0008-sharp"])
def test_polish_brings_the_network_closer_where_few_nodes_are_at_the_nose(designation: str) -> None:
    """What the network says of the highest modes no step would correct, and all others would suffer."""
    edges = boundary(designation, 160, 80, spacing="tanh", le_spacing=0.015)
    best = infer(edges, model="base", polish=30).grid.nodes
    misses = [np.abs(infer(edges, polish=steps).grid.nodes - best).max() for steps in (0, 3)]
    assert misses[1] < 0.3 * misses[0], misses


def test_halving_the_angle_at_an_edge_moves_only_the_nodes_around_it(monkeypatch: pytest.MonkeyPatch) -> None:
    edges = boundary("4412-sharp", 160, 80, spacing="cosine")
    nudged = infer(edges).grid.nodes
    none = np.zeros((159, 1)), np.zeros(1)
    monkeypatch.setattr("meshonet.solvers.conformal.solve.shifts", lambda *_: none)
    moved = np.hypot(*np.moveaxis(nudged - infer(edges).grid.nodes, -1, 0))[:80].max(axis=1)
    assert moved[0] > 1e-4
    assert moved[12:].max() < 1e-3 * moved[0], moved


def test_a_quad_goes_to_the_variational_method_and_says_so() -> None:
    side = np.linspace(0, 1, 12)
    zero, one = np.zeros_like(side), np.ones_like(side)
    square = Boundary(
        np.stack([side, zero], 1),
        np.stack([side, one], 1),
        np.stack([zero, side], 1),
        np.stack([one, side], 1),
    )
    solution = infer(square)
    assert solution.method == "variational"
    with pytest.raises(
        InputError, match="model airfoil-o makes o grids, and this boundary is quad; use another"
    ):
        infer(square, model="airfoil-o")


def test_a_body_the_lift_cannot_take_goes_to_the_elliptic_solver_and_says_why() -> None:
    angle = -2 * np.pi * np.arange(8) / 7
    wall = np.stack([np.cos(angle), 0.5 * np.sin(angle)], axis=1)
    wall[-1] = wall[0]
    solution = infer(o_boundary(wall, 12, np.zeros(2), 6.0))
    assert solution.method == "winslow"
    assert "the conformal map cannot take this body" in solution.notes[0]


def test_even_spacing_around_the_leading_edge_stays_with_the_conformal_map() -> None:
    solution = infer(boundary("2412-sharp", 200, 100, spacing="uniform"))
    assert solution.method == "conformal"
    assert count_folded(solution.grid.nodes) == 0


@pytest.mark.parametrize("seed", [113, 125, 143, 174, 198, 249])
def test_lines_off_edges_between_wide_cells_do_not_cross_them(seed: int) -> None:
    solution = infer(procedural.boundary(np.random.default_rng(seed), 160, 160, "uniform"))
    assert (solution.method, count_folded(solution.grid.nodes)) == ("conformal", 0)


@pytest.mark.parametrize("settings", [{"spacing": "uniform"}, {"spacing": "tanh", "te_spacing": 0.012}])
def test_large_cells_beside_a_blunt_edge_do_not_fold(settings: dict[str, Any]) -> None:
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, 80)))
    half = 0.06 * np.sqrt(x) * (1 - x) * 2 + 0.003 * x
    points = np.concatenate([np.stack([x, half], 1)[::-1], np.stack([x, -half], 1)[1:]])
    edges = Airfoil(points, "blunt").boundary(Sampling(200, 200, "o", **settings))
    assert count_folded(infer(edges).grid.nodes) == 0


@pytest.mark.parametrize(
    ("designation", "i", "j", "x", "y"),
    [
        ("2412", 0, 1, 1.00284546763, -0.000185450889056),
        ("2412", 50, 30, -1.64806857238, 0.088784774763),
        ("0012-sharp", 20, 5, 0.645053529091, -0.212983413776),
        ("0012-sharp", 99, 40, 4.63061648559, 0.258988925572),
    ],
)
def test_grids_stay_what_they_were(designation: str, i: int, j: int, x: float, y: float) -> None:
    grid = infer(boundary(designation, 101, 60), model="airfoil-o").grid
    np.testing.assert_allclose(grid.nodes[i, j], [x, y], atol=1e-9)


def test_polished_to_the_end_the_network_is_left_out_unless_it_is_named() -> None:
    edges = boundary("4412", 161, 60, spacing="cosine")
    result, named = infer(edges), infer(edges, model="airfoil-o")
    assert (result.method, result.model) == ("conformal", None)
    assert (named.method, named.model, infer(edges, polish=1).model) == ("operator", "airfoil-o", "airfoil-o")
    near = slice(0, 40)
    away = np.abs(result.grid.nodes - named.grid.nodes)[:, near].max()
    assert 0.0 < away < 1e-3, "both are Winslow's solution"


@pytest.mark.parametrize("name", ["hole", "square"])
def test_bodies_and_far_fields_with_corners_go_to_the_model_for_bodies(name: str) -> None:
    if name == "hole":
        edges = family("hole").boundary(0.3, 101, 61)
    else:
        body = Outline(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
        edges = body.boundary(Sampling(ni=121, nj=61, topology="o"))
    solution, named = infer(edges), infer(edges, model="airfoil-o")
    assert (solution.model, named.method) == ("hole-o", "winslow")
    for one in (solution, named):
        assert "that the strip does not resolve" in one.notes[0]
    own, other = (measure(one.grid)["max_angle"] for one in (solution, named))
    assert own.mean < other.mean
    assert own.max < other.max + 0.5


def test_an_unknown_model_is_refused_with_those_that_exist() -> None:
    with pytest.raises(
        InputError, match=r"no model 'nonesuch'; use a \.safetensors file or one of: base, airfoil-o"
    ):
        infer(boundary("0012", 20, 10), model="nonesuch")


@pytest.mark.parametrize(("model", "polish"), [(None, "auto"), (None, "off"), ("airfoil-o", 1)])
def test_many_bodies_get_the_grids_they_get_alone(model: str | None, polish: Polish) -> None:
    bodies = [boundary(designation, 65, 41) for designation in ("0012", "4415", "23012-sharp")]
    bodies.insert(1, boundary("2412", 52, 33))
    bodies.insert(2, family("hole").boundary(0.3, 41, 31))  # refused: it stands between the others
    for edges, one in zip(bodies, infer_many(bodies, model, polish), strict=True):
        alone = infer(edges, model, polish)
        assert (one.method, one.model, one.cycles) == (alone.method, alone.model, alone.cycles)
        assert one.notes == alone.notes
        np.testing.assert_allclose(one.grid.nodes, alone.grid.nodes, rtol=0, atol=2e-12)


def test_no_bodies_get_no_grids() -> None:
    assert infer_many([], "airfoil-o") == []
