"""Grids around a body with a wing and a tail plane behind it: both are walls of matched blocks."""

from dataclasses import replace

import numpy as np
import pytest
from aircraft_shapes import aircraft, tail, unclaimed_faces, wall

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.wall_surface import wall_surface
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids, measure_volumes
from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.plan import AircraftPlan
from meshonet.solvers.aircraft.request import AircraftRequest

SMALL = AircraftRequest(around=49, span=9, first_cell=2e-3, growth=1.4, far_field=8.0)
COARSE = replace(SMALL, around=33, span=7, growth=1.6)
"""What shows that a shape is made, in two thirds of the time."""
NAMES = {"fuselage", "wing", "tip", "tail", "tail-tip", "symmetry", "farfield"}


def with_tail(**changes: float) -> Aircraft:
    return replace(aircraft(), others=(tail(**changes),))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def grid() -> Grid:
    return aircraft_grid(with_tail(), SMALL)[0]


@pytest.fixture(scope="module")
def swapped() -> Grid:
    """Both halves, from a file with the tail plane before the wing: canards, whose chord lengths are in."""
    jet = Aircraft(aircraft().body, tail(), others=(replace(aircraft().wing, name="wing"),), half=False)
    unit = tail().chord / aircraft().wing.chord
    return aircraft_grid(jet, replace(SMALL, first_cell=SMALL.height() / unit, far_field=8.0 / unit))[0]


def folded(grid: Grid) -> int:
    return sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks)


def test_no_cell_is_folded_or_flat(grid: Grid) -> None:
    assert folded(grid) == 0
    assert measure_volumes(grid)["scaled_jacobian"].min > 0.1


def test_wing_and_tail_plane_are_patches_of_their_own_and_blocks_match(grid: Grid) -> None:
    assert {patch.name for patch in grid.patches} == NAMES
    assert unclaimed_faces(grid) == 0


@pytest.mark.parametrize("name", ["fuselage", "wing", "tip", "tail", "tail-tip"])
def test_first_cells_are_exact_on_every_wall(grid: Grid, name: str) -> None:
    for nodes, beside in wall(grid, name):
        assert np.linalg.norm(beside - nodes, axis=-1) == pytest.approx(SMALL.height() * 2.0, rel=1e-9)


@pytest.mark.parametrize(("name", "span", "chord"), [("tip", 5.0, 1.0), ("tail-tip", 1.9, 0.5)])
def test_each_tip_is_the_last_section_of_its_wing(grid: Grid, name: str, span: float, chord: float) -> None:
    nodes = np.concatenate([nodes.reshape(-1, 3) for nodes, _ in wall(grid, name)])
    assert nodes[:, 2] == pytest.approx(span, abs=1e-9)
    assert np.ptp(nodes[:, 0]) == pytest.approx(chord, rel=5e-3)


@pytest.mark.parametrize("name", ["tip", "tail-tip"])
def test_lines_leave_tips_at_right_angles(grid: Grid, name: str) -> None:
    """Levels are as oblique to the tail plane as its place on the narrowing body makes them."""
    for nodes, beside in wall(grid, name):
        away = (beside - nodes) / np.linalg.norm(beside - nodes, axis=-1, keepdims=True)
        assert np.percentile(away[..., 2], 5) > 0.999


def test_the_order_of_wings_in_the_file_makes_no_difference(grid: Grid, swapped: Grid) -> None:
    """Canards, a second wing before the first: lengths are still in chords of the first."""
    half = swapped.blocks[: len(swapped.blocks) // 2]
    assert [block.counts for block in half] == [block.counts for block in grid.blocks]
    for own, other in zip(half, grid.blocks, strict=True):
        assert np.abs(own.nodes - other.nodes).max() < 1e-6


@pytest.mark.parametrize(("x", "y", "span"), [(8.6, 0.0, 3.0), (7.6, 0.45, 1.2), (0.9, 0.0, 1.5)])
def test_tail_planes_high_low_long_and_canards_are_made(x: float, y: float, span: float) -> None:
    made, *_ = aircraft_grid(with_tail(x=x, y=y, span=span), COARSE)
    assert folded(made) == 0
    assert measure_volumes(made)["scaled_jacobian"].min > 0.05


def test_the_surface_of_a_whole_aircraft_with_a_tail_plane_is_closed(swapped: Grid) -> None:
    assert folded(swapped) == 0
    assert unclaimed_faces(swapped) == 0
    assert not wall_surface(swapped).patches


@pytest.mark.parametrize(
    ("x", "words"),
    [(5.5, "tail begins .* behind the end of wing"), (4.0, "wing begins .* before the end of tail")],
)
def test_wings_that_are_too_close_are_refused_with_their_names_and_distance(x: float, words: str) -> None:
    with pytest.raises(InputError, match=f"{words}; move one of them by"):
        aircraft_grid(with_tail(x=x), SMALL)


def test_a_tail_plane_outside_of_the_body_is_refused_by_its_name() -> None:
    with pytest.raises(InputError, match="a line of the tail begins outside of the fuselage"):
        aircraft_grid(with_tail(y=1.5), SMALL)


def test_the_number_of_cells_is_planned(grid: Grid) -> None:
    jet = with_tail()
    space = BodyMap(jet.body, 8.0 * jet.wing.chord + 0.5 * jet.body.extent)
    cells = sum(int(np.prod([count - 1 for count in block.counts])) for block in grid.blocks)
    assert AircraftPlan.of(jet, SMALL, space, SMALL.around).cells == pytest.approx(cells, rel=0.1)


def test_wings_with_the_same_name_are_refused() -> None:
    with pytest.raises(InputError, match="wing is the name of another patch") as error:
        replace(aircraft(), others=(tail(name="wing"),))
    assert error.value.place == "wings[1].name"
