"""Grids around a body with a fin in the plane of symmetry, apart from other wings or above a tail plane."""

from dataclasses import replace

import numpy as np
import pytest
from aircraft_shapes import aircraft, fin, tail, unclaimed_faces, wall

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.wall_surface import wall_surface
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.volumes import BEZIER, count_folded_solids, measure_volumes
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
from meshonet.solvers.aircraft.body_map import BodyMap
from meshonet.solvers.aircraft.plan import AircraftPlan
from meshonet.solvers.aircraft.request import AircraftRequest

SMALL = AircraftRequest(around=49, span=9, first_cell=2e-3, growth=1.4, far_field=8.0)
COARSE = replace(SMALL, around=33, span=7, growth=1.6)
"""What shows that a shape is made, in two thirds of the time."""
NAMES = {"fuselage", "wing", "tip", "tail", "tail-tip", "fin", "fin-tip", "symmetry", "farfield"}


def with_fin(**changes: float) -> Aircraft:
    """Fin and tail plane begin at about the same x."""
    return replace(aircraft(), others=(fin(**changes), tail()))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def grid() -> Grid:
    return aircraft_grid(with_fin(), SMALL)[0]


@pytest.fixture(scope="module")
def whole() -> Grid:
    """Both halves, from a file with the tail plane before the fin."""
    return aircraft_grid(replace(with_fin(), others=with_fin().others[::-1], half=False), SMALL)[0]


def folded(grid: Grid) -> int:
    return sum(count_folded_solids(block.nodes, BEZIER) for block in grid.blocks)


def test_no_cell_is_folded_or_flat_where_fin_and_tail_plane_begin_at_the_same_x(grid: Grid) -> None:
    assert folded(grid) == 0
    assert measure_volumes(grid)["scaled_jacobian"].min > 0.1


def test_fin_and_its_tip_are_patches_of_their_own_and_blocks_match(grid: Grid) -> None:
    assert {patch.name for patch in grid.patches} == NAMES
    assert unclaimed_faces(grid) == 0
    assert {"fin-collar", "fin-tip-ring", "fin-tip-core"} <= set(grid.provenance["zones"])


@pytest.mark.parametrize("name", ["fuselage", "wing", "tail", "fin", "fin-tip"])
def test_first_cells_are_exact_on_every_wall(grid: Grid, name: str) -> None:
    for nodes, beside in wall(grid, name):
        assert np.linalg.norm(beside - nodes, axis=-1) == pytest.approx(SMALL.height() * 2.0, rel=1e-9)


def test_the_fin_is_half_of_its_sections_and_ends_in_the_plane_of_symmetry(grid: Grid) -> None:
    ((nodes, _),) = wall(grid, "fin")
    assert (nodes[[0, -1], :, 2] == 0.0).all()
    assert (nodes[1:-1, :, 2] > 0.0).all()
    tip = nodes[:, -1] if nodes[0, -1, 1] > nodes[0, 0, 1] else nodes[:, 0]
    assert tip[:, 1] == pytest.approx(2.2, abs=1e-9)
    assert np.ptp(tip[:, 0]) == pytest.approx(0.6, rel=5e-3)
    half_thickness = 0.05 * 0.6
    assert tip[:, 2].max() == pytest.approx(half_thickness, rel=0.05)


def test_lines_leave_the_tip_of_a_fin_upwards(grid: Grid) -> None:
    for nodes, beside in wall(grid, "fin-tip"):
        away = (beside - nodes) / np.linalg.norm(beside - nodes, axis=-1, keepdims=True)
        assert np.percentile(away[..., 1], 5) > 0.999


@pytest.mark.parametrize(
    "changes",
    [{"x": 7.6, "sweep": 0.0}, {"x": 8.2, "sweep": 45.0}, {"height": 3.0}],
)
def test_fins_without_a_tail_plane_are_made(changes: dict[str, float]) -> None:
    made, *_ = aircraft_grid(replace(aircraft(), others=(fin(**changes),)), SMALL)
    assert folded(made) == 0
    assert measure_volumes(made)["scaled_jacobian"].min > 0.05


