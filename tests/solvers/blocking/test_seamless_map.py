"""The map against its conditions, written again, and against maps that are known."""

import numpy as np
import pytest
from planar_domains import SHAPES, circle, domain, wedge

from meshonet.geometry.domain.domain import Domain
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap, seamless_map
from meshonet.solvers.blocking.decomposition.surface.triangulation import triangulate

NEXT, PREVIOUS = np.array([1, 2, 0]), np.array([2, 0, 1])
QUARTER = np.pi / 2


@pytest.fixture(scope="module", params=SHAPES)
def built(request) -> SeamlessMap:
    return seamless_map(domain(request.param), count=900)


def cells_around(m: SeamlessMap) -> np.ndarray:
    cells = m.valence.copy()
    cells[: len(m.boundary_cells)] += m.boundary_cells
    return cells


def areas(m: SeamlessMap) -> np.ndarray:
    """Twice the areas of the triangles in the map, negative where they are turned over."""
    first, second = m.corner_coords[:, 1:].T - m.corner_coords[:, 0]
    return (np.conj(first) * second).imag


def test_no_triangle_is_turned_over(built):
    assert areas(built).min() > 0


def test_coordinates_across_every_edge_are_quarter_turns_of_each_other(built):
    w = built.corner_coords
    f, e = np.nonzero(built.surface.neighbours >= 0)
    g, i = built.surface.neighbours[f, e], built.surface.neighbour_edge[f, e]
    here, there = w[f, NEXT[e]] - w[f, e], w[g, i] - w[g, NEXT[i]]
    assert np.abs(there - 1j ** built.turns[f, e] * here).max() < 1e-12 * np.abs(w).max()
    assert (built.surface.neighbours[g, i] == f).all()
    assert ((built.turns[f, e] + built.turns[g, i]) % 4 == 0).all()


def test_walls_are_lines_of_the_map_and_run_forwards(built):
    w = built.corner_coords
    f, e = np.nonzero(built.surface.neighbours < 0)
    step = w[f, NEXT[e]] - w[f, e]
    along = step / 1j ** np.round(np.angle(step) / QUARTER)
    assert np.abs(along.imag).max() < 1e-12 * np.abs(w).max()
    assert along.real.min() > 0


def test_angles_of_the_map_around_a_vertex_are_as_many_quarters_as_cells(built):
    w = built.corner_coords
    angles = np.angle((w[:, PREVIOUS] - w) / (w[:, NEXT] - w))
    around = np.bincount(built.surface.triangles.ravel(), angles.ravel())
    assert np.allclose(around, QUARTER * cells_around(built), atol=1e-9)


def test_singularities_add_up_as_poincare_and_hopf_say(built):
    holes = len(built.surface.domain.loops) - 1
    boundary = len(built.boundary_cells)
    total = (4 - built.valence[boundary:]).sum() + (2 - built.boundary_cells).sum()
    assert total == 4 * (1 - holes)


def test_corners_have_the_cells_that_their_angles_ask_for(built):
    wanted = built.corner_cells
    assert (wanted > 0).sum() == sum(len(loop.corners) for loop in built.surface.domain.loops)
    assert (built.boundary_cells[wanted > 0] == wanted[wanted > 0]).all()
    for number, loop in enumerate(built.surface.domain.loops):
        here = (wanted > 0) & (built.surface.loop == number)
        assert np.allclose(np.sort(built.surface.arc[here]), loop.corner_arcs)


def test_fans_go_around_each_vertex_counter_clockwise(built):
    start, corners = built.surface.fans
    for vertex in range(0, len(built.valence), 7):
        f, i = np.divmod(corners[start[vertex] : start[vertex + 1]], 3)
        assert (built.surface.triangles[f, i] == vertex).all()
        crossed = PREVIOUS[i]
        assert (built.surface.neighbours[f, crossed][:-1] == f[1:]).all()
        if built.surface.on_wall[vertex]:
            assert built.surface.neighbours[f[0], i[0]] == built.surface.neighbours[f[-1], crossed[-1]] == -1
        else:
            assert built.surface.neighbours[f[-1], crossed[-1]] == f[0]


