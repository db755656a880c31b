"""Passages of cascades: periodic sides, names, counts, folds, over blades of several kinds."""

from dataclasses import replace

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.solvers.blocking import unfolded
from meshonet.solvers.blocking.decomposition.collapse.score import deviations
from meshonet.solvers.cascade.cascade import Cascade
from meshonet.solvers.cascade.cascade_layout import cascade_layout
from meshonet.solvers.cascade.passage import Passage
from meshonet.solvers.cascade.passage_flow import PassageFlow
from meshonet.solvers.layers.layer_settings import LayerSettings

CELLS = 4000


def blade(stagger, camber=0.08, thickness=0.1, unit=1.0):
    """A cambered section of four digits, clockwise from its sharp edge, turned by `stagger` degrees."""
    x = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 70)))
    half = 5.0 * thickness * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    line = 4.0 * camber * x * (1.0 - x)
    points = np.concatenate([np.stack([x, line - half], 1)[::-1], np.stack([x, line + half], 1)[1:-1]])
    return closed(unit * turned(points, stagger))


def closed(points):
    curve = Curve(points, closed=True)
    return Loop(curve, tuple(int(k) for k in curve.corner_index), ("blade",))


def turned(points, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, s], [-s, c]])


def periodic_nodes(grid):
    """Nodes of both periodic sides, as sets sorted by place."""
    sides = {}
    for patch in grid.patches:
        if patch.kind == "periodic":
            nodes = grid.blocks[patch.block].nodes
            line = {"south": nodes[:, 0], "north": nodes[:, -1], "west": nodes[0], "east": nodes[-1]}
            sides.setdefault(patch.name, []).append(line[patch.side])
    return {name: np.unique(np.concatenate(lines), axis=0) for name, lines in sides.items()}


@pytest.mark.parametrize("stagger", [-60.0, -25.0, 0.0, 40.0, 60.0])
@pytest.mark.parametrize("pitch", [0.7, 1.5])
def test_periodic_sides_are_bitwise_a_pitch_apart_and_nothing_is_folded(stagger, pitch):
    cascade = Cascade(blade(stagger), (0.0, pitch), settings=LayerSettings(1e-5))
    layout = cascade_layout(cascade, cells=2 * CELLS)
    grid = to_grid(layout)
    sides = periodic_nodes(grid)
    np.testing.assert_array_equal(sides["periodic1"] + np.array([0.0, pitch]), sides["periodic2"])
    assert sum(count_folded(block.nodes) for block in grid.blocks) == 0
    assert {patch.name for patch in grid.patches} == {"periodic1", "periodic2", "inlet", "outlet", "blade"}
    assert layout.cells == pytest.approx(2 * CELLS, rel=0.2)
    assert deviations(layout.mesh).mean() < 5.0


def test_a_deep_channel_between_impulse_blades():
    """Blades that turn the flow by 140 degrees, a channel ten times as long as it is wide."""
    angle = np.radians(np.linspace(-70.0, 70.0, 160))
    part = np.linspace(0.0, np.pi, 160)
    half = 0.175 * np.sin(part) ** 0.8 + 0.015 * np.sqrt(
        np.clip(1.0 - np.abs(2.0 * part / np.pi - 1.0) ** 20, 0.0, 1.0)
    )
    line, normal = (np.stack([r * np.sin(angle), r * np.cos(angle)], 1) for r in (0.532, 1.0))
    points = np.concatenate([line + half[:, None] * normal, (line - half[:, None] * normal)[-2:0:-1]])
    layout = cascade_layout(Cascade(closed(points), (0.0, 0.5), settings=LayerSettings(2e-5)), cells=CELLS)
    assert sum(count_folded(layout.mesh.nodes[block]) for block in layout.blocks) == 0
    assert deviations(layout.mesh).mean() < 5.0


@pytest.mark.parametrize("pitch", [(0.0, 0.14), (0.0, -0.2), (0.1, 0.2), (0.1, -0.2)])
@pytest.mark.parametrize("layers", [None, LayerSettings(1e-4)])
def test_blades_may_be_many_pitches_long(pitch, layers):
    """Inlet and outlet would be 1e-13 wide in the plane of the passage's map."""
    layout = cascade_layout(
        Cascade(blade(0.0, camber=0.02, thickness=0.08), pitch, settings=layers), cells=6000
    )
    grid = to_grid(layout)
    sides = periodic_nodes(grid)
    moved = sides["periodic1"] + np.array(pitch)
    np.testing.assert_array_equal(moved[np.lexsort(moved.T[::-1])], sides["periodic2"])
    assert sum(count_folded(block.nodes) for block in grid.blocks) == 0
    assert layout.cells == pytest.approx(6000, rel=0.2)
    assert deviations(layout.mesh).mean() < 7.0
    on = layout.mesh.places.loop == 1
    wall = layout.mesh.domain.loops[1].at(layout.mesh.places.arc[on])
    np.testing.assert_allclose(layout.mesh.nodes[on], wall, atol=1e-9)


@pytest.mark.parametrize("unit", [1e-3, 1e3])
def test_any_unit_makes_the_same_grid(unit):
    one = cascade_layout(Cascade(blade(30.0), (0.0, 1.0)), cells=1000)
    other = cascade_layout(Cascade(blade(30.0, unit=unit), (0.0, unit)), cells=1000)
    assert one.cells == other.cells
    np.testing.assert_allclose(other.mesh.nodes / unit, one.mesh.nodes, atol=5e-3)


