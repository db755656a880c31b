"""Blades and ducts: their walls are those of the sections, their ends planes, their volumes by formula."""

import numpy as np
import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.circle import Circle
from meshonet.geometry.shapes.outline import Outline
from meshonet.solvers.pipeline.lofts import blade_volume, duct_volume
from meshonet.solvers.pipeline.stacks import make_stack
from meshonet.solvers.stacking.axis_heights import axis_heights
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.stacking.section_nodes import around, unit_nodes

BOX = Outline(np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]), "box")


def blade(twist: float = -30.0) -> Stack:
    root = Section(naca("2412"), 1.0, 0.0)
    return Stack((root, Section(naca("0009"), 0.5, 2.0, x=0.1, twist=twist)), kind="blade")


def thick_flatback() -> Airfoil:
    """A section 45 % thick with a base of 23 % of the chord."""
    x = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 81)))
    half = 2.25 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    half += 0.115 * x**3
    return Airfoil(np.concatenate([np.stack([x, half], axis=1)[::-1], np.stack([x, -half], axis=1)[1:]]))


def duct(*shapes, chords=(1.0, 2.0)) -> Stack:
    placed = [
        Section(shape, chord, 3.0 * k) for k, (shape, chord) in enumerate(zip(shapes, chords, strict=True))
    ]
    return Stack(tuple(placed), kind="duct")


def volume(grid) -> float:
    """What the walls and ends enclose, by Gauss's theorem over triangles."""
    total = 0.0
    for block in grid.blocks:
        x = block.nodes
        for side, sign in (
            (x[0], -1),
            (x[-1], 1),
            (x[:, 0], 1),
            (x[:, -1], -1),
            (x[..., 0, :], -1),
            (x[..., -1, :], 1),
        ):
            a, b, c, d = side[:-1, :-1], side[1:, :-1], side[1:, 1:], side[:-1, 1:]
            total += sign * float((a * np.cross(b, c)).sum() + (a * np.cross(c, d)).sum()) / 6.0
    return total


@pytest.mark.parametrize("twist", [-30.0, 90.0])
def test_a_blade_has_its_sections_walls_and_a_far_field_that_is_a_cylinder(twist):
    stack, request = blade(twist), StackRequest(around=65, span=9, far_field=10.0)
    grid, _ = blade_volume(stack, request)
    assert measure(grid).folded == 0
    (block,) = grid.blocks
    plan = around(65)
    root = unit_nodes(stack.sections[0], plan)[0][::-1]
    assert block.nodes[:, 0, 0, :2] == pytest.approx(root)
    far = block.nodes[:, -1, :, :2]
    shift = np.linspace(0.0, 0.1, 9)[:, None] * np.array([1.0, 0.0])  # x of the leading edge
    assert np.abs(far - shift - far[:, :1]).max() < 0.7  # of a radius of 10, at half the chord
    assert {(p.name, p.kind, p.side) for p in grid.patches} == {
        ("blade", "wall", "south"), ("farfield", "farfield", "north"),
        ("hub", "wall", "bottom"), ("shroud", "wall", "top"),
    }  # fmt: skip


def test_lines_between_unlike_sections_of_a_blade_do_not_lean_in_the_far_field():
    flatback = Section(thick_flatback(), 0.7, 1.6, x=0.1)
    stack = Stack((Section(naca("0009"), 1.0, 0.0), flatback), kind="blade")
    grid, _ = blade_volume(stack, StackRequest(around=129, first_cell=1e-5))
    nodes = grid.blocks[0].nodes
    far = nodes[:, -1]
    lean = np.linalg.norm(far[:, -1, :2] - far[:, 0, :2], axis=-1)
    assert lean.max() < 1e-2 * 15.0
    assert measure(grid)["scaled_jacobian"].min > 0.45


def test_first_cells_of_a_blade_are_as_high_as_asked_at_its_sections():
    grid, _ = blade_volume(blade(), StackRequest(around=65, span=9, first_cell=1e-4))
    nodes = grid.blocks[0].nodes
    first = np.linalg.norm(nodes[:, 1] - nodes[:, 0], axis=-1)
    assert first[:, [0, -1]] == pytest.approx(1e-4, rel=1e-4)
    assert first == pytest.approx(1e-4, rel=0.3)


