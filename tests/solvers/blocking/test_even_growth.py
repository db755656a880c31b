"""Cells whose neighbours differ by a limited ratio: along a line, and in whole meshes."""

import numpy as np
import pytest

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.solvers.blocking.layers.even_mesh import evened_mesh
from meshonet.solvers.blocking.layers.growth_lines import GrowthLines
from meshonet.solvers.layers.even_line import Measures, evened_places, evened_steps

LIMIT = np.log(1.2)


def largest_growth(steps):
    return np.exp(np.abs(np.diff(np.log(steps))).max())


def evened_arcs(arcs, limit, held):
    fixed = np.minimum(np.arange(len(arcs)), np.arange(len(arcs))[::-1]) < held
    return evened_places(arcs, fixed, Measures(arcs[[0, -1]], arcs[None, [0, -1]]), limit, closed=False)


def test_arcs_keep_their_ends_and_grow_by_no_more_than_the_limit():
    arcs = np.concatenate([np.arange(30.0), 29.0 + 4.0 * np.arange(1, 31)])
    new = evened_arcs(arcs, LIMIT, 1)
    assert largest_growth(np.diff(new)) <= 1.2 + 1e-9
    assert new[0] == arcs[0]
    assert new[-1] == arcs[-1]
    assert np.abs(new - arcs)[:10].max() < 0.5  # and move most near where they differed


def test_the_less_ratios_are_kept_the_fewer_places_move():
    places = np.concatenate([np.arange(20.0), 20.0 + 1.5 * np.arange(20)])
    around = Measures(np.array([0.0, 50.0]), np.array([[0.0, 50.0]]))
    kept, given = (
        evened_places(places, np.arange(40) == 0, around, LIMIT, closed=True, change=change)
        for change in (1.0, 0.2)
    )
    assert largest_growth(np.diff(np.append(given, 50.0))) <= 1.2 + 1e-9
    moved = [np.count_nonzero(np.abs(new - places) > 0.1) for new in (kept, given)]
    assert moved[1] < 0.75 * moved[0]


def test_held_arcs_stay():
    arcs = np.concatenate([[0.0, 0.3], 0.3 + np.arange(1.0, 41.0)])
    new = evened_arcs(arcs, LIMIT, 2)
    np.testing.assert_array_equal(new[[0, 1, -2, -1]], arcs[[0, 1, -2, -1]])
    assert largest_growth(np.diff(new)) <= 1.2 + 1e-9


def test_arcs_that_grow_evenly_are_returned_as_they_are():
    arcs = np.cumsum(1.1 ** np.arange(20))
    assert evened_arcs(arcs, LIMIT, 1) is arcs


def test_steps_around_a_closed_curve_keep_their_sum_and_are_even_where_it_closes():
    steps = np.concatenate([np.ones(20), np.full(20, 5.0)])
    new = evened_steps(steps, LIMIT)
    assert new.sum() == pytest.approx(steps.sum())
    assert largest_growth(np.append(new, new[0])) <= 1.2 + 1e-9


def test_places_are_even_in_all_measures_at_once():
    arcs = np.linspace(0.0, 1.0, 401)
    wall = arcs + 0.12 * np.sin(2 * np.pi * arcs)
    measures = Measures(arcs, np.stack([arcs, wall]))
    places = np.sort(np.concatenate([np.linspace(0.0, 0.5, 30)[:-1], np.linspace(0.5, 1.0, 12)[:-1]]))
    fixed = np.arange(len(places)) == 0
    new = evened_places(places, fixed, measures, LIMIT, closed=True)
    for values, whole in ((new, 1.0), (np.interp(np.append(new, 1.0), arcs, wall)[:-1], wall[-1])):
        steps = np.diff(np.append(values, values[0] + whole))
        assert largest_growth(np.append(steps, steps[0])) <= 1.2 + 1e-9


