"""Grids around a body with a wing: matched blocks, exact first cells, nodes on both surfaces."""

from dataclasses import replace

import numpy as np
import pytest
from aircraft_shapes import aircraft, body, unclaimed_faces, wall

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids, measure_volumes
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.request import AircraftRequest

FIRST = 1e-3
SMALL = AircraftRequest(around=65, span=9, first_cell=FIRST, far_field=8.0)
COARSE = AircraftRequest(around=49, span=9, first_cell=2e-3, growth=1.3, far_field=8.0)
"""What shows that a shape is made or refused."""


@pytest.fixture(scope="module")
def grid() -> Grid:
    return aircraft_grid(aircraft(y=-0.1), SMALL)[0]


def test_no_cell_is_folded(grid: Grid) -> None:
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks) == 0
    assert measure_volumes(grid)["scaled_jacobian"].min > 0.1


@pytest.mark.parametrize("name", ["fuselage", "wing", "tip"])
def test_first_cells_are_exact_on_every_wall(grid: Grid, name: str) -> None:
    for nodes, beside in wall(grid, name):
        assert np.linalg.norm(beside - nodes, axis=-1) == pytest.approx(FIRST * 2.0, rel=1e-9)


def test_layers_of_the_tip_do_not_go_around_the_aircraft(grid: Grid) -> None:
    _, level = next(patch.across for patch in grid.patches if patch.name == "wing" and patch.across)
    steps = [np.diff(block.nodes[:, :, level : level + 2], axis=2)[:, :, 0] for block in grid.blocks[1:7]]
    far = np.concatenate([np.linalg.norm(each, axis=-1).ravel() for each in steps])
    assert np.median(far) > 3.0 * FIRST * 2.0


def test_nodes_lie_on_body_and_wing(grid: Grid) -> None:
    for nodes, _ in wall(grid, "fuselage"):
        assert np.abs(body().outside(nodes.reshape(-1, 3))).max() < 1e-9
    for nodes, _ in wall(grid, "tip"):
        assert nodes[..., 2] == pytest.approx(5.0, abs=1e-9)
    (on_wing, _), *_ = wall(grid, "wing")
    ends = on_wing[:, [0, -1]]
    part = (on_wing[..., 2] - ends[:, :1, 2]) / (ends[:, 1:, 2] - ends[:, :1, 2])
    straight = ends[:, :1] + part[..., None] * (ends[:, 1:] - ends[:, :1])
    assert np.abs(on_wing - straight).max() < 1e-9


def test_every_face_is_in_a_patch_or_joined_to_another_by_equal_nodes(grid: Grid) -> None:
    assert unclaimed_faces(grid) == 0


def test_the_plane_of_symmetry_is_flat(grid: Grid) -> None:
    flat = [p for p in grid.patches if p.name == "symmetry"]
    assert flat
    for patch in flat:
        assert not face_of(grid.blocks[patch.block].nodes[..., 2], patch.side).any()
    assert min(float(block.nodes[..., 2].min()) for block in grid.blocks) == 0.0


def test_the_far_field_is_as_far_as_it_should_be(grid: Grid) -> None:
    for patch in grid.patches:
        if patch.name == "farfield":
            away = np.linalg.norm(grid.blocks[patch.block].nodes[:, :, -1] - [5.0, 0.1, 0.0], axis=-1)
            assert away == pytest.approx(16.0 + 5.0, rel=0.05)


@pytest.mark.parametrize(
    ("y", "sweep", "section"), [(0.35, 0.0, "0012"), (-0.15, 3.0, "4418"), (0.1, -1.0, "2412")]
)
def test_wings_high_low_and_swept_are_made(y: float, sweep: float, section: str) -> None:
    made, *_ = aircraft_grid(aircraft(y, sweep, section), COARSE)
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in made.blocks) == 0


@pytest.mark.parametrize(
    ("z", "span", "words"), [(0.7, 5.0, "begins outside of"), (0.0, 0.4, "does not leave")]
)
def test_a_wing_that_does_not_pierce_the_body_is_refused(z: float, span: float, words: str) -> None:
    wing = Stack((Section(naca("2415"), 2.0, z, x=3.4), Section(naca("2415"), 1.0, z + span, x=3.4)))
    with pytest.raises(InputError, match=words) as error:
        aircraft_grid(Aircraft(body(), wing), SMALL)
    assert "x=" in str(error.value)


