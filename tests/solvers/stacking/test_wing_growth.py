"""Cells of wings: growth along lines from the wall and across the sides of blocks, and spacings."""

import math

import numpy as np
import pytest

from meshonet.geometry.blocks.across import across
from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.quality.growth import ratios
from meshonet.geometry.quality.report import quality_report
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.circle import Circle
from meshonet.solvers.pipeline.stacks import make_stack
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.stacking.wing_surface import WingSurface, wing_surface


def wing(**values) -> Stack:
    tip = Section(naca("0012"), 0.5, 2.5, x=0.8, y=0.1, twist=-3.0)
    return Stack((Section(naca("2412"), 1.0, 0.0), tip), **values)


@pytest.fixture(scope="module")
def made():
    return make_stack(wing(), StackRequest(around=97, span=33))


def test_growth_is_a_limit_along_lines_from_the_wall(made):
    for block in made.grid.blocks:
        assert ratios(np.moveaxis(block.nodes, 2, 0)).max() <= 1.2


def test_cells_across_the_sides_of_blocks_are_alike_and_at_the_edge_of_the_tip_not_far_from_it(made):
    for each in made.grid.connections:
        own, donor = across(made.grid, each, 2)
        growth = ratios(np.stack([own[1], own[0], donor[1]]))[0][1:-1].max()
        assert growth <= (3.0 if {each.block, each.donor} == {0, 1} else 1.2)


def thin() -> Stack:
    """Return a swept wing with thin sections."""
    return Stack((Section(naca("0006"), 1.0, 0.0), Section(naca("0005"), 0.4, 1.2, x=0.9)))


def test_cells_turn_by_20_degrees_at_most_around_the_noses_of_a_thin_wing():
    main = wing_surface(thin())[0].blocks[0].nodes
    for section in (main[:, 0, :2], main[:, -1, :2]):
        assert np.degrees(np.abs(turning(section[60:69]))).max() <= 20.0


def test_the_report_says_which_spacing_a_nose_needs_that_is_a_wedge():
    stack = Stack(thin().sections, le_spacing=0.01)
    (note,) = (each for each in wing_surface(stack)[1] if "nose of NACA 0005" in each)
    assert note.startswith("neighbouring cells at the nose of NACA 0005 turn by up to ")
    helps = float(note.split("le_spacing = ")[1].split()[0])
    mended = Stack(thin().sections, le_spacing=helps)
    assert not any("nose" in note for note in wing_surface(mended)[1])
    assert not any("nose" in note for note in wing_surface(thin())[1])


def test_cells_on_the_tip_of_a_thin_wing_grow_by_a_factor_of_2_5_at_most():
    grid = wing_surface(thin())[0]
    for block in grid.blocks[1:]:
        assert max(ratios(block.nodes).max(), ratios(block.nodes.swapaxes(0, 1)).max()) <= 2.5


def winglet(cant=0.0, **values) -> Stack:
    """Return a wing whose dihedral increases to 70 degrees over its last panels."""
    chords, heights = (1.5, 1.35, 1.15, 0.9, 0.6), (11.0, 11.5, 11.9, 12.2, 12.4)
    angles = zip((25, 30, 35, 40, 55), (5, 15, 35, 55, 70), strict=True)
    sections, x, y, z = [Section(naca("2412"), 4.0, 0.0)], 0.0, 0.0, 0.0
    for chord, height, (sweep, dihedral) in zip(chords, heights, angles, strict=True):
        x += (height - z) * math.tan(math.radians(sweep))
        y, z = y + (height - z) * math.tan(math.radians(dihedral)), height
        sections.append(Section(naca("2410"), chord, z, x, y, twist=-2.0, cant=cant))
    return Stack(tuple(sections), **values)


@pytest.mark.parametrize(
    "stack", [winglet(), winglet("panel"), winglet(between="smooth"), winglet("panel", between="smooth")]
)
def test_cells_at_the_edge_of_the_tip_of_a_winglet_differ_by_3_at_most(stack):
    grid = make_stack(stack, StackRequest(around=49, span=21)).grid
    (edge,) = (each for each in grid.connections if (each.block, each.donor) == (0, 1))
    own, donor = across(grid, edge, 2)
    assert ratios(np.stack([own[1], own[0], donor[1]])).max() <= 3.0


@pytest.mark.parametrize(("cant", "least"), [(0.0, 0.0), ("panel", 0.35)])
def test_a_winglet_with_a_prescribed_cell_at_its_tip_has_no_folded_cells(cant, least):
    made = make_stack(winglet(cant, tip_spacing=0.02), StackRequest(around=97, span=41))
    assert made.quality.folded == 0
    assert made.quality["scaled_jacobian"].min > least


def test_folded_cells_at_a_sharp_bend_are_refused_with_what_helps_there():
    middle, tip = Section(naca("2412"), 0.5, 3.0, x=0.8), Section(naca("0012"), 0.3, 3.07, x=1.0, y=0.8)
    stack = Stack((Section(naca("2412"), 1.0, 0.0), middle, tip))
    with pytest.raises(NoValidGridError) as refusal:
        make_stack(stack, StackRequest(around=81, span=33))
    *_, remedy, worst = str(refusal.value).split("; ")
    assert " cells are folded" in str(refusal.value)
    where = "at z=3, where the dihedral changes by 85 degrees"
    assert remedy == f'give more sections {where}, with cant = "panel"'
    assert worst.count("block=") == 3