@pytest.fixture
def mesh():
    """A square of 24 by 24 cells of which those in the middle rows are four times as high at once."""
    x = np.linspace(0.0, 1.0, 25)
    y = np.concatenate([[0.0], np.cumsum(np.where(np.abs(np.arange(24) - 12) < 3, 4.0, 1.0))])
    nodes = np.stack(np.meshgrid(x, y / y[-1], indexing="ij"), axis=2)
    block = np.arange(625).reshape(25, 25)
    loop = Loop.of_polygon(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
    places = Places.inside(625)
    sides = block[:-1, 0], block[-1, :-1], block[:0:-1, -1], block[0, :0:-1]
    for number, side in enumerate(sides):
        places.loop[side] = 0
        places.arc[side] = number + np.abs(
            nodes.reshape(-1, 2)[side] - loop.at(np.array([float(number)]))
        ).sum(axis=1)
        places.cells[side[0]] = 1
    return QuadMesh(Domain((loop,)), nodes.reshape(-1, 2), lattice_quads([block]), places)


def growth_of(mesh, free):
    lines = GrowthLines.of(mesh, 0.0)
    z = mesh.nodes[:, 0] + 1j * mesh.nodes[:, 1]
    return np.exp(np.abs(lines.some(free[lines.nodes].any(axis=1)).growth(z)).max())


def test_nodes_of_a_mesh_move_until_cells_grow_by_no_more_than_the_limit(mesh):
    held = np.isin(mesh.nodes[:, 1], [0.0, 1.0])  # nodes of the other sides slide
    new = evened_mesh(mesh, held, GrowthLines.of(mesh, np.log(1.25)))
    assert growth_of(mesh, ~held) > 3.9
    assert growth_of(new, ~held) <= 1.25
    np.testing.assert_array_equal(new.nodes[held], mesh.nodes[held])
    sides = mesh.wall_nodes & ~held
    np.testing.assert_array_equal(new.nodes[sides, 0], mesh.nodes[sides, 0])


def test_a_mesh_that_grows_evenly_is_not_changed(mesh):
    held = np.zeros(625, dtype=bool)
    np.testing.assert_array_equal(
        evened_mesh(mesh, held, GrowthLines.of(mesh, np.log(4.5))).nodes, mesh.nodes
    )


def test_a_mesh_that_cannot_be_even_stays_valid(mesh):
    held = mesh.places.loop == 0  # sides keep their jumps, so cells beside them must
    new = evened_mesh(mesh, held, GrowthLines.of(mesh, np.log(1.25)))
    corners = new.nodes[new.quads]
    edge = np.roll(corners, -1, axis=1) - corners
    before = np.roll(edge, 1, axis=1)
    assert (before[..., 0] * edge[..., 1] - before[..., 1] * edge[..., 0]).min() > 0.0


def test_no_corner_becomes_nearly_straight_or_closed(mesh):
    held = (mesh.places.loop == 0) | (np.random.default_rng(0).random(625) < 0.1)
    new = evened_mesh(mesh, held, GrowthLines.of(mesh, np.log(1.25)))
    z = (new.nodes[:, 0] + 1j * new.nodes[:, 1])[new.quads]
    angles = np.degrees(np.angle((np.roll(z, 1, axis=1) - z) / (np.roll(z, -1, axis=1) - z)))
    assert angles.min() > 15.0
    assert angles.max() < 175.0


def test_edges_at_irregular_vertices_are_compared_across_the_sides_of_blocks():
    turn = np.exp(2j * np.pi * np.arange(10) / 10)
    ring = np.where(np.arange(10) % 2 == 0, 1.0, 1.3) * turn
    ring[0] *= 2.0
    z = np.append(ring, 0.0)
    quads = np.array([[10, k, k + 1, (k + 2) % 10] for k in range(0, 10, 2)])
    nodes = np.stack([z.real, z.imag], axis=1)
    loop = Loop.of_polygon(nodes[:10])
    places = Places.inside(11)
    places.loop[:10] = 0
    lines = GrowthLines.of(QuadMesh(Domain((loop,)), nodes, quads, places), 0.0).nodes
    at = lines[lines[:, 1] == 10]
    assert sorted(map(tuple, np.sort(at[:, [0, 2]]))) == [(0, 4), (0, 6), (2, 6), (2, 8), (4, 8)]
