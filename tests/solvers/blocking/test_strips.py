"""Layers along named walls of ducts, steps, branches and cavities: first cells and angles of whole grids."""

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.solvers.blocking.layers.layered import layered
from meshonet.solvers.blocking.layers.stretches import continued_notes, layered_walls
from meshonet.solvers.energy.quad_problem import smallest_jacobian
from meshonet.solvers.layers.layer_settings import LayerSettings

FIRST = 1e-3
SIDES = {"south": (0, 1), "north": (-1, -2)}


def polygon(points, names):
    return Loop.of_polygon(np.array(points, dtype=float), None, tuple(names.split()))


def circle(x, y, radius, name, hole=True):
    turn = np.linspace(0.0, 2.0 * np.pi, 100, endpoint=False) * (-1.0 if hole else 1.0)
    places = np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)
    return Loop(Curve(places, closed=True, corners=()), (), (name,))


def nozzle():
    x = np.linspace(-2.0, 3.0, 101)
    half = 0.5 + 0.125 * x**2 * np.where(x < 0, 1.0, 0.5)
    points = np.concatenate([np.stack([x, -half], axis=1), np.stack([x, half], axis=1)[::-1]])
    straight = np.zeros(len(points), dtype=bool)
    straight[[100, 201]] = True
    corners = (0, 100, 101, 201)
    curve = Curve(points, closed=True, corners=corners, straight=straight)
    return Loop(curve, corners, ("floor", "outlet", "roof", "inlet"))


def elbow():
    turn = np.linspace(np.pi / 2, 0.0, 41)
    inner = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    points = np.concatenate(
        [[[-2.0, 1.0]], inner, [[1.0, -2.0], [2.0, -2.0]], 2.0 * inner[::-1], [[-2.0, 2.0]]]
    )
    corners = (0, 42, 43, 85)
    curve = Curve(points, closed=True, corners=corners, straight=np.ones(len(points), dtype=bool))
    return Loop(curve, corners, ("inner", "outlet", "outer", "inlet"))


TUNNEL = polygon([[0, 0], [22, 0], [22, 4.1], [0, 4.1]], "floor outlet roof inlet")
STEP = polygon([[0, 1], [2, 1], [2, 0], [8, 0], [8, 2], [0, 2]], "floor face floor outlet roof inlet")
BRANCH = polygon(
    [[0, 0], [3, 0], [3, -2], [4, -2], [4, 0], [7, 0], [7, 1], [0, 1]], "wall wall down wall wall out wall in"
)
CAVITY = polygon([[0, 0], [1, 0], [1, 1], [0, 1]], "lid a b c")
ANGLE = polygon([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], "wall wall wall wall wall wall")
BRACKET = polygon([[0, 0], [0, 2], [1, 2], [1, 1], [2, 1], [2, 0]], "part part part part part part")

CASES = {  # loops, walls with layers, cells, most irregular vertices, 99th percentile of angles off 90
    "cylinder in a tunnel": ((TUNNEL, circle(2, 2, 0.5, "rod")), "floor roof rod", 12000, 4, 20),
    "floor of a duct": ((polygon([[0, 0], [4, 0], [4, 1], [0, 1]], "floor b c d"),), "floor", 4000, 0, 3),
    "contraction": (
        (polygon([[0, 0], [4, 0], [4, 1], [0, 2]], "floor b roof d"),),
        "floor roof",
        4000,
        0,
        15,
    ),
    "nozzle": ((nozzle(),), "floor roof", 5000, 0, 25),
    "elbow": ((elbow(),), "inner outer", 5000, 0, 5),
    "backward-facing step": ((STEP,), "floor face roof", 8000, 1, 25),
    "branch": ((BRANCH,), "wall", 8000, 2, 30),
    "cavity": ((CAVITY,), "lid a b c", 6000, 0, 3),
    "angle": ((ANGLE,), "wall", 6000, 1, 22),
    "pipe": ((circle(0, 0, 1, "pipe", False),), "pipe", 5000, 4, 15),
    "bracket in a pipe": ((circle(0, 0, 8, "far", False), BRACKET), "part", 8000, 9, 45),
}


def grid_of(name):
    loops, names, cells, *_ = CASES[name]
    domain = Domain(loops)
    whole, stretches = layered_walls(domain, names.split())
    return domain, layered(domain, whole, LayerSettings(FIRST), stretches=stretches, cells=cells)


