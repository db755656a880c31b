"""The joint optimum of a quad mesh: what it is, what stays, and that it is found from folded starts."""

import math
from dataclasses import replace

import numpy as np
import pytest
from quad_meshes import butterfly, passage, placed, rectangle, ring, sagitta

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.layers.growth_lines import GrowthLines
from meshonet.solvers.energy.quad_problem import Problem, smallest_jacobian, unknowns_of
from meshonet.solvers.energy.quads import SIZED, minimise, optimise
from meshonet.solvers.energy.walls import turned, walls_of


def circle(count: int = 90, a: float = 1.0, b: float = 1.0) -> Floats:
    t = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    return np.stack([a * np.cos(t), b * np.sin(t)], axis=1)


def shaken(mesh: QuadMesh, by: float, seed: int = 0) -> QuadMesh:
    """Return a mesh with inner nodes moved at random, by parts of a mean cell, and wall nodes half as far."""
    random = np.random.default_rng(seed)
    size = by * np.sqrt(mesh.domain.area / len(mesh.quads))
    nodes, places = mesh.nodes.copy(), mesh.places
    inside = places.loop < 0
    nodes[inside] += size * random.normal(size=(int(inside.sum()), 2))
    slides = ~inside & (places.cells == 0)
    arc = places.arc.copy()
    arc[slides] += 0.5 * size * random.normal(size=int(slides.sum()))
    return mesh.with_nodes(nodes, arc)


def problem_of(mesh: QuadMesh) -> Problem:
    unknowns = unknowns_of(mesh, None)
    walls = walls_of(mesh, unknowns.fixed, unknowns.tied)
    assert walls is not None
    return Problem(mesh, unknowns, walls, None, None)


def pairs_of(mesh: QuadMesh) -> set[tuple[int, int]]:
    """Return the pairs of edges that are compared, by going around nodes."""
    pairs = {
        tuple(sorted((int(cell[k]), int(cell[k + 2]))))
        for cell in mesh.edge_of
        for k in (0, 1)
    }  # fmt: skip
    for node in np.flatnonzero(~mesh.irregular):
        meet = np.flatnonzero((mesh.edges == node).any(axis=1))
        cells = mesh.edge_of[(mesh.quads == node).any(axis=1)]
        beside = {frozenset(set(meet) & set(cell)) for cell in cells}
        for a in meet:
            for b in meet[meet > a]:
                on_wall = mesh.wall_nodes[node]
                straight = mesh.on_wall[[a, b]].all() if on_wall else frozenset((a, b)) not in beside
                if straight:
                    pairs.add((int(a), int(b)))
    return pairs


def functional(mesh: QuadMesh, shape: float, smoothness: float) -> float:
    """Return the functional as its definition has it, wall edges that turn left out."""
    z = mesh.nodes @ np.array([1.0, 1j])
    corners = []
    for k in range(4):
        here, after, before = (z[mesh.quads[:, (k + j) % 4]] for j in (0, 1, 3))
        u, v = after - here, before - here
        g, h, area = np.abs(u) ** 2, np.abs(v) ** 2, (np.conj(u) * v).imag
        corners.append((1 - shape) * (g + h) / (2 * area) + shape * (g * h / area**2) ** 2)
    length = np.log(np.abs(np.diff(z[mesh.edges], axis=1)[:, 0]))
    squares = [(length[a] - length[b]) ** 2 for a, b in pairs_of(mesh)]
    return float(np.mean(corners) + smoothness * len(mesh.quads) * np.mean(squares))


def test_it_is_the_functional_of_its_definition() -> None:
    mesh = shaken(optimise(butterfly(circle())).mesh, 0.05)
    problem = problem_of(mesh)
    where = problem.result()
    value, _, _ = problem.descent.run(0.9, 2e-3, 0.0, 0.0, 0.0, 0, True)
    assert value == pytest.approx(functional(where, 0.9, 2e-3), rel=1e-12)