def test_a_wing_that_meets_the_body_at_a_sharp_angle_is_refused_with_place_and_angle() -> None:
    """Its upper side is 0.592 above the axis of a body of radius 0.6: arccos(0.592 / 0.6) is 9 degrees.

    The node beside it, which is the one that is named, is up to a degree off.
    """
    near = aircraft(0.5, 1.0)
    with pytest.raises(InputError, match=r"wing meets the fuselage at (9|10) degrees, at x=.*, y=0\.69"):
        aircraft_grid(near, COARSE)
    folded, *_ = aircraft_grid(near, replace(COARSE, allow_invalid=True))
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in folded.blocks) > 0


def test_a_wing_whose_edge_is_swept_too_much_is_refused_with_place_and_angle() -> None:
    """The trailing edge is swept by arctan(1.4), 54 degrees, and meets the cylinder at the remaining 36."""
    with pytest.raises(
        InputError, match=r"wing meets the fuselage at 36 degrees, at x=.*, y=0\.1.*; sweep it"
    ):
        aircraft_grid(aircraft(0.1, 8.0), replace(SMALL, far_field=40.0))


def test_a_low_edge_far_from_the_middle_of_its_collar_is_made_with_many_nodes_too() -> None:
    """Lines behind the edge would cross each other if they went to the middle of the collar's side."""
    root = Section(naca("2409"), 3.4, 0.0, x=3.2, y=-0.15, twist=6.0)
    wing = Stack((root, Section(naca("2409"), 1.2, 5.0, x=5.4, y=0.0)), tip="flat")
    made, *_ = aircraft_grid(Aircraft(body(), wing), replace(SMALL, around=129, growth=1.3))
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in made.blocks) == 0


def test_places_around_a_body_are_those_of_the_points_there() -> None:
    space = BodyMap(body(), 40.0)
    draw = np.random.default_rng(0)
    places = np.stack([draw.uniform(0.5, 9.5, 99), draw.uniform(0.1, 3.0, 99), draw.uniform(0, 0.9, 99)], -1)
    assert space.places(space.points(places)) == pytest.approx(places, abs=1e-9)
    on_body = space.points(places * [1.0, 1.0, 0.0])
    assert np.abs(body().outside(on_body)).max() < 1e-9
    beside = space.points(places * [1.0, 1.0, 0.0] + [0.0, 0.0, 1e-5]) - on_body
    along = space.points(places * [1.0, 1.0, 0.0] + [1e-5, 0.0, 0.0]) - on_body
    cosine = (beside * along).sum(axis=1) / np.linalg.norm(beside, axis=1) / np.linalg.norm(along, axis=1)
    assert np.abs(cosine[(places[:, 0] > 1) & (places[:, 0] < 9)]).max() < 0.02, "a right angle at the body"


@pytest.mark.parametrize("points", [9, 41])
def test_places_on_a_blunt_nose_are_even_for_few_points_of_a_meridian_too(points: int) -> None:
    x = np.linspace(-1.0, 1.0, points)
    space = BodyMap(Body(np.stack([5.0 * x, 0.6 * np.sqrt(1.0 - x * x)], axis=1)), 20.0)
    s = np.linspace(0.0, 0.02 * space.body.length, 9)
    steps = np.linalg.norm(np.diff(space.meridional(s, np.zeros(9)), axis=0), axis=1)
    assert steps[1:] / steps[:-1] == pytest.approx(1.0, abs=0.12)


@pytest.mark.parametrize("name", ["fuselage", "wing"])
def test_lines_leave_the_walls_at_right_angles_away_from_the_junction(grid: Grid, name: str) -> None:
    """The wing lies low on the body and is swept: lines along it are 20 degrees and more off the normal."""
    angles = []
    for nodes, beside in wall(grid, name):
        i, j = (np.gradient(nodes, axis=axis) for axis in (0, 1))
        cosine = (np.cross(i, j) * (beside - nodes)).sum(axis=-1)
        cosine /= np.linalg.norm(np.cross(i, j), axis=-1) * np.linalg.norm(beside - nodes, axis=-1)
        inner = np.degrees(np.arccos(np.clip(np.abs(cosine), -1.0, 1.0)))[2:-2, 2:-2]
        angles.append(inner.ravel())
    assert np.percentile(np.concatenate(angles), 90) < 15.0