def test_a_cone_has_the_volume_of_one():
    grid, _ = duct_volume(duct(Circle(1.0), Circle(3.0)), StackRequest(around=129, span=17))
    assert len(grid.blocks) == 5
    assert measure(grid).folded == 0
    r, s = 0.5, 1.0
    assert volume(grid) == pytest.approx(np.pi * 3.0 / 3.0 * (r * r + r * s + s * s), rel=2e-3)


def test_boxes_are_one_block_with_walls_all_around():
    grid, _ = duct_volume(duct(BOX, BOX), StackRequest(around=65, span=9, first_cell=0.002))
    assert len(grid.blocks) == 1
    a, b = 0.5, 2.0  # areas of the ends: half the chord squared
    assert volume(grid) == pytest.approx(3.0 / 3.0 * (a + np.sqrt(a * b) + b), rel=1e-9)
    nodes = grid.blocks[0].nodes
    for first in (nodes[1] - nodes[0], nodes[:, 1] - nodes[:, 0]):
        assert np.linalg.norm(first, axis=-1)[:, [0, -1]] == pytest.approx(0.002, rel=1e-3)
    assert {(p.name, p.kind) for p in grid.patches} == {
        ("wall", "wall"), ("inlet", "inlet"), ("outlet", "outlet"),
    }  # fmt: skip


def test_a_box_becomes_a_circle_in_five_blocks():
    grid, _ = duct_volume(duct(BOX, Circle(0.5), chords=(1.0, 1.0)), StackRequest(around=65, span=17))
    assert len(grid.blocks) == 5
    assert measure(grid).folded == 0
    corners = {tuple(np.round(block.nodes[0, 0, 0], 9)) for block in grid.blocks[1:]}
    assert corners == {(0.0, -0.25, 0.0), (1.0, -0.25, 0.0), (1.0, 0.25, 0.0), (0.0, 0.25, 0.0)}


@pytest.mark.parametrize(
    ("stack", "request_", "problem"),
    [
        (duct(naca("0012"), Circle(1.0)), StackRequest(), "sections[0]: an airfoil is no section of a duct"),
        (duct(Circle(1.0), Circle(1.0)), StackRequest(around=67), "67 nodes around the four sides of a duct"),
    ],
)
def test_what_is_no_duct_is_refused(stack, request_, problem):
    with pytest.raises(InputError) as refusal:
        duct_volume(stack, request_)
    assert problem in str(refusal.value)


def test_first_cells_of_a_duct_are_in_the_unit_of_its_file_and_reported():
    pipe = duct(Circle(0.5), Circle(0.5), chords=(20.0, 20.0))
    made = make_stack(pipe, StackRequest(around=65, span=9, first_cell=0.1))
    wall = made.grid.blocks[1].nodes
    assert np.linalg.norm(wall[:, 1] - wall[:, 0], axis=-1) == pytest.approx(0.1, rel=1e-9)
    assert any(note.startswith("wall: first cells 0.1, growth up to 1.") for note in made.notes)


def test_first_cells_that_nearly_fill_a_duct_are_refused():
    with pytest.raises(InputError, match=r"0\.5 high in a section that is 2 wide; use at most"):
        duct_volume(duct(Circle(0.5), Circle(0.5), chords=(2.0, 3.0)), StackRequest(first_cell=0.5))


UNEVEN = np.array([0.0, 0.5, 1.0, 1.5, *1.5 + 2.0 / 30.0 * np.arange(1, 31), 4.0, 4.5, 5.0, 5.5])


@pytest.mark.parametrize(("nodes", "most"), [(None, 1.2), (65, 1.25)])
def test_cells_along_a_duct_change_gradually_where_sections_are_unevenly_spaced(nodes, most):
    z, notes = axis_heights(UNEVEN, nodes, (None,) * (len(UNEVEN) - 1))
    assert set(UNEVEN.tolist()) <= set(z.tolist())
    assert nodes is None or len(z) == nodes
    steps = np.diff(z)
    assert np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:]).max() < most
    assert len(notes) == 1


def test_sections_that_leave_no_gradual_cells_are_told_with_the_place():
    z, (note,) = axis_heights(np.array([0.0, 1.0, 1.02, 3.0]), 13, (None,) * 3)
    assert len(z) == 13
    assert "differ by a factor of" in note
    assert "at z=1" in note
    assert "space them evenly, or give more nodes by {span}" in note