@pytest.fixture(scope="module", params=CASES)
def case(request):
    return request.param, *grid_of(request.param)


def first_cells(layout, names):
    """Lengths of the edges that leave nodes of the named walls, along the lines across these."""
    lengths = []
    grid = to_grid(layout)
    for patch in grid.outer_patches():
        if patch.name in names:
            nodes = grid.blocks[patch.block].nodes
            lines = nodes if patch.side in ("south", "north") else nodes.transpose(1, 0, 2)
            first, second = SIDES["south" if patch.side in ("south", "west") else "north"]
            line = np.s_[patch.start : patch.stop + 1]
            lengths.append(np.hypot(*(lines[line, second] - lines[line, first]).T))
    return np.concatenate(lengths)


def test_grids_are_valid_and_cover_the_domain(case):
    _, domain, layout = case
    z = layout.mesh.nodes[layout.mesh.quads] @ np.array([1.0, 1.0j])
    ahead = np.roll(z, -1, axis=1) - z
    assert (np.conj(np.roll(ahead, 1, axis=1)) * ahead).imag.min() > 0.0
    area = 0.5 * (np.conj(z) * np.roll(z, -1, axis=1)).imag.sum()
    assert area == pytest.approx(domain.area, rel=5e-4)
    assert {patch.name for patch in to_grid(layout).outer_patches()} == {
        name for loop in domain.loops for name in loop.names
    }


def test_first_cells_are_exact_at_every_node_of_the_named_walls(case):
    name, _, layout = case
    np.testing.assert_allclose(first_cells(layout, CASES[name][1].split()), FIRST, rtol=1e-6)


def test_about_as_many_cells_as_asked_few_irregular_vertices_and_good_angles(case):
    name, _, layout = case
    _, _, cells, irregular, most = CASES[name]
    assert 0.7 * cells < layout.cells < 1.4 * cells
    mesh = layout.mesh
    assert (mesh.irregular & ~mesh.wall_nodes).sum() <= irregular
    z = mesh.nodes[mesh.quads] @ np.array([1.0, 1.0j])
    ahead = np.roll(z, -1, axis=1) - z
    angle = np.degrees(np.angle(-np.roll(ahead, 1, axis=1) / ahead)) % 360.0
    off = np.abs(angle - 90.0)
    assert np.percentile(off, 99) < most
    assert off.mean() < 3.0


@pytest.mark.parametrize("case", ["contraction", "nozzle", "branch"], indirect=True)
def test_neighbouring_cells_in_ducts_differ_by_little_more_than_a_quarter(case):
    _, _, layout = case
    for block in layout.blocks:
        z = layout.mesh.nodes[block] @ np.array([1.0, 1.0j])
        for lines in (z, z.T):
            steps = np.abs(np.diff(lines, axis=1))
            ratio = steps[:, 1:] / steps[:, :-1]
            assert np.maximum(ratio, 1.0 / ratio).max(initial=1.0) < 1.31


def test_where_layers_end_the_nodes_of_inlet_and_outlet_have_their_heights():
    _, layout = grid_of("cylinder in a tunnel")
    mesh = layout.mesh
    inlet = mesh.nodes[(mesh.places.loop == 0) & (mesh.nodes[:, 0] == 0.0), 1]
    steps = np.diff(np.sort(inlet))
    np.testing.assert_allclose(steps[[0, -1]], FIRST, rtol=1e-6)
    assert np.abs(np.diff(np.log(steps))).max() < np.log(1.3)


def test_in_a_corner_of_two_walls_both_have_layers():
    _, layout = grid_of("cavity")
    nodes = layout.mesh.nodes
    floor = np.sort(nodes[nodes[:, 1] == 0.0, 0])
    side = np.sort(nodes[nodes[:, 0] == 0.0, 1])
    np.testing.assert_allclose(np.diff(floor)[[0, -1]], FIRST, rtol=1e-6)
    np.testing.assert_allclose(np.diff(side)[[0, -1]], FIRST, rtol=1e-6)
    corner = nodes[(nodes < 2.5 * FIRST).all(axis=1)]  # three nodes either way, along straight lines
    for axis in (0, 1):  # the third as high as the cells beyond ask for, of which those of two walls differ
        heights = np.sort(corner[:, axis]).reshape(3, 3)
        np.testing.assert_allclose(heights[:2], np.repeat([[0.0], [FIRST]], 3, axis=1), rtol=1e-7)
        assert np.ptp(heights[2]) < 1e-2 * FIRST