@pytest.mark.parametrize("sweep", [50.0, 55.0])
def test_no_cell_is_folded_at_the_tip_of_a_fin_swept_beyond_the_tail_of_the_body(sweep: float) -> None:
    made, *_ = aircraft_grid(with_fin(sweep=sweep), SMALL)
    assert folded(made) == 0


def test_cells_between_a_long_wing_and_a_short_fin_and_behind_it_grow_evenly() -> None:
    request = AircraftRequest(around=49, span=13, first_cell=2e-3, growth=1.2, far_field=20.0)
    made, *_ = aircraft_grid(replace(aircraft(), others=(fin(),)), request)
    for name in ("wing-to-fin", "fuselage-tail"):
        block = made.blocks[made.provenance["zones"].index(name)]
        ratios = np.concatenate([each.ravel() for each in growth(np.asarray(block.nodes))])
        assert (ratios <= 1.3).mean() >= 0.995
        assert ratios.max() < 1.6


def growth(nodes: Floats) -> list[Floats]:
    """The ratios, at least 1, of consecutive edges along all lines of a block."""
    out = []
    for axis in range(3):
        steps = np.moveaxis(np.linalg.norm(np.diff(nodes, axis=axis), axis=-1), axis, 0)
        ratios = steps[1:] / steps[:-1]
        out.append(np.maximum(ratios, 1.0 / ratios))
    return out


def test_a_fin_close_behind_the_wing_is_in_its_column() -> None:
    made, *_ = aircraft_grid(replace(aircraft(), others=(fin(x=6.6, sweep=0.0),)), COARSE)
    assert folded(made) == 0
    assert "wing-to-fin" not in made.provenance["zones"]


def test_a_fin_may_be_the_only_wing() -> None:
    made, *_ = aircraft_grid(Aircraft(aircraft().body, fin()), COARSE)
    assert folded(made) == 0
    assert {patch.name for patch in made.patches} == {"fuselage", "fin", "tip", "symmetry", "farfield"}


def test_the_surface_of_a_whole_aircraft_with_a_fin_is_closed(whole: Grid) -> None:
    assert folded(whole) == 0
    assert unclaimed_faces(whole) == 0
    assert not wall_surface(whole).patches


def test_the_number_of_cells_is_planned(grid: Grid) -> None:
    jet = with_fin()
    space = BodyMap(jet.body, 8.0 * jet.wing.chord + 0.5 * jet.body.extent)
    cells = sum(int(np.prod([count - 1 for count in block.counts])) for block in grid.blocks)
    assert AircraftPlan.of(jet, SMALL, space, SMALL.around).cells == pytest.approx(cells, rel=0.1)


def test_the_order_in_the_file_makes_no_difference(grid: Grid, whole: Grid) -> None:
    half = whole.blocks[: len(whole.blocks) // 2]
    for own, other in zip(half, grid.blocks, strict=True):
        assert np.array_equal(own.nodes, other.nodes)


@pytest.mark.parametrize("change", [{"shape": naca("2410")}, {"twist": 2.0}, {"y": 0.1}])
def test_a_fin_that_is_no_mirror_image_of_itself_is_refused(change: dict[str, object]) -> None:
    root, tip = fin().sections
    words = "NACA 2410 is not symmetric|2 in a fin|0.1 in a fin"
    with pytest.raises(InputError, match=words) as error:
        replace(fin(), sections=(root, replace(tip, **change)))
    assert error.value.place.startswith("sections[1].")


def test_a_fin_above_two_wings_is_refused_by_their_names() -> None:
    jet = replace(aircraft(), others=(fin(x=5.0, chord=3.6, sweep=0.0), tail()))
    with pytest.raises(InputError, match="the fin is above wing and tail, or close to them"):
        aircraft_grid(jet, SMALL)


def test_a_fin_that_begins_outside_of_the_body_is_refused_by_its_name() -> None:
    with pytest.raises(InputError, match="a line of the fin begins outside of the fuselage"):
        aircraft_grid(with_fin(x=9.4), SMALL)
