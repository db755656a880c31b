"""No inner edge joins two walls, and nothing but such edges is touched."""

import numpy as np
import pytest
from planar_domains import SHAPES, domain

from meshonet.solvers.blocking.decomposition.surface.surface import join_triangles, split_edges_between_walls
from meshonet.solvers.blocking.decomposition.surface.triangulation import triangulate

NEXT = np.array([1, 2, 0])


def areas(t) -> np.ndarray:
    a, b, c = np.moveaxis(t.points[t.triangles], 1, 0)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


@pytest.mark.parametrize("name", SHAPES)
def test_every_edge_from_wall_to_wall_is_split(name):
    before = triangulate(domain(name), count=60)
    after = split_edges_between_walls(before)
    ends = after.triangles < len(after.arc)
    assert not (ends & ends[:, NEXT] & (after.neighbours >= 0)).any()
    assert np.array_equal(after.points[: len(before.points)], before.points)
    assert areas(after).min() > 0
    assert areas(after).sum() == pytest.approx(areas(before).sum(), rel=1e-12)
    assert (after.neighbours < 0).sum() == (before.neighbours < 0).sum() == len(after.arc)


def test_neighbours_are_those_of_the_triangulation():
    t = triangulate(domain("two holes"), count=300)
    neighbours, edge = join_triangles(t.triangles)
    assert np.array_equal(neighbours, t.neighbours)
    assert np.array_equal(edge, t.neighbour_edge)