@pytest.mark.parametrize(
    ("loop", "names", "problem"),
    [
        (STEP, "face", r"at face would end where the boundary turns away, at \(2, 1\); name floor as well"),
        (
            polygon([[0, 0], [2, 0], [4, 1.2], [4, 2], [0, 2]], "slip floor b c d"), "floor",
            r"would end where the boundary goes straight on, at \(2, 0\); name slip as well",
        ),
    ],
)  # fmt: skip
def test_layers_that_would_end_elsewhere_than_at_convex_corners_are_refused_with_the_place(
    loop, names, problem
):
    with pytest.raises(InputError, match=problem):
        layered_walls(Domain((loop,)), names.split())


@pytest.mark.parametrize("line", ["axis", "symmetry"])
def test_layers_go_on_along_an_axis_or_a_symmetry_line_that_continues_a_wall(line):
    """A body with a blunt front and a pointed tail."""
    points = [[-2, 0], [0, 0], [0, 0.3], [1, 0.3], [2, 0], [4, 0], [4, 2], [-2, 2]]
    names = f"{line} body body body {line} outlet wall inlet"
    loop = Loop.of_polygon(np.array(points, dtype=float), tuple(range(8)), tuple(names.split()))
    domain = Domain((loop,))
    _, stretches = layered_walls(domain, ["body"])
    assert [each.names(loop) for each in stretches] == [("body", "body", "body", line)]
    assert continued_notes(domain, ["body"]) == [f"layers at body go on along {line} beyond (2, 0)"]
    layout = layered(domain, [], LayerSettings(FIRST), stretches=stretches, cells=3000)
    assert smallest_jacobian(layout.mesh.nodes, layout.mesh.quads) > 0.0
    np.testing.assert_allclose(first_cells(layout, ["body"]), FIRST, rtol=1e-6)
    fore, aft = (layout.mesh.nodes[:, 0] < 0.0), (layout.mesh.nodes[:, 0] > 2.0)
    heights = [layout.mesh.nodes[side & (layout.mesh.nodes[:, 1] > 0.0), 1].min() for side in (fore, aft)]
    assert heights[1] == pytest.approx(FIRST, rel=0.02)  # lines lean at the tail
    assert heights[0] > 3.0 * FIRST


@pytest.mark.parametrize("name", ["inlet", "slip"])
def test_layers_do_not_go_on_along_other_sides(name):
    points = np.array([[0, 0], [2, 0], [4, 0.1], [4, 2], [0, 2]])
    loop = Loop.of_polygon(points, tuple(range(5)), ("floor", name, "b", "c", "d"))
    with pytest.raises(InputError, match="goes straight on"):
        layered_walls(Domain((loop,)), ["floor"])


def test_corners_too_tight_for_layers_are_refused_with_the_place():
    slot = polygon([[0, 0], [4, 0], [4, 0.004], [0, 0.004]], "floor outlet roof inlet")
    domain = Domain((slot,))
    with pytest.raises(InputError, match=r"leaves no room for layers") as caught:
        layered(domain, [], LayerSettings(FIRST), stretches=layered_walls(domain, ["floor"])[1], cells=1000)
    assert "floor" in str(caught.value)


def test_walls_shorter_than_layers_are_thick_still_get_exact_first_cells():
    star = [[11.77, 2.17], [11.28, 2.48], [11.47, 2.7], [11.55, 2.79], [11.54, 2.92], [11.63, 2.69]]
    star += [[11.99, 2.76], [11.99, 2.57]]
    box, hole = polygon([[9, 0], [14, 0], [14, 4], [9, 4]], "a b c d"), polygon(star, "star")
    domain = Domain((box, hole))
    loops, stretches = layered_walls(domain, ("star",))
    layout = layered(domain, loops, LayerSettings(1.7e-3), stretches=stretches, cells=2000)
    np.testing.assert_allclose(first_cells(layout, ["star"]), 1.7e-3, rtol=1e-6)
    assert smallest_jacobian(layout.mesh.nodes, layout.mesh.quads) > 0.0
