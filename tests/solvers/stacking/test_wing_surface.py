"""The surface of a wing: on its sections, closed but for the root, its cells convex and facing outwards."""

from dataclasses import replace

import numpy as np
import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.circle import Circle
from meshonet.geometry.surface.surface import surface_of
from meshonet.solvers.pipeline.stacks import stack_surface
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.stacking.section_nodes import around, unit_nodes
from meshonet.solvers.stacking.span_heights import span_heights
from meshonet.solvers.stacking.wing_surface import WingSurface, wing_surface

SETTINGS = WingSurface(around=81, span=17)


def stack(**values) -> Stack:
    root = Section(naca("2412"), 1.0, 0.0)
    middle = Section(naca("0012"), 0.8, 1.0, x=0.2)
    tip = Section(naca("0012-sharp"), 0.4, 2.5, x=0.8, y=0.1, twist=-3.0)
    return Stack((root, middle, tip), **values)


def scaled_jacobians(patch: np.ndarray) -> np.ndarray:
    """Sine of the angle at each corner of each cell."""
    u, v = np.diff(patch, axis=0), np.diff(patch, axis=1)
    corners = []
    for i in (slice(0, -1), slice(1, None)):
        for j in (slice(0, -1), slice(1, None)):
            a, b = u[:, j], v[i]
            area = np.linalg.norm(np.cross(a, b), axis=-1)
            corners.append(area / np.linalg.norm(a, axis=-1) / np.linalg.norm(b, axis=-1))
    return np.stack(corners)


def volume_of(patches) -> float:
    """What patches enclose, by Gauss's theorem over two triangles a cell; planes z = 0 add nothing."""
    total = 0.0
    for p in patches:
        a, b, c, d = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
        total += float((a * np.cross(b, c)).sum() + (a * np.cross(c, d)).sum()) / 6.0
    return total


def test_nodes_of_the_first_and_of_the_last_row_are_the_sections_own():
    wing = stack()
    main = wing_surface(wing, SETTINGS)[0].blocks[0].nodes
    plan = around(81)
    root = unit_nodes(wing.sections[0], plan)[0]
    assert main[:, 0, :2] == pytest.approx(root)
    assert (main[:, 0, 2] == 0.0).all()
    assert (main[:, -1, 2] == 2.5).all()
    curve = wing.sections[0].shape.curve
    lower, upper = curve.at(np.linspace(0.0, curve.length, 4000)), root[20:60]
    gap = np.abs(upper[:, None] - lower[None]).max(axis=-1).min(axis=1)
    assert gap.max() < 2.5e-3  # the surfaces are apart by the base of half a percent, and no more


@pytest.mark.parametrize("tip", ["round", "flat"])
def test_it_is_one_closed_surface_whose_normals_point_outwards(tip):
    grid, _ = wing_surface(stack(tip=tip), SETTINGS)
    surface = surface_of(grid)
    edges = surface.nodes[surface.open_edges]
    assert (edges[..., 2] == 0.0).all()  # open at the root alone
    assert len(surface.open_edges) == 80
    assert not [note for note in surface.notes if "turned" in note]
    area = 0.0822  # of NACA 0012, in squared chords
    volume = volume_of([block.nodes for block in grid.blocks])
    assert volume == pytest.approx(area * (0.8 * 1.0 + 0.37 * 1.5), rel=0.1)


def test_cells_of_a_round_tip_are_far_from_folded():
    grid, _ = wing_surface(stack(), SETTINGS)
    least = [scaled_jacobians(block.nodes).min() for block in grid.blocks]
    assert least[0] > 0.7
    assert least[1] > 0.3
    assert least[2] > 0.9


def test_a_round_tip_is_as_high_as_half_the_thickness_and_smooth_at_its_edge():
    grid, _ = wing_surface(stack(), SETTINGS)
    main, ring, core = (block.nodes for block in grid.blocks)
    half = 0.5 * 0.12 * 0.4
    assert core[..., 2].max() - 2.5 == pytest.approx(half, rel=0.06)
    before, behind = main[:, -1] - main[:, -2], ring[:, 1] - ring[:, 0]
    cosine = (before * behind).sum(-1) / np.linalg.norm(before, axis=-1) / np.linalg.norm(behind, axis=-1)
    assert np.degrees(np.arccos(np.median(cosine))) < 20.0  # 90 at a flat tip