@pytest.mark.parametrize("nose", ["round", "pointed"])
def test_lines_leave_bodies_that_end_in_points_at_right_angles(nose: str) -> None:
    t = np.linspace(0.0, 1.0, 61) ** 2
    point = t * (2.0 - t)
    x = np.append(2.0 * t, 15.0 - 9.0 * t[::-1])
    radius = 0.6 * np.append(np.sqrt(point) if nose == "round" else point, point[::-1])
    space = BodyMap(Body(np.stack([x, radius], axis=1)), 40.0)
    s = np.linspace(0.02, 0.98, 97) * space.body.length
    across = space.meridional(s, np.full(97, 1e-5)) - space.meridional(s, np.zeros(97))
    along = space.meridional(s + 1e-5, np.zeros(97)) - space.meridional(s - 1e-5, np.zeros(97))
    cosine = (across * along).sum(axis=1) / np.linalg.norm(across, axis=1) / np.linalg.norm(along, axis=1)
    off = np.degrees(np.arcsin(np.abs(cosine)))
    assert np.median(off) < 0.1
    assert np.percentile(off, 95) < 1.0


def test_cells_grow_little_along_lines(grid: Grid) -> None:
    ratios = []
    for block in grid.blocks[:7]:
        for axis in (0, 1):
            steps = np.moveaxis(np.linalg.norm(np.diff(block.nodes, axis=axis), axis=-1), axis, 0)
            ratios.append((steps[1:] / steps[:-1]).ravel())
    growth = np.concatenate(ratios)
    assert (np.maximum(growth, 1.0 / growth) <= 1.3).mean() > 0.97


def cells_of(grid: Grid) -> int:
    return sum(int(np.prod([count - 1 for count in block.counts])) for block in grid.blocks)


def test_there_are_about_as_many_cells_as_wanted() -> None:
    request = AircraftRequest.of(cells=200_000, span=9, first_cell=1e-2, growth=1.4, far_field=8.0)
    assert cells_of(aircraft_grid(aircraft(), request)[0]) == pytest.approx(200_000, rel=0.1)


def test_cells_grow_more_where_there_would_be_too_many_of_them() -> None:
    """By 1.25 at most, which the note names; around the wing they grow by no more than 1.3, too."""
    made, _, notes = aircraft_grid(
        aircraft(), AircraftRequest.of(cells=500_000, first_cell=2e-4, far_field=8.0)
    )
    assert any("cells grow by 1.25 in place of 1.2" in note for note in notes)
    assert cells_of(made) < 600_000
    growth = np.concatenate(
        [ratios(np.asarray(block.nodes), axis).ravel() for block in made.blocks for axis in range(3)]
    )
    assert (growth <= 1.3).mean() > 0.99


def test_a_growth_that_is_given_is_kept() -> None:
    request = AircraftRequest.of(cells=20_000, span=9, first_cell=1e-2, far_field=8.0, growth=1.2)
    _, growth, notes = aircraft_grid(aircraft(), request)
    assert growth == 1.2
    assert not any("in place of" in note for note in notes)


def test_layers_that_need_more_cells_are_named_in_a_note_with_the_number_that_is_made() -> None:
    """The sections beyond the tips of wings count, too: they are a tenth of all cells."""
    made, _, notes = aircraft_grid(aircraft(), AircraftRequest.of(cells=20_000, span=9, first_cell=1e-2))
    note = next(note for note in notes if "layers need about" in note)
    assert int(note.split()[3]) == pytest.approx(cells_of(made), rel=0.02)


@pytest.mark.parametrize(
    ("options", "words"),
    [({"cells": 1}, "1 cells"), ({"cells": 500_000, "around": 65}, "both"), ({"layers": 9}, "has no")],
)
def test_options_that_do_not_fit_are_refused(options: dict[str, int], words: str) -> None:
    with pytest.raises(InputError, match=words):
        AircraftRequest.of(**options)


def test_first_cells_at_the_junction_have_their_height_from_both_walls(grid: Grid) -> None:
    collar = np.asarray(grid.blocks[0].nodes)
    for wall_node in (collar[:, 0, 1], collar[:, 1, 0]):
        assert np.linalg.norm(collar[:, 1, 1] - wall_node, axis=-1) == pytest.approx(2e-3, rel=1e-11)


