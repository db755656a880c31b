"""Layers behind sharp edges as well: valid grids, wakes that conform, angles at the edge."""

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.solvers.blocking.layers import layered as pipeline
from meshonet.solvers.blocking.layers.layered import layered
from meshonet.solvers.blocking.layers.wall_rows import has_sharp_edge
from meshonet.solvers.energy.quad_problem import smallest_jacobian
from meshonet.solvers.layers.layer_settings import LayerSettings

FIRST = LayerSettings(1e-5)


def section(incidence=0.0, chord=1.0, at=(0.0, 0.0), last=0.1036, points=70):
    """NACA 0012 around its middle, clockwise from a trailing edge that is blunt with `last` 0.1015."""
    x = 0.5 * (1 - np.cos(np.linspace(0, np.pi, points)))
    y = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - last * x**4)
    lower, upper = np.stack([x, -y], axis=1)[::-1], np.stack([x, y], axis=1)[1:]
    blunt = last < 0.1036
    places = np.concatenate([lower, upper if blunt else upper[:-1]]) - [0.5, 0.0]
    turn = -np.radians(incidence)
    places = chord * places @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]) + at
    corners = (0, len(places) - 1) if blunt else (0,)
    return Loop(Curve(places, closed=True, corners=corners), corners, ("airfoil",))


def biconvex():
    x = np.linspace(-0.5, 0.5, 41)
    y = 0.2 * (0.25 - x * x)
    places = np.concatenate([np.stack([x[::-1], -y], axis=1), np.stack([x, y], axis=1)[1:-1]])
    return Loop(Curve(places, closed=True, corners=(0, 40)), (0, 40), ("airfoil",))


TUNNEL = Loop.of_polygon(
    np.array([[-2.0, -2.0], [4.0, -2.0], [4.0, 2.0], [-2.0, 2.0]]),
    (0, 1, 2, 3),
    ("floor", "outlet", "roof", "inlet"),
)
TURN = np.linspace(0.0, 2.0 * np.pi, 200, endpoint=False)
FAR = Loop(
    Curve(30.0 * np.stack([np.cos(TURN), np.sin(TURN)], axis=1), closed=True, corners=()), (), ("far",)
)
MAIN, FLAP = section(2.0), section(25.0, 0.35, (0.62, -0.14))

SHARP = {
    "tunnel, 0 degrees": (TUNNEL, section()),
    "tunnel, 12 degrees": (TUNNEL, section(12.0)),
    "far field, 4 degrees": (FAR, section(4.0)),
    "two behind each other": (TUNNEL, section(4.0, 1.0, (0.0, 0.5)), section(-3.0, 0.7, (1.0, -0.6))),
    "main element and flap": (TUNNEL, MAIN, FLAP),
}


def deviations(layout, place, radius=0.05):
    """Deviations (m, 4) from right angles, in degrees, of cells near a place."""
    z = layout.mesh.nodes[layout.mesh.quads] @ np.array([1.0, 1.0j])
    ahead = np.roll(z, -1, axis=1) - z
    angle = np.degrees(np.angle(-np.roll(ahead, 1, axis=1) / ahead)) % 360.0
    return np.abs(angle - 90.0)[np.abs(z.mean(axis=1) - complex(*place)) < radius]


@pytest.fixture(scope="module", params=SHARP)
def case(request):
    domain = Domain(SHARP[request.param])
    return domain, layered(domain, list(range(1, len(domain.loops))), FIRST, cells=12000)


def test_grids_are_valid_and_have_the_first_cells_asked_for_at_every_wall(case):
    _, layout = case
    assert smallest_jacobian(layout.mesh.nodes, layout.mesh.quads) > 0.0
    assert 0.7 * 12000 < layout.cells < 1.4 * 12000
    mesh = layout.mesh
    wall = mesh.places.loop > 0
    edges = mesh.edges[wall[mesh.edges].sum(axis=1) == 1]
    leaving = np.hypot(*(mesh.nodes[edges[:, 1]] - mesh.nodes[edges[:, 0]]).T)
    corner = mesh.places.cells[edges].max(axis=1) > 0  # lines along wakes leave them too
    np.testing.assert_allclose(leaving[~corner], FIRST.first, rtol=1e-6)


def test_both_sides_of_a_wake_share_its_nodes(case):
    domain, layout = case
    grid = to_grid(layout)
    assert {patch.name for patch in grid.patches} == {name for loop in domain.loops for name in loop.names}
    edge_nodes = layout.mesh.edges[layout.mesh.on_wall]
    assert (layout.mesh.places.loop[edge_nodes] >= 0).all()  # no cut is left open
    assert sum(patch.stop - patch.start for patch in grid.patches) == len(edge_nodes)


@pytest.mark.parametrize("name", ["tunnel, 0 degrees", "far field, 4 degrees"])
def test_angles_are_better_than_in_a_ring(name, monkeypatch):
    domain = Domain(SHARP[name])
    sheet = layered(domain, [1], FIRST, cells=12000)
    monkeypatch.setattr(pipeline, "has_sharp_edge", lambda loop: False)
    ring = layered(domain, [1], FIRST, cells=12000)
    edge = domain.loops[1].at(domain.loops[1].corner_arcs)[0]
    behind, around = deviations(sheet, edge), deviations(ring, edge)
    assert behind.max() < 60.0 < 75.0 < around.max()
    assert np.percentile(behind, 99) < 0.6 * np.percentile(around, 99)


def test_wakes_go_along_a_line_of_the_grid_as_fine_as_the_wall_at_the_edge():
    domain = Domain(SHARP["far field, 4 degrees"])
    mesh = layered(domain, [1], FIRST, cells=12000).mesh
    edge = int(np.flatnonzero((mesh.places.loop == 1) & (mesh.places.cells == 4))[0])
    ends = mesh.edges[(mesh.edges == edge).any(axis=1)]
    assert len(ends) == 5  # two walls, a wake, and a line to either side
    lengths = np.sort(np.hypot(*(mesh.nodes[ends[:, 1]] - mesh.nodes[ends[:, 0]]).T))
    np.testing.assert_allclose(lengths[:2], FIRST.first, rtol=1e-6)
    assert lengths[4] < 3.0 * lengths[2]


@pytest.mark.parametrize("name", ["tunnel, 0 degrees", "far field, 4 degrees"])
def test_cells_along_wakes_begin_with_those_along_the_wall(name):
    domain = Domain(SHARP[name])
    layout = layered(domain, [1], FIRST, cells=12000)
    edge = domain.loops[1].at(domain.loops[1].corner_arcs)[0]
    largest = 1.0
    for block in layout.blocks:
        z = layout.mesh.nodes[block] @ np.array([1.0, 1.0j])
        for lines in (z, z.T):
            steps = np.abs(np.diff(lines, axis=1))
            ratio = np.abs(np.log(steps[:, 1:] / steps[:, :-1]))
            near = np.abs(lines[:, 1:-1] - complex(*edge)) < 0.3
            largest = max(largest, float(np.exp(ratio[near].max(initial=0.0))))
    assert largest < 1.35


@pytest.mark.parametrize("body", [section(last=0.1015), biconvex()], ids=["blunt", "biconvex"])
def test_bodies_with_other_than_one_sharp_edge_keep_rings(body):
    assert not has_sharp_edge(body)
    chosen = layered(Domain((TUNNEL, body)), [1], FIRST, cells=6000)
    assert smallest_jacobian(chosen.mesh.nodes, chosen.mesh.quads) > 0.0
