"""A domain is filled with well-shaped triangles, whatever its walls."""

import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.errors import InputError
from meshonet.kernels._native import DelaunayMesh
from meshonet.solvers.blocking.decomposition.surface.triangulation import triangulate


def circle(x, y, r, n=120):
    t = np.arange(n) * 2 * np.pi / n
    return np.c_[x + r * np.cos(t), y + r * np.sin(t)]


def box(left, right, bottom, top):
    return np.array([[left, bottom], [right, bottom], [right, top], [left, top]], dtype=float)


PLATE = [box(0, 4, 0, 3), circle(0.9, 0.8, 0.3), circle(3.1, 0.7, 0.4), circle(2, 1.8, 0.35)]
STEP = [np.array([[0, 1], [3, 1], [3, 0], [12, 0], [12, 2], [0, 2]], dtype=float)]
STAR = [np.array([[(1.2, 0.6)[k % 2] * f(k * np.pi / 5) for f in (np.cos, np.sin)] for k in range(10)])]
TWO_BODIES = [box(-2, 4, -2, 2), box(-0.5, 0.5, -0.5, 0.5), box(0.52, 1.5, -0.5, 0.5)]


def angles(t):
    """Return the angles (t, 3) in degrees."""
    x = t.points[t.triangles]
    edge = np.roll(x, -1, axis=1) - x
    back = -np.roll(edge, 1, axis=1)
    cross = edge[..., 0] * back[..., 1] - edge[..., 1] * back[..., 0]
    return np.degrees(np.arctan2(cross, (edge * back).sum(axis=2)))


def areas(t):
    x = t.points[t.triangles]
    a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    return 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def wall_polygon_area(t):
    wall = t.points[: len(t.loop)]
    rings = [wall[t.loop == k] for k in range(len(t.domain.loops))]
    return sum(0.5 * np.sum(p[:, 0] * np.roll(p[:, 1], -1) - p[:, 1] * np.roll(p[:, 0], -1)) for p in rings)


def assert_sound(t):
    """The triangles cover what is inside the walls, once, and know their neighbours."""
    assert (areas(t) > 0).all()
    np.testing.assert_allclose(areas(t).sum(), wall_polygon_area(t), rtol=1e-6)
    assert len(np.unique(t.triangles)) == len(t.points)
    directed = {(int(a[i]), int(a[(i + 1) % 3])): (k, i) for k, a in enumerate(t.triangles) for i in range(3)}
    assert len(directed) == 3 * len(t.triangles)
    count = 0
    for (a, b), (k, i) in directed.items():
        other = directed.get((b, a), (-1, -1))
        assert (t.neighbours[k, i], t.neighbour_edge[k, i]) == other
        count += other == (-1, -1)
    assert count == len(t.loop)
    for number, loop in enumerate(t.domain.loops):
        nodes = np.flatnonzero(t.loop == number)
        assert (np.diff(t.arc[nodes]) > 0).all()
        np.testing.assert_array_equal(t.points[nodes], loop.at(t.arc[nodes]))
        assert set(loop.corner_arcs) <= set(t.arc[nodes])
        for a, b in zip(nodes, np.roll(nodes, -1), strict=True):
            assert (a, b) in directed
            assert (b, a) not in directed


@pytest.mark.parametrize("polygons", [PLATE, STEP, STAR, TWO_BODIES, [circle(0, 0, 1)]])
def test_triangles_are_well_shaped_and_delaunay(polygons):
    t = triangulate(Domain.of_polygons(polygons))
    assert_sound(t)
    assert angles(t).min() > 22
    assert angles(t).min(axis=1).mean() > 47
    assert 900 < len(t.points) < 2500
    k, i = np.nonzero(t.neighbours >= 0)  # opposite angles at an inner edge
    opposite = angles(t)[k, (i + 2) % 3]
    across = angles(t)[t.neighbours[k, i], (t.neighbour_edge[k, i] + 2) % 3]
    assert (opposite + across).max() < 180 + 1e-3


def test_the_kernel_agrees_with_qhull():
    """Points in general position have one Delaunay triangulation."""
    rng = np.random.default_rng(3)
    places = rng.integers(2**28, 3 * 2**28, (500, 2))
    mesh = DelaunayMesh()
    assert mesh.insert(places, np.ones(500), rng.permutation(500)).all()
    corners = np.array(
        [[0, 0], [0, 2**30 - 1], [2**30 - 1, 0], [2**30 - 1, 2**30 - 1]]
    )  # of the kernel's box
    theirs = Delaunay(np.concatenate([corners, places]) - 2**29).simplices
    pairs = np.concatenate([theirs[:, [0, 1]], theirs[:, [1, 2]], theirs[:, [2, 0]]])
    inner = pairs[(pairs >= 4).all(axis=1)]
    assert len(inner) > 2500
    assert mesh.are_edges(inner.astype(np.int32)).all()


def test_predicates_do_not_round():
    """Cocircular and collinear points on a lattice: every cell gets one diagonal, and none overlap."""
    at = np.stack(np.meshgrid(np.arange(20), np.arange(20), indexing="ij"), axis=-1).reshape(-1, 2)
    mesh = DelaunayMesh()
    order = np.random.default_rng(0).permutation(400)
    assert mesh.insert((2**28 + at * 9_999_991).astype(np.int64), np.ones(400), order).all()
    ring = list(range(0, 400, 20)) + list(range(381, 400)) + list(range(379, 0, -20)) + list(range(18, 0, -1))
    walls = np.stack([ring, np.roll(ring, -1)], axis=1) + 4
    mesh.set_walls(walls.astype(np.int32), True)
    mesh.refine(walls.astype(np.int32), 1e300, 0.3, np.empty((0, 2)), np.empty(0), 0)
    corners, _, _ = mesh.triangles()
    assert len(corners) == 2 * 19 * 19
    x = at[corners]
    a, b = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]
    assert set(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) == {1}