@pytest.mark.parametrize("pitch", [(0.0, -0.9), (0.3, 0.85), (-0.4, -0.8)])
def test_the_pitch_may_lead_anywhere(pitch):
    grid = to_grid(cascade_layout(Cascade(blade(20.0), pitch), cells=1500))
    sides = periodic_nodes(grid)
    moved = sides["periodic1"] + np.array(pitch)
    np.testing.assert_array_equal(moved[np.lexsort(moved.T[::-1])], sides["periodic2"])
    for connection in grid.connections:
        if connection.transform is not None:
            assert np.hypot(*connection.transform.translation[:2]) == pytest.approx(np.hypot(*pitch))


def test_inlet_and_outlet_are_straight_and_as_far_away_as_asked_for():
    section = blade(35.0)
    grid = to_grid(cascade_layout(Cascade(section, (0.0, 1.0), inlet=0.6, outlet=1.7), cells=1500))
    x = section.curve.points[:, 0]
    for name, wanted in (("inlet", x.min() - 0.6 * np.ptp(x)), ("outlet", x.max() + 1.7 * np.ptp(x))):
        for patch in grid.patches:
            if patch.name == name:
                nodes = grid.blocks[patch.block].nodes
                side = {"south": nodes[:, 0], "north": nodes[:, -1], "west": nodes[0], "east": nodes[-1]}
                np.testing.assert_allclose(side[patch.side][:, 0], wanted, atol=1e-9)


def test_a_blade_with_a_base_has_nodes_on_its_wall():
    section = turned(
        np.array([[0.0, 0.0], [0.1, 0.08], [0.5, 0.12], [1.0, 0.02], [1.0, -0.02], [0.5, -0.02]]), 20
    )
    layout = cascade_layout(Cascade(Loop.of_polygon(section, names=("blade",)), (0.0, 0.9)), cells=2000)
    mesh = layout.mesh
    on = mesh.places.loop == 1
    loop = mesh.domain.loops[1]
    np.testing.assert_allclose(mesh.nodes[on], loop.at(mesh.places.arc[on]), atol=1e-9)
    assert deviations(mesh).max() < 90.0


@pytest.mark.parametrize(("stagger", "pitch"), [(20.0, 0.8), (45.0, 1.0)])
def test_cells_outside_layers_go_on_with_their_heights(stagger, pitch):
    layers = LayerSettings(2e-5)
    grid = to_grid(cascade_layout(Cascade(blade(stagger), (0.0, pitch), settings=layers), cells=16000))
    (growth,) = block_figures(grid).lines.by_wall.values()
    assert growth.max < 1.3


@pytest.mark.parametrize(("stagger", "pitch"), [(40.0, 0.8), (40.0, 0.6)])
def test_cells_along_a_blade_with_a_thin_base_grow_no_faster_than_elsewhere(stagger, pitch):
    body = naca("0010").opened(0.002)
    points = body.curve.points[1:]
    settings = LayerSettings.limited(2e-5, 1.2)
    cascade = Cascade(closed(turned(points, stagger)), (0.0, pitch), settings=settings)
    grid = to_grid(cascade_layout(cascade, cells=12000))
    for growth in block_figures(grid).lines.growth.families().values():
        assert growth.max < 1.25


def test_blades_that_cross_are_refused():
    with pytest.raises(InputError, match="touch or cross"):
        cascade_layout(Cascade(blade(0.0), (0.0, 0.05)))


def test_an_inlet_too_short_for_blocks_is_refused_with_what_would_do():
    with pytest.raises(InputError, match="no room for blocks"):
        cascade_layout(Cascade(blade(0.0), (0.0, 1.0), inlet=0.01))


def test_flow_past_a_flat_plate_along_it_is_the_plate_itself():
    """A thin ellipse that lies along the axis disturbs nothing: its slit is as long as it is."""
    angle = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    points = np.cos(angle) - 1e-3j * np.sin(angle)
    assert PassageFlow.of(points).half == pytest.approx(1.0, rel=5e-3)


def test_places_in_a_passage_are_axial_distances_and_pitches():
    passage = Passage(blade(0.0), 0.2 + 1.1j, 0.1 + 0.05j, -1.0, 1.0)
    points = passage.at([-0.3, 0.7], [0.25, -0.5])
    np.testing.assert_allclose(passage.axial(points), [-0.3, 0.7], atol=1e-14)
    np.testing.assert_allclose(passage.along(points), [0.25, -0.5], atol=1e-14)
    np.testing.assert_allclose(passage.of_zeta(passage.zeta(points)), points, atol=1e-14)
    assert passage.axis @ passage.pitch == pytest.approx(0.0, abs=1e-14)


def test_cells_that_splines_fold_are_unfolded(monkeypatch):
    multiplied = unfolded.multiplied

    def crossed(layout, times):
        fine = multiplied(layout, times)
        inside = ~fine.mesh.wall_nodes[fine.mesh.quads].any(axis=1)
        one, other = fine.mesh.quads[np.flatnonzero(inside)[0], :2]
        nodes = fine.mesh.nodes.copy()
        nodes[[one, other]] = nodes[[other, one]]
        assert smallest_jacobians(nodes, fine.mesh.quads).min() < 0
        return replace(fine, mesh=fine.mesh.with_nodes(nodes))

    monkeypatch.setattr(unfolded, "multiplied", crossed)
    mesh = cascade_layout(Cascade(blade(30.0), (0.0, 1.0)), cells=1000).mesh
    assert smallest_jacobians(mesh.nodes, mesh.quads).min() > 0


def test_cells_that_stay_folded_are_refused_with_what_helps(monkeypatch):
    monkeypatch.setattr("meshonet.solvers.cascade.cascade_layout.smallest_jacobian", lambda *_: 0.0)
    with pytest.raises(NoValidGridError, match="are folded; use more cells"):
        cascade_layout(Cascade(blade(30.0), (0.0, 1.0)), cells=1000)