@pytest.mark.parametrize("growth", [(), (3.0, 0.05)], ids=["", "growth"])
@pytest.mark.parametrize("epsilon", [0.0, 2.0])
def test_its_gradient_is_that_of_finite_differences(epsilon: float, growth: tuple[float, ...]) -> None:
    mesh = shaken(optimise(butterfly(circle(40, 3.0), core=3, rings=2)).mesh, 0.05 if epsilon == 0 else 0.8)
    problem = problem_of(mesh)
    unknowns = 2 * len(problem.inner) + int(problem.slides.sum())
    gradient, other = np.empty(unknowns), np.empty(unknowns)
    terms = 0.9 if epsilon == 0 else 0.1, 2e-3, epsilon, 0.3
    noise = 1e-9 * abs(problem.descent.evaluate(*terms, gradient, *growth))
    nodes, arc, step = problem.nodes.copy(), problem.arc.copy(), 1e-6
    for k in range(unknowns):
        values = []
        for sign in (1.0, -1.0):
            problem.nodes[:], problem.arc[:] = nodes, arc
            if k < 2 * len(problem.inner):
                problem.nodes[problem.inner[k // 2], k % 2] += sign * step
            else:
                problem.arc[np.flatnonzero(problem.of_wall == k)] += sign * step
            values.append(problem.descent.evaluate(*terms, other, *growth))
        assert gradient[k] == pytest.approx((values[0] - values[1]) / (2 * step), rel=2e-4, abs=noise + 1e-7)


def test_growth_beyond_the_limit_is_made_less_along_lines_and_around_irregular_nodes() -> None:
    mesh = optimise(butterfly(circle(), rings=2)).mesh
    fixed = mesh.wall_nodes
    limit = math.log(1.1)
    before, after = (
        largest_growth(optimise(mesh, held=fixed, iterations=300, growth=(weight, limit)).mesh)
        for weight in (0.0, 30.0)
    )
    assert before > 1.3
    assert after < 1.0 + 0.6 * (before - 1.0)


def largest_growth(mesh: QuadMesh) -> float:
    z = mesh.nodes @ np.array([1.0, 1j])
    return float(np.exp(np.abs(GrowthLines.of(mesh, 0.0).growth(z)).max()))


def test_a_rectangle_becomes_squares() -> None:
    mesh = rectangle(np.linspace(0.0, 3.0, 13), np.linspace(0.0, 2.0, 9))
    result = optimise(shaken(mesh, 0.2), iterations=200, tolerance=1e-8)
    assert result.valid
    assert result.value == pytest.approx(1.0, abs=1e-8)
    np.testing.assert_allclose(result.mesh.nodes, mesh.nodes, atol=1e-4)


@pytest.mark.parametrize("by", [0.5, 1.0, 2.0])
def test_folded_starts_lead_to_the_same_optimum(by: float) -> None:
    best = optimise(butterfly(circle()), iterations=300, tolerance=1e-6)
    start = shaken(best.mesh, by)
    assert smallest_jacobian(start.nodes, start.quads) < 0
    result = optimise(start, iterations=300, tolerance=1e-6)
    assert result.valid
    assert result.value == pytest.approx(best.value, rel=1e-4)


def test_small_folded_cells_beside_large_ones_come_undone() -> None:
    """Around a circle out to a hundred radii cells differ in area by more than a thousand."""
    mesh = ring(np.geomspace(1.0, 100.0, 24), 30)
    random, nodes = np.random.default_rng(1), mesh.nodes.copy().reshape(24, 30, 2)
    nodes[1:-1] += 0.2 * np.geomspace(1.0, 100.0, 24)[1:-1, None, None] * random.normal(size=(22, 30, 2))
    start = mesh.with_nodes(nodes.reshape(-1, 2))
    assert smallest_jacobian(start.nodes, start.quads) < 0
    result = optimise(start, iterations=300)
    assert result.valid
    radii = np.hypot(*result.mesh.nodes.T).reshape(24, 30)
    np.testing.assert_allclose(radii, radii.mean(axis=1, keepdims=True) * np.ones(30), rtol=1e-2)


def test_what_it_calls_valid_has_no_fold_and_the_domain_s_area() -> None:
    for seed in range(10):
        result = optimise(shaken(butterfly(circle(120, 2.0)), 3.0, seed))
        z = result.mesh.nodes[result.mesh.quads] @ np.array([1.0, 1j])
        areas = (np.conj(z[:, 2] - z[:, 0]) * (z[:, 3] - z[:, 1])).imag / 2
        corners = [
            (np.conj(z[:, (k + 1) % 4] - z[:, k]) * (z[:, k - 1] - z[:, k])).imag.min() for k in range(4)
        ]
        assert result.valid == (min(corners) > 0)
        if result.valid:
            assert areas.sum() == pytest.approx(result.mesh.domain.area, rel=0.03)


@pytest.mark.parametrize(("scale", "move"), [(1e-9, 0.0), (1e9, 0.0), (1.0, 1e3), (1e-3, -7.0)])
def test_it_does_not_depend_on_units_or_place(scale: float, move: float) -> None:
    points = circle(60, 1.0, 0.7)
    here = optimise(butterfly(points))
    there = optimise(butterfly(scale * points + move))
    assert there.valid
    assert there.value == pytest.approx(here.value, rel=1e-4)
    np.testing.assert_allclose((there.mesh.nodes - move) / scale, here.mesh.nodes, atol=0.02)


def test_the_same_mesh_gives_the_same_bits() -> None:
    start = shaken(butterfly(circle(60, 1.5)), 1.0)
    first, second = optimise(start), optimise(start)
    assert first.mesh.nodes.tobytes() == second.mesh.nodes.tobytes()
    assert first.mesh.places.arc.tobytes() == second.mesh.places.arc.tobytes()


def test_wall_nodes_stay_on_their_curve_and_in_order() -> None:
    start = butterfly(circle(100, 4.0), core=8)
    for by in (0.0, 1.0):
        mesh = optimise(shaken(start, by), iterations=200).mesh
        rim = np.flatnonzero(mesh.places.loop == 0)
        loop, arc = mesh.domain.loops[0], mesh.places.arc
        np.testing.assert_array_equal(mesh.nodes[rim], loop.at(arc[rim]))
        cell, side = np.nonzero(mesh.on_wall[mesh.edge_of])
        first, second = mesh.quads[cell, side], mesh.quads[cell, (side + 1) % 4]
        gaps = (arc[second] - arc[first]) % loop.length
        assert gaps.sum() == pytest.approx(loop.length)


def test_tips_are_not_cut_off(monkeypatch: pytest.MonkeyPatch) -> None:
    start = butterfly(circle(200, 4.0), core=10)
    result = optimise(start, iterations=300)
    assert result.valid
    assert sagitta(result.mesh) < 0.25
    monkeypatch.setattr("meshonet.solvers.energy.quad_problem.BENT", 0.0)
    assert sagitta(optimise(start, iterations=300).mesh) > 1.0


def test_corners_and_held_nodes_stay_bitwise() -> None:
    mesh = shaken(rectangle(np.linspace(0.0, 3.0, 13), np.array([0, 1e-5, 3e-5, 0.2, 0.5, 1.0])), 0.0)
    held = np.zeros(len(mesh.nodes), dtype=bool).reshape(13, 6)
    held[:, :3] = True
    nodes = mesh.nodes.copy().reshape(13, 6, 2)
    nodes[1:-1, 3:-1] += 0.05
    start = mesh.with_nodes(nodes.reshape(-1, 2))
    result = optimise(start, held=held.ravel())
    assert result.valid
    stay = held.ravel() | (mesh.places.cells > 0)
    assert result.mesh.nodes[stay].tobytes() == start.nodes[stay].tobytes()
    assert result.mesh.places.arc[stay].tobytes() == start.places.arc[stay].tobytes()
    assert not np.allclose(result.mesh.nodes[~stay], start.nodes[~stay])


def test_a_held_fold_is_not_valid() -> None:
    mesh = rectangle(np.linspace(0.0, 1.0, 6), np.linspace(0.0, 1.0, 6))
    nodes = mesh.nodes.copy()
    nodes[[7, 13]] = nodes[[13, 7]]
    assert not optimise(mesh.with_nodes(nodes), held=np.ones(36, dtype=bool)).valid


def test_partners_are_one_node() -> None:
    mesh = passage()
    result = optimise(mesh, iterations=300, tolerance=1e-8)
    assert result.valid
    tied = np.flatnonzero((mesh.places.partner >= 0) & (mesh.places.cells == 0))
    partner, shift = mesh.places.partner[tied], np.array(mesh.domain.periodic[0].shift)
    np.testing.assert_array_equal(result.mesh.nodes[tied], result.mesh.nodes[partner] + shift)
    assert np.abs(result.mesh.nodes[tied] - mesh.nodes[tied]).max() > 0.01


def test_it_does_not_matter_where_a_period_is_cut() -> None:
    """The passage cut three rows higher is at its optimum where the other one was."""
    mesh = passage()
    held = np.zeros((13, 9), dtype=bool)
    held[[0, -1]] = True
    free = replace(mesh.places, loop=np.where(held.ravel(), -1, mesh.places.loop))
    mesh = replace(mesh, places=free)
    first = optimise(mesh, held=held.ravel(), iterations=400, tolerance=1e-9)
    rows = first.mesh.nodes.reshape(13, 9, 2)
    higher = np.concatenate([rows[:, 3:], rows[:, 1:4] + np.array(mesh.domain.periodic[0].shift)], axis=1)
    second = optimise(mesh.with_nodes(higher.reshape(-1, 2)), held=held.ravel(), tolerance=1e-9)
    assert second.value == pytest.approx(first.value, rel=1e-8)
    np.testing.assert_allclose(second.mesh.nodes.reshape(13, 9, 2), higher, atol=1e-4)


def test_aspects_and_targets_make_a_graded_grid_the_optimum() -> None:
    x = np.concatenate([[0.0], np.cumsum(0.1 * 1.2 ** np.arange(9))])
    wanted = rectangle(x, np.linspace(0.0, 1.0, 7))
    side = np.linalg.norm(np.diff(wanted.nodes[wanted.edges], axis=1)[:, 0], axis=1)
    aspects = side[wanted.edge_of[:, 1]] / side[wanted.edge_of[:, 0]]
    start = rectangle(np.linspace(0.0, x[-1], len(x)), np.linspace(0.0, 1.0, 7))
    start = replace(wanted, nodes=start.nodes, places=start.places)
    result = optimise(start, aspects=aspects, targets=side, iterations=300, tolerance=1e-8)
    assert result.valid
    np.testing.assert_allclose(result.mesh.nodes, wanted.nodes, atol=2e-3)


def test_nodes_that_stay_out_of_order_are_refused() -> None:
    mesh = butterfly(circle())
    cells = mesh.places.cells.copy()
    rim = np.flatnonzero(mesh.places.loop == 0)
    cells[rim] = 2
    arc = mesh.places.arc.copy()
    arc[rim[[3, 4]]] = arc[rim[[4, 3]]]
    wrong = replace(mesh, places=replace(mesh.places, cells=cells, arc=arc))
    assert not optimise(wrong).valid


def test_a_loop_turns_once_around_with_corners_left_out() -> None:
    square = Loop.of_polygon(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    assert turned(square)[-1] == pytest.approx(0.0)
    assert turned(Loop.of_polygon(circle(90)))[-1] == pytest.approx(2 * np.pi)
    assert turned(butterfly(circle(90)).domain.loops[0])[-1] == pytest.approx(2 * np.pi, rel=1e-6)


def test_two_cells_in_a_slit_end_give_their_angles_away() -> None:
    """At the tip of a thin wedge, where the domain takes up 350 degrees, two cells meet."""
    tip = np.array([0.0, 0.0])
    wedge = np.radians([5.0, 355.0])
    outline = np.array([[np.cos(a), np.sin(a)] for a in np.linspace(*wedge, 9)])
    domain = Domain((Loop.of_polygon(np.concatenate([[tip], outline]), corners=(0, 1, 3, 7, 9)),))
    loop = domain.loops[0]
    middle = 0.5 * outline
    nodes = np.concatenate([[tip], outline, middle[[4]]])
    quads = np.array([[0, 1, 5, 10], [0, 10, 5, 9]])
    walls = {0: (0, 0.0)} | {k: (0, float(loop.curve.knots[k])) for k in (1, 5, 9)}
    mesh = placed(domain, nodes, quads, walls)
    problem = problem_of(mesh)
    corners, given = problem._relief()
    assert sorted(corners[:, 0].tolist()) == [0, 0]
    np.testing.assert_allclose(given, 1.0 - np.maximum(np.sin(np.radians(175.0)), 1e-3) ** 4)


def test_a_problem_takes_one_mesh_after_the_other() -> None:
    """Where walls stay; the first and the last mesh are folded."""
    mesh = butterfly(circle())
    held = mesh.places.loop >= 0
    meshes = [shaken(mesh, by, seed) for seed, by in enumerate((1.0, 0.1, 1.0))]
    meshes = [
        each.with_nodes(np.where(held[:, None], mesh.nodes, each.nodes), mesh.places.arc) for each in meshes
    ]
    assert [smallest_jacobian(each.nodes, each.quads) > 0 for each in meshes] == [False, True, False]
    unknowns = unknowns_of(meshes[0], held)
    walls = walls_of(meshes[0], unknowns.fixed, unknowns.tied)
    assert walls is not None
    problem = Problem(meshes[0], unknowns, walls, None, None)
    for each in meshes:
        problem.take(each)
        optimum = minimise(problem, 300, 1e-8, (SIZED,), (1.0, 0.1))
        alone = optimise(each, iterations=300, tolerance=1e-8, held=held, growth=(1.0, 0.1))
        assert optimum.valid
        assert optimum.value == pytest.approx(alone.value, rel=1e-6)
        np.testing.assert_array_equal(optimum.mesh.nodes[held], mesh.nodes[held])
        np.testing.assert_allclose(optimum.mesh.nodes, alone.mesh.nodes, atol=1e-3)