def test_first_cells_that_no_march_gets_beyond_are_refused_with_what_helps():
    with pytest.raises(NoValidGridError, match=r"stops after 0 of .*; use a smaller first_cell$"):
        make_stack(wing(tip="open"), StackRequest(around=49, span=13, first_cell=0.1))


def test_sections_that_are_turned_through_each_other_are_refused():
    middle, tip = Section(naca("0024"), 1.0, 2.0), Section(naca("0024"), 1.0, 2.05, cant=60.0)
    with pytest.raises(InputError, match=r"at z=2 and 2\.05 cross, at 60 degrees; turn them less"):
        wing_surface(Stack((Section(naca("0024"), 1.0, 0.0), middle, tip)))


def test_the_report_says_first_cells_and_growth_at_wing_and_tip(made):
    notes = [note for note in made.notes if "first cells" in note]
    assert notes[0].startswith("wing: first cells 0.001, growth up to 1.")
    assert notes[1].startswith("tip: first cells 0.001, growth up to 1.")
    (beyond,) = (note for note in made.notes if note.startswith("the largest growth ratio is"))
    (edge,) = (each for each in made.grid.connections if (each.block, each.donor) == (0, 1))
    own, donor = across(made.grid, edge, 2)
    most = ratios(np.stack([own[1], own[0], donor[1]])).max()
    assert beyond.startswith(f"the largest growth ratio is {most:.3f}, along eta at block=0, i=")
    assert beyond.endswith("above the limit of 1.2; along grid lines from walls it is 1.200")


def test_the_far_field_is_measured_in_chords(made):
    figure = quality_report(made.grid, "viscous").figures("far_field")
    assert figure is not None
    assert figure.value == pytest.approx(15.0, rel=0.05)


def test_first_cells_are_exact(made):
    for block in made.grid.blocks:
        first = np.linalg.norm(block.nodes[:, :, 1] - block.nodes[:, :, 0], axis=-1)
        assert first == pytest.approx(np.full(first.shape, 1e-3), rel=1e-9)


def test_spacings_at_tip_and_edges_are_those_asked_for():
    stack = wing(tip_spacing=0.004, le_spacing=0.003, te_spacing=0.002)
    grid, _ = wing_surface(stack, WingSurface(around=129, span=33))
    main = grid.blocks[0].nodes
    assert np.diff(main[0, :, 2])[-1] == pytest.approx(0.002, rel=1e-5)
    steps = np.linalg.norm(np.diff(main[:, 0], axis=0), axis=-1)
    assert steps[[4, -5]] == pytest.approx([0.002, 0.002], rel=0.01)
    assert steps[[63, 64]] == pytest.approx([0.003, 0.003], rel=0.01)
    steps = np.linalg.norm(np.diff(main[:, -1], axis=0), axis=-1)
    assert steps[[4, -5]] == pytest.approx([0.001, 0.001], rel=0.01)


@pytest.mark.parametrize(
    ("make", "problem"),
    [
        (lambda: wing(tip_spacing=0.0), "0 chords; use more than 0"),
        (lambda: wing(le_spacing=float("nan")), "nan chords"),
        (lambda: wing(kind="blade", tip_spacing=0.1), "a blade has no such edge"),
        (lambda: wing(kind="duct", te_spacing=0.1), "a duct has no such edge"),
        (
            lambda: wing_surface(
                Stack((Section(Circle(0.5), 1.0, 0.0), Section(Circle(0.5), 1.0, 2.0)), le_spacing=0.01)
            ),
            "has neither leading nor trailing edge",
        ),
    ],
)
def test_spacings_that_are_of_no_use_are_refused(make, problem):
    with pytest.raises(InputError) as refusal:
        make()
    assert problem in str(refusal.value)


def test_cells_at_the_tip_of_a_swept_wing_are_as_long_along_their_lines_as_they_may():
    tip = Section(naca("2412"), 0.4, 2.0, x=2.4, y=0.4)
    grid, _ = wing_surface(Stack((Section(naca("2412"), 1.0, 0.0), tip)))
    main, ring = grid.blocks[0].nodes, grid.blocks[1].nodes
    below, above = main[:, -1] - main[:, -2], ring[:, 1] - ring[:, 0]
    ratio = np.linalg.norm(below, axis=-1) / np.linalg.norm(above, axis=-1)
    assert np.maximum(ratio, 1.0 / ratio).max() <= 2.55


def test_cells_far_behind_a_swept_wing_are_not_sheared_at_the_plane_of_symmetry():
    tip = Section(naca("2412"), 0.8, 1.8, x=1.3, y=0.3)
    made = make_stack(Stack((Section(naca("2412"), 1.0, 0.0), tip)), StackRequest(around=97, span=33))
    assert made.quality["scaled_jacobian"].min > 0.35


def test_a_wing_whose_layers_change_with_its_nodes_has_about_the_cells_asked_for() -> None:
    places = ((1.0, 0.0, 0.0), (0.93675, 1.4, 0.01581), (0.75993, 2.6, 0.06002), (0.47497, 3.52, 0.13126),
              (0.14107, 3.96, 0.21473))  # fmt: skip
    sections = [
        Section(naca(name), chord, z, x=x)
        for name, (chord, z, x) in zip(("2415", "2414", "2412", "2410", "2408"), places, strict=True)
    ]
    grid = make_stack(Stack(tuple(sections), between="smooth"), StackRequest(cells=150_000)).grid
    made = sum(math.prod(n - 1 for n in block.counts) for block in grid.blocks)
    assert made == pytest.approx(150_000, rel=0.1)