def test_rows_beside_a_wing_are_even(grid: Grid) -> None:
    """Cells along rows of the collar differ by at most 1.3, but for few: corners leave no kinks in them."""
    steps = np.linalg.norm(np.diff(np.asarray(grid.blocks[0].nodes), axis=0), axis=-1)
    ratios = steps[1:] / steps[:-1]
    assert (np.maximum(ratios, 1.0 / ratios) <= 1.3).mean() > 0.98


def test_cells_go_on_across_the_edge_of_the_tip(grid: Grid) -> None:
    tip = grid.blocks[0].nodes.shape[2] - grid.blocks[7].nodes.shape[2]
    collar, ring = np.asarray(grid.blocks[0].nodes)[:, :, tip], np.asarray(grid.blocks[7].nodes)[:, :, 0]
    outside, inside = (np.linalg.norm(each[:, 1] - each[:, 0], axis=-1) for each in (collar, ring))
    assert outside.mean() / inside.mean() == pytest.approx(1.0, abs=0.1)


def ratios(nodes: Floats, axis: int) -> Floats:
    """Of neighbouring cells along lines, at least 1."""
    steps = np.moveaxis(np.linalg.norm(np.diff(nodes, axis=axis), axis=-1), axis, 0)
    return np.asarray(np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:]))


def test_no_line_in_the_cores_at_nose_and_tail_has_a_kink(grid: Grid) -> None:
    for core in (grid.blocks[4], grid.blocks[6]):
        assert max(float(ratios(np.asarray(core.nodes)[:, :, 0], axis).max()) for axis in (0, 1)) < 1.3


def test_rows_inside_a_tip_grow_evenly_where_it_is_thin_too(grid: Grid) -> None:
    ring = np.asarray(grid.blocks[7].nodes)[:, :, 0]
    assert ratios(ring, 1).max() < 1.4
    assert (ratios(ring, 1) <= 1.3).mean() > 0.95


def test_a_drooped_wing_with_a_thin_edge_is_made() -> None:
    root = Section(naca("2409"), 3.0, 0.0, x=3.2, y=-0.15, twist=6.0)
    wing = (root, Section(naca("2409"), 1.0, 5.0, x=5.0))
    request = AircraftRequest(around=97, span=9, first_cell=FIRST, far_field=8.0, base=0.002)
    made, *_ = aircraft_grid(Aircraft(body(), Stack(wing, tip="flat")), request)
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in made.blocks) == 0


def test_a_tail_that_ends_in_a_cone_has_growing_rows() -> None:
    """Beside a point of the body distances from it are no smooth function of the levels of the map."""
    half = np.array([[0, 0], [0.1, 0.3], [1, 0.6], [6, 0.6], [9, 0.4], [10.5, 0.1], [11, 0]])
    made, *_ = aircraft_grid(Aircraft(Body(half), aircraft().wing), COARSE)
    rows = np.linalg.norm(np.diff(np.asarray(made.blocks[6].nodes)[:, :, :6], axis=2), axis=-1)
    assert (rows[:, :, 1:] / rows[:, :, :-1]).min() > 1.0
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in made.blocks) == 0


def test_first_cells_thicker_than_the_tip_leave_no_thin_ones_in_it() -> None:
    request = AircraftRequest(around=49, span=9, first_cell=2e-2, growth=1.5, far_field=8.0)
    ring = np.asarray(aircraft_grid(aircraft(), request)[0].blocks[7].nodes)[:, :, 0]
    steps = np.linalg.norm(np.diff(ring, axis=1), axis=-1)
    assert (steps / steps.sum(axis=1)[:, None]).min() > 0.02


def test_the_tip_of_a_canted_wing_lies_in_the_plane_of_its_section() -> None:
    jet = aircraft(y=-0.1)
    assert isinstance(jet.wing, Stack)
    root, end = jet.wing.sections[0], jet.wing.sections[-1]
    steep = replace(end, z=end.z + 0.2, y=end.y + 0.2, x=end.x + 0.1, cant=45.0)
    made = aircraft_grid(replace(jet, wing=replace(jet.wing, sections=(root, end, steep))), COARSE)[0]
    assert sum(count_folded_solids(block.nodes, BEZIER) for block in made.blocks) == 0
    normal = np.array([0.0, 1.0, 1.0]) / np.sqrt(2.0)
    for nodes, _ in wall(made, "tip"):
        away = (nodes - [steep.x, steep.y, steep.z]) @ normal
        assert np.abs(away).max() < 1e-9