def test_the_same_input_gives_the_same_bits_and_another_seed_others():
    domain = Domain.of_polygons(PLATE)
    one, again, other = triangulate(domain), triangulate(domain), triangulate(domain, seed=1)
    np.testing.assert_array_equal(one.points, again.points)
    np.testing.assert_array_equal(one.triangles, again.triangles)
    b = len(one.arc)
    assert not np.array_equal(one.points[b:], other.points[b:])


@pytest.mark.parametrize("scale", [1e-9, 1e9])
@pytest.mark.parametrize("away", [0.0, 1e5])
def test_unit_and_place_do_not_matter(scale, away):
    here = triangulate(Domain.of_polygons(PLATE))
    there = triangulate(Domain.of_polygons([(p + away) * scale for p in PLATE]))
    assert_sound(there)
    assert abs(len(there.points) - len(here.points)) < 0.02 * len(here.points)


def test_finer_where_asked():
    domain = Domain.of_polygons(PLATE)
    spot = np.array([[2.0, 0.7]])
    t = triangulate(domain, finer=(spot, np.array([0.005])))
    assert_sound(t)
    x = t.points[t.triangles]
    edge = np.linalg.norm(x[:, 1] - x[:, 0], axis=1)
    near = np.linalg.norm(x.mean(axis=1) - spot, axis=1) < 0.01
    assert near.sum() > 3
    assert edge[near].max() < 0.02
    assert edge[np.linalg.norm(x.mean(axis=1) - spot, axis=1) > 0.5].mean() > 0.05


def test_more_nodes_when_more_are_asked_for():
    domain = Domain.of_polygons([circle(0, 0, 1)])
    few, many = (len(triangulate(domain, count=n).points) for n in (1000, 4000))
    assert 3.3 < many / few < 4.3


@pytest.mark.parametrize("gap", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("kind", ["straight", "round", "neck"])
def test_a_narrow_gap_takes_few_nodes(gap, kind):
    neck = [[0, 0], [1, 0], [1, 0.5 - gap], [2, 0.5 - gap], [2, 0], [3, 0]]
    polygons = {
        "straight": [box(0, 4, 0, 2), box(0.5, 1.5, 0.5, 1.5), box(1.5 + gap, 2.5, 0.5, 1.5)],
        "round": [circle(0, 0, 1, 400), circle(0.6 - gap, 0, 0.4, 400)],
        "neck": [np.array(neck + [[x, 1 - y] for x, y in neck[::-1]])],
    }[kind]
    t = triangulate(Domain.of_polygons(polygons))
    assert_sound(t)
    assert len(t.points) < 4000


def test_walls_that_cannot_be_told_apart_are_refused_with_the_place():
    with pytest.raises(InputError, match=r"too close to each other at \(1\.5, .*loop 1 \(body\)"):
        triangulate(
            Domain.of_polygons([box(0, 4, 0, 2), box(0.5, 1.5, 0.5, 1.5), box(1.5 + 1e-11, 2.5, 0.5, 1.5)])
        )


@pytest.mark.parametrize("degrees", [5.0, 1.0, 0.1])
def test_needles_and_slits(degrees):
    rise = np.tan(np.radians(degrees))
    for polygons in (
        [np.array([[0, 0], [2, 0], [2, 2 * rise]])],
        [box(-1, 3, -1, 1), np.array([[0, 0], [2, 0], [2, 2 * rise]])],
        [np.array([[0, 0], [3, 0], [3, 1], [1, 1], [2.5, 1 - 1.5 * rise], [0, 1 - 1.5 * rise]])],
    ):
        t = triangulate(Domain.of_polygons(polygons))
        assert_sound(t)
        assert len(t.points) < 6000


def test_many_points_and_many_holes_take_no_time():
    t = np.arange(10_000) * 2 * np.pi / 10_000
    rough = 1 + 1e-3 * np.random.default_rng(0).normal(size=10_000)
    holes = [circle(0.5 + i, 0.5 + j, 0.3, 250) for i in range(8) for j in range(5)]
    for polygons in (
        [circle(0, 0, 1, 10_000)],
        [rough[:, None] * np.c_[np.cos(t), np.sin(t)]],
        [box(0, 8, 0, 5), *holes],
    ):
        start = time.perf_counter()
        triangulation = triangulate(Domain.of_polygons(polygons))
        assert time.perf_counter() - start < 3.0
        assert (areas(triangulation) > 0).all()


def test_a_small_body_in_a_far_field_keeps_its_shape():
    body = circle(0, 0, 0.5, 200) * [1, 0.12]
    t = triangulate(Domain.of_polygons([circle(0, 0, 100, 400), body]))
    assert_sound(t)
    on_body = t.points[: len(t.loop)][t.loop == 1]
    assert len(on_body) > 20
    np.testing.assert_allclose(np.ptp(on_body, axis=0), [1, 0.12], rtol=0.03)
    assert len(t.points) < 2000


@settings(max_examples=25, deadline=None)
@given(
    radii=st.lists(st.floats(0.3, 1.5), min_size=3, max_size=12),
    hole=st.floats(0.01, 0.2),
    count=st.integers(50, 800),
)
def test_any_star_shaped_polygon_with_a_hole(radii, hole, count):
    t = np.arange(len(radii)) * 2 * np.pi / len(radii)
    outer = np.array(radii)[:, None] * np.c_[np.cos(t), np.sin(t)]
    inner = circle(0, 0, hole * 0.3, 12)
    assert_sound(triangulate(Domain.of_polygons([outer, inner]), count=count))
