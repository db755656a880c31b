"""Domains of which one stretch of the boundary is another, moved: their sides are no walls."""

import numpy as np
import pytest

from meshonet.geometry.domain.domain import Domain, Periodic
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import SolverError
from meshonet.solvers.blocking.cross_field import cross_field
from meshonet.solvers.blocking.periodic import on_both
from meshonet.solvers.blocking.seamless_map import map_of_field, seamless_map
from meshonet.solvers.blocking.surface import Surface, periodic_pairs
from meshonet.solvers.blocking.triangulation import Triangulation

NI, NJ = 31, 12
SHIFT = (0.0, 1.0)


def waves() -> Triangulation:
    """Triangles between a wave and the same wave moved up, over a length of 3."""
    x = np.linspace(0.0, 3.0, NI)
    low = np.stack([x, 0.2 * np.sin(2.0 * x)], axis=1)
    grid = low[:, None] + np.linspace(0.0, 1.0, NJ)[None, :, None] * np.array(SHIFT)
    left = np.stack([np.zeros(NJ), np.linspace(0, 1, NJ)], axis=1)
    around = np.concatenate([low, grid[-1, 1:], grid[:-1, -1][::-1], left[1:-1][::-1]])
    corners = (0, NI - 1, NI + NJ - 2, 2 * NI + NJ - 3)
    loop = Loop.of_polygon(around, corners)
    arcs = loop.corner_arcs
    periodic = Periodic((arcs[0], arcs[1]), (arcs[2], arcs[3]), SHIFT)
    number = np.arange(NI * NJ).reshape(NI, NJ)
    ring = np.concatenate([number[:, 0], number[-1, 1:], number[:-1, -1][::-1], number[0, 1:-1][::-1]])
    order = np.concatenate([ring, np.setdiff1d(number, ring)])
    new = np.empty(NI * NJ, dtype=np.intp)
    new[order] = np.arange(NI * NJ)
    west, east = new[number][:-1], new[number][1:]
    a, b, c, d = west[:, :-1].ravel(), east[:, :-1].ravel(), east[:, 1:].ravel(), west[:, 1:].ravel()
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])
    points = grid.reshape(-1, 2)[order]
    neighbours, edge = joined(triangles)
    return Triangulation(
        Domain((loop,), periodic=periodic),
        points,
        triangles,
        np.zeros(len(ring), dtype=np.intp),
        loop.curve.knots,
        neighbours,
        edge,
    )


def joined(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    halves = {(f[i], f[(i + 1) % 3]): (n, i) for n, f in enumerate(triangles.tolist()) for i in range(3)}
    found = [[halves.get((f[(i + 1) % 3], f[i]), (-1, -1)) for i in range(3)] for f in triangles.tolist()]
    return np.array(found)[..., 0], np.array(found)[..., 1]


def test_a_wavy_period_does_not_bend_the_map():
    """From a straight inlet to a straight outlet the map is the identity, whatever the sides look like."""
    m = map_of_field(cross_field(Surface.of(waves())))
    z = m.triangulation.points[m.triangulation.triangles] @ np.array([1, 1j])
    slope = (m.corner_coords[:, 1:] - m.corner_coords[:, :1]) / (z[:, 1:] - z[:, :1])
    assert np.allclose(slope, slope[0, 0], atol=1e-9)
    assert np.abs(slope[0, 0]) == pytest.approx(1.0, abs=1e-9)
    assert len(m.singular) == 0
    assert (m.valence[m.valence > 0] == 4).all()


def test_only_inlet_and_outlet_are_walls_and_have_no_corners():
    m = map_of_field(cross_field(Surface.of(waves())))
    f, e = np.nonzero(m.neighbours < 0)
    x = m.triangulation.points[m.triangulation.triangles[f, e], 0]
    assert len(f) == 2 * (NJ - 1)
    assert set(np.round(x, 12)) == {0.0, 3.0}
    assert not m.corner_cells.any()
    assert (m.boundary_cells[m.on_wall[: len(m.boundary_cells)]] == 2).all()


def test_crossing_the_period_says_how_points_are_to_be_moved():
    m = map_of_field(cross_field(Surface.of(waves())))
    f, e = np.nonzero(m.periods)
    g, i = m.neighbours[f, e], m.neighbour_edge[f, e]
    assert len(f) == 2 * (NI - 1)
    assert (m.periods[g, i] == -m.periods[f, e]).all()
    triangles, points = m.triangulation.triangles, m.triangulation.points
    here, there = points[triangles[f, e]], points[triangles[g, (i + 1) % 3]]
    assert np.allclose(here + m.periods[f, e][:, None] * SHIFT, there)


def test_vertices_that_do_not_correspond_are_refused():
    t = waves()
    points = t.points.copy()
    points[5] += 0.01
    moved = Triangulation(t.domain, points, t.triangles, t.loop, t.arc, t.neighbours, t.neighbour_edge)
    with pytest.raises(SolverError, match="correspond"):
        Surface.of(moved)


def passage() -> Domain:
    """A wavy period of pitch 1 around an ellipse that leans."""
    t = waves()
    lean = np.exp(-0.3j) * (0.5 * np.cos(a := np.arange(60) * np.pi / 30) - 0.12j * np.sin(a))
    ellipse = np.stack([1.4 + lean.real, 0.6 + lean.imag], axis=1)
    return Domain((t.domain.loops[0], Loop.of_polygon(ellipse)), periodic=t.domain.periodic)


def test_a_triangulated_passage_has_one_vertex_for_the_other_and_a_map():
    m = seamless_map(passage(), count=700)
    first, second = periodic_pairs(m.triangulation)
    assert np.allclose(m.triangulation.points[first] + SHIFT, m.triangulation.points[second], atol=1e-9)
    assert (m.vertices != m.triangulation.triangles).any()
    assert m.folded == 0
    boundary = np.flatnonzero(m.on_wall)
    inner = m.valence[m.valence > 0]
    assert (4 - inner).sum() + (2 - m.boundary_cells[boundary]).sum() == -4  # an annulus less a disc
    w = m.corner_coords
    f, e = np.nonzero(m.periods)
    g, i = m.neighbours[f, e], m.neighbour_edge[f, e]
    here, there = w[f, (e + 1) % 3] - w[f, e], w[g, i] - w[g, (i + 1) % 3]
    assert np.abs(there - 1j ** m.turns[f, e] * here).max() < 1e-12


def test_places_are_copied_to_the_other_stretch_once():
    shape = passage()
    length = shape.loops[0].length
    start, end = shape.periodic.first[0], shape.periodic.second[1]
    arc = np.array([start, start + 0.5, end - 0.5, end - 0.7, length - 0.01])
    loop, both = on_both(shape, np.zeros(5, dtype=int), arc)
    expected = [start, start + 0.5, start + 0.7, end - 0.5, end - 0.7, length - 0.01]
    assert np.allclose(np.sort(both), np.sort(expected))
    assert len(loop) == 6
