"""C sheets behind sharp edges: valid grids, wakes that conform, angles at the edge beside those of rings."""

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.solvers.blocking.c_layered import bodies_with_layers, c_layered, skewness
from meshonet.solvers.blocking.c_sheets import march_sheet
from meshonet.solvers.blocking.folds import smallest_corner
from meshonet.solvers.blocking.free_wake import free_wake
from meshonet.solvers.blocking.layer_rows import LayerSettings
from meshonet.solvers.blocking.layered import layered

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
    found = c_layered(domain, list(range(1, len(domain.loops))), FIRST, cells=12000)
    assert found is not None
    return domain, *found


def test_grids_are_valid_and_have_the_first_cells_asked_for_at_every_wall(case):
    _, layout, _ = case
    assert smallest_corner(layout.mesh) > 0.0
    assert 0.7 * 12000 < layout.cells < 1.4 * 12000
    mesh = layout.mesh
    wall = mesh.places.loop > 0
    edges = mesh.edges[wall[mesh.edges].sum(axis=1) == 1]
    leaving = np.hypot(*(mesh.nodes[edges[:, 1]] - mesh.nodes[edges[:, 0]]).T)
    corner = mesh.places.cells[edges].max(axis=1) > 0  # lines along wakes leave them too
    np.testing.assert_allclose(leaving[~corner], FIRST.first, rtol=1e-6)


def test_both_sides_of_a_wake_share_its_nodes(case):
    domain, layout, _ = case
    grid = to_grid(layout)
    assert {patch.name for patch in grid.patches} == {name for loop in domain.loops for name in loop.names}
    edge_nodes = layout.mesh.edges[layout.mesh.on_wall]
    assert (layout.mesh.places.loop[edge_nodes] >= 0).all()  # no cut is left open
    assert sum(patch.stop - patch.start for patch in grid.patches) == len(edge_nodes)


@pytest.mark.parametrize("name", ["tunnel, 0 degrees", "tunnel, 12 degrees", "far field, 4 degrees"])
def test_angles_are_better_than_in_a_ring(name):
    domain = Domain(SHARP[name])
    ring = layered(domain, [1], FIRST, cells=12000)
    chosen, notes = bodies_with_layers(domain, [1], FIRST, cells=12000)
    assert not notes
    assert skewness(chosen.mesh) < skewness(ring.mesh)
    edge = domain.loops[1].at(domain.loops[1].corner_arcs)[0]
    sheet, around = deviations(chosen, edge), deviations(ring, edge)
    assert sheet.max() < 45.0 < 75.0 < around.max()
    assert np.percentile(sheet, 99) < 0.6 * np.percentile(around, 99)
    assert sheet.mean() < 0.6 * around.mean()


def test_an_element_whose_wake_meets_another_keeps_its_ring_and_says_so():
    domain = Domain(SHARP["main element and flap"])
    assert free_wake(domain, 1, TUNNEL) is None
    assert free_wake(domain, 2, TUNNEL) is not None


@pytest.mark.parametrize("body", [section(last=0.1015), biconvex()], ids=["blunt", "biconvex"])
def test_bodies_with_other_than_one_sharp_edge_keep_rings(body):
    assert c_layered(Domain((TUNNEL, body)), [1], FIRST, cells=12000) is None
    chosen, notes = bodies_with_layers(Domain((TUNNEL, body)), [1], FIRST, cells=6000)
    assert smallest_corner(chosen.mesh) > 0.0
    assert not notes


def test_a_wake_leaves_along_the_bisector_and_meets_the_outer_loop_at_a_right_angle():
    domain = Domain((TUNNEL, section(12.0)))
    wake = free_wake(domain, 1, TUNNEL)
    assert wake is not None
    step = np.diff(wake.points, axis=0)
    angle = np.degrees(np.arctan2(step[:, 1], step[:, 0]))
    assert angle[0] == pytest.approx(-12.0, abs=0.3)
    assert angle[-1] == pytest.approx(0.0, abs=1.0)
    sheet = march_sheet(domain, 1, wake, TUNNEL, 1e-5, 0.03, 0.015)
    assert sheet is not None
    both = sheet.levels[: sheet.edge + 1, 0], sheet.levels[::-1][: sheet.edge + 1, 0]
    np.testing.assert_allclose(*both, atol=1e-12)
    np.testing.assert_allclose(sheet.levels[[0, -1], :, 0], 4.0, atol=1e-12)