def test_an_open_wing_has_one_patch_between_two_planes_of_symmetry():
    grid, _ = wing_surface(stack(tip="open"), SETTINGS)
    assert len(grid.blocks) == 1
    assert [(patch.name, patch.side) for patch in grid.patches] == [
        ("symmetry", "south"),
        ("symmetry", "north"),
    ]


def test_thin_trailing_edges_are_opened_with_a_note_and_blunt_ones_stay():
    _, notes = wing_surface(stack(), SETTINGS)
    assert len(notes) == 3
    assert "NACA 2412 is changed: its trailing edge, 0.0025 chords high" in notes[0]
    _, none = wing_surface(stack(), WingSurface(81, 17, base=1e-9 + 0.0015))
    assert len(none) == 1  # the sharp one


def test_a_circle_and_an_airfoil_make_a_blade_root():
    wing = Stack((Section(Circle(0.5), 0.5, 0.0), Section(naca("0012"), 1.0, 2.0)))
    grid, _ = wing_surface(wing, SETTINGS)
    radius = np.hypot(grid.blocks[0].nodes[:, 0, 0] - 0.25, grid.blocks[0].nodes[:, 0, 1])
    assert radius == pytest.approx(np.full(81, 0.25), rel=1e-6)


def test_heights_meet_all_sections_and_shrink_to_the_tip():
    z = span_heights(np.array([1.0, 2.0, 5.0]), 33, 0.01)
    assert {1.0, 2.0, 5.0} <= set(z.tolist())
    assert (np.diff(z) > 0).all()
    assert z[-1] - z[-2] == pytest.approx(0.01, rel=0.1)
    even = span_heights(np.array([0.0, 1.0]), 11, None)
    assert even == pytest.approx(np.linspace(0.0, 1.0, 11))


def test_panels_have_the_cells_given_to_them_and_the_others_share_the_rest():
    sections = np.array([0.0, 5.0, 11.0, 11.5, 12.4])
    z = span_heights(sections, 81, 1e-3, (24, 20, None, None))
    at = np.searchsorted(z, sections)
    assert z[at].tolist() == sections.tolist()
    assert np.diff(at)[:2].tolist() == [24, 20]
    assert len(z) == 81
    steps = np.diff(z)
    assert (steps > 0).all()
    assert steps[-1] == pytest.approx(1e-3, rel=1e-6)
    assert max((steps[1:] / steps[:-1]).max(), (steps[:-1] / steps[1:]).max()) < 1.5


def test_nodes_of_all_panels_are_the_nodes_along_the_span():
    sections = tuple(replace(each, nodes=n) for each, n in zip(stack().sections, (None, 9, 9), strict=True))
    grid, _ = stack_surface(Stack(sections), StackRequest(around=81))
    assert grid.blocks[0].counts[1] == 17
    with pytest.raises(InputError, match="the panels have 17 nodes along the span; leave span out"):
        stack_surface(Stack(sections), StackRequest(around=81, span=21))


def test_a_panel_may_have_one_cell():
    z = span_heights(np.array([0.0, 1.0, 1.2, 2.0]), 12, None, (None, 1, 3))
    assert len(z) == 12
    assert np.searchsorted(z, [1.0, 1.2, 2.0]).tolist() == [7, 8, 11]
    assert (np.diff(z) > 0).all()


def test_more_nodes_of_panels_than_along_the_span_are_refused():
    with pytest.raises(InputError, match="21 nodes along the span, and panels with 31 of them"):
        span_heights(np.array([0.0, 1.0, 2.0]), 21, None, (30, None))


@pytest.mark.parametrize(
    ("settings", "problem"),
    [
        ({"around": 80}, "80 nodes around a section"),
        ({"around": 11}, "11 nodes around a section"),
        ({"span": 3}, "3 nodes"),
        ({"base": 0.3}, "a base of 0.3 chords"),
    ],
)
def test_counts_that_do_not_suffice_are_refused(settings, problem):
    with pytest.raises(InputError) as refusal:
        wing_surface(stack(), WingSurface(**settings))
    assert problem in str(refusal.value)


@pytest.mark.parametrize("name", ["3311", "0009", "4418"])
def test_the_core_of_a_tip_stands_where_cells_at_its_corners_are_best(name):
    section = Section(naca(name), 1.0, 0.0)
    grid, _ = wing_surface(Stack((section, Section(naca(name), 0.3, 2.0))))
    assert min(scaled_jacobians(block.nodes).min() for block in grid.blocks[1:]) > 0.5