def test_a_tilted_rectangle_is_mapped_to_itself():
    turn = np.exp(0.3j)
    corners = np.array([0, 3, 3 + 1j, 1j]) * turn
    m = seamless_map(Domain.of_polygons([np.stack([corners.real, corners.imag], axis=1)]))
    z = m.surface.points @ np.array([1, 1j])
    w, z = m.corner_coords, z[m.surface.triangles]
    slope = (w[:, 1:] - w[:, :1]) / (z[:, 1:] - z[:, :1])
    quarters = np.angle(slope[0, 0] * turn) / QUARTER
    assert quarters == pytest.approx(round(quarters), abs=1e-9)
    assert np.allclose(slope, slope[0, 0], atol=1e-9)
    assert abs(slope[0, 0]) == pytest.approx(1.0, abs=1e-9)
    assert len(m.singular) == 0


def test_an_annulus_is_mapped_by_the_logarithm():
    m = seamless_map(Domain.of_polygons([circle(0, 0, 1, 400), circle(0, 0, 0.4, 400)]), count=3000)
    assert len(m.singular) == 0
    assert (m.boundary_cells == 2).all()
    w, r = m.corner_coords, np.hypot(*m.surface.points.T)[m.surface.triangles]
    f, e = np.nonzero(m.surface.neighbours < 0)
    around, outer = np.abs(w[f, NEXT[e]] - w[f, e]), r[f, e] > 0.7
    assert around[outer].sum() == pytest.approx(around[~outer].sum(), rel=1e-9)
    area = 0.5 * (np.conj(w[:, 1] - w[:, 0]) * (w[:, 2] - w[:, 0])).imag.sum()
    # a rectangle, 2 pi around and ln(1 / 0.4) from wall to wall
    assert area / around[outer].sum() ** 2 == pytest.approx(np.log(1 / 0.4) / (2 * np.pi), rel=5e-3)


def test_a_disc_has_four_vertices_of_valence_three():
    m = seamless_map(domain("disc"))
    boundary = np.flatnonzero(m.boundary_cells != 2)
    boundary = boundary[m.boundary_cells[boundary] > 0]
    kinds = sorted([*m.valence[m.singular], *(m.boundary_cells[boundary] + 2)])
    assert kinds == [3, 3, 3, 3]


def test_triangles_are_finer_at_a_singularity():
    m = seamless_map(domain("triangle"))
    assert m.valence[m.singular].tolist() == [3]
    (place,) = m.surface.points[m.singular]  # beside that of the first field, for which they are finer
    assert edges_near(m.surface, place) < 0.8 * edges_near(triangulate(domain("triangle")), place)


def test_triangles_are_as_fine_as_is_asked_for_at_a_place():
    plain = triangulate(domain("triangle"))
    place = plain.points[np.argmin(np.hypot(*(plain.points - [0.5, 0.28]).T))]
    size = 0.35 * edges_near(plain, place)
    finer = triangulate(domain("triangle"), finer=(place[None], np.array([size])))
    assert edges_near(finer, place) < 0.6 * edges_near(plain, place)


def edges_near(triangulation, place):
    """Return the mean length of the edges of the triangles nearest to a place."""
    z = triangulation.points @ np.array([1, 1j])
    corners = z[triangulation.triangles]
    near = np.argsort(np.abs(corners.mean(axis=1) - complex(*place)))[:6]
    return np.abs(np.roll(corners, -1, axis=1) - corners)[near].mean()


def test_needles_of_half_a_degree_stay_folded():
    assert areas(seamless_map(Domain.of_polygons([wedge(0.5)]), count=300)).min() <= 0


@pytest.mark.parametrize("unit", [1e-9, 1e9])
def test_the_unit_of_length_and_the_place_do_not_matter(unit):
    shape = SHAPES["two holes"]
    plain = seamless_map(Domain.of_polygons(shape))
    moved = seamless_map(Domain.of_polygons([unit * loop for loop in shape]))
    assert sorted(plain.valence[plain.singular]) == sorted(moved.valence[moved.singular])
    assert areas(moved).min() > 0


def test_the_same_domain_has_the_same_map_bit_for_bit():
    first, second = (seamless_map(domain("two holes")).corner_coords for _ in range(2))
    assert np.array_equal(first, second)
