"""Layers around bodies: first cells, growth and angles of whole grids, over arrangements of bodies."""

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.quality.blocks import block_figures
from meshonet.solvers.blocking.layers.layered import layered
from meshonet.solvers.blocking.layers.marched import fitted
from meshonet.solvers.blocking.layers.outside import found_outside
from meshonet.solvers.energy.quad_problem import smallest_jacobian
from meshonet.solvers.layers.layer_settings import LayerSettings


def cylinder(x, y, radius, points=80):
    turn = -2 * np.pi * np.arange(points) / points
    places = np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)
    return Loop(Curve(places, closed=True, corners=()), (), ("cylinder",))


def blunt_airfoil(x, y, thickness=0.12, points=61, chord=1.0):
    at = 0.5 * (1 - np.cos(np.linspace(0, np.pi, points)))
    half = (
        5 * thickness * (0.2969 * np.sqrt(at) - 0.126 * at - 0.3516 * at**2 + 0.2843 * at**3 - 0.1015 * at**4)
    )
    upper, lower = np.stack([at, half], axis=1), np.stack([at, -half], axis=1)
    places = chord * np.concatenate([upper, lower[:0:-1]]) + np.array([x, y])
    corners = (points - 1, points)
    return Loop(Curve(places, closed=True, corners=corners), corners, ("airfoil",))


CHANNEL = Loop.of_polygon(np.array([[-3.0, -2.0], [5.0, -2.0], [5.0, 2.0], [-3.0, 2.0]]))
FAR = cylinder(0.5, 0.0, 60.0, 200)
FAR = Loop(Curve(FAR.curve.points[::-1], closed=True, corners=()), (), ("far",))

ARRANGEMENTS = {
    "cylinder in a channel": (Domain((CHANNEL, cylinder(0.1, 0.1, 0.5))), 1e-3),
    "two cylinders close together": (Domain((FAR, cylinder(0, 0, 0.5), cylinder(1.15, 0, 0.5))), 1e-4),
    "airfoil and flap": (Domain((FAR, blunt_airfoil(0, 0), blunt_airfoil(0.9, -0.2, 0.15))), 1e-5),
}


@pytest.mark.parametrize("name", ARRANGEMENTS)
def test_bodies_get_layers_of_the_first_cells_asked_for(name):
    domain, first = ARRANGEMENTS[name]
    layout = layered(domain, list(range(1, len(domain.loops))), LayerSettings(first), cells=12000)
    assert smallest_jacobian(layout.mesh.nodes, layout.mesh.quads) > 0.0
    assert 0.7 * 12000 < layout.cells < 1.4 * 12000
    nodes = layout.mesh.nodes
    for number in layout.layers:
        block = layout.blocks[number]
        height = np.hypot(*(nodes[block[:, 1]] - nodes[block[:, 0]]).T)
        np.testing.assert_allclose(height, first, rtol=1e-6)


GROWING = {  # of which all ratios can be kept: enough cells
    "cylinder in a far field": (Domain((FAR, cylinder(0, 0, 0.5))), 1e-4, 8000),
    "cylinder in a channel": (*ARRANGEMENTS["cylinder in a channel"], 20000),
    "two cylinders close together": (*ARRANGEMENTS["two cylinders close together"], 20000),
    "slat, main element and flap": (
        Domain(
            (
                FAR,
                blunt_airfoil(-0.28, -0.1, chord=0.25),
                blunt_airfoil(0, 0),
                blunt_airfoil(1.0, -0.1, chord=0.3),
            )
        ),
        1e-5,
        60000,
    ),
}


@pytest.mark.parametrize("name", GROWING)
def test_neighbouring_cells_differ_by_a_quarter_at_most_across_blocks_too(name):
    domain, first, cells = GROWING[name]
    layout = layered(domain, list(range(1, len(domain.loops))), LayerSettings(first), cells=cells)
    lines = block_figures(to_grid(layout)).lines
    assert lines.growth_inside.max <= 1.25
    assert lines.growth_across.max <= 1.25


BOX = Loop.of_polygon(np.array([[-10.0, -10.0], [20.0, -10.0], [20.0, 10.0], [-10.0, 10.0]]))
ELLIPSE = Loop(Curve(cylinder(0, 0, 1.0, 120).curve.points * [1.0, 0.3], closed=True, corners=()), (), ("e",))
LARGE_BOXES = {
    "cylinder": Domain((BOX, cylinder(0, 0, 0.5))),
    "ellipse": Domain((BOX, ELLIPSE)),
    "two cylinders": Domain((BOX, cylinder(0, 0, 0.5), cylinder(3.0, 0.2, 0.5))),
}


@pytest.mark.parametrize("name", LARGE_BOXES)
@pytest.mark.parametrize(
    ("cells", "first", "most"), [(20_000, 1e-2, 1.35), (20_000, 1e-4, 1.35), (4000, 1e-4, 1.8)]
)
def test_cells_outside_layers_go_on_with_their_heights_in_a_large_box(name, cells, first, most):
    domain = LARGE_BOXES[name]
    layout = layered(domain, list(range(1, len(domain.loops))), LayerSettings(first), cells=cells)
    figures = block_figures(to_grid(layout))
    assert figures.lines.by_wall
    for growth in figures.lines.by_wall.values():
        assert growth.max < most
        assert growth.p99 < 1.27


@pytest.mark.parametrize("cells", [6000, 20_000, 60_000])
def test_more_cells_make_angles_no_worse(cells):
    layout = layered(LARGE_BOXES["cylinder"], [1], LayerSettings(1e-3), cells=cells)
    assert block_figures(to_grid(layout)).deviation.p99 < 12.0


def test_cells_can_be_given_by_their_size():
    domain = Domain((FAR, cylinder(0, 0, 0.5)))
    few = layered(domain, [1], LayerSettings(1e-3), cell_size=0.2)
    assert few.cells < layered(domain, [1], LayerSettings(1e-3), cell_size=0.1).cells


def test_no_room_for_layers_is_said_with_its_place():
    domain = Domain((FAR, cylinder(0, 0, 0.5), cylinder(1.0001, 0, 0.5)))
    with pytest.raises(InputError, match="no room for layers"):
        layered(domain, [1, 2], LayerSettings(1e-3), cells=8000)


def test_fronts_that_nearly_touch_are_refused_with_what_helps():
    unit = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    near = Domain.of_polygons([4 * unit, unit + np.array([0.5, 1.5]), unit + np.array([1.5 + 1e-11, 1.5])])
    helps = r"too close .* use a larger \w+, a first cell half or twice as high, or open the gap"
    with pytest.raises(InputError, match=helps):
        found_outside(near, (1, 2))
    with pytest.raises(InputError, match=r"there: layers of 0\.1 fold .* use thinner first cells"):
        fitted(np.eye(3, 2), np.arange(3), 3.0, np.ones(3), 1.0, 0.1, (), place=lambda _: "there")
