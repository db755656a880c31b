"""Seams and trailing edges of surfaces as they come: T-junctions, other nodes, open edges, holes, slants."""

import numpy as np
import pytest
from surface_shapes import between, corner_quality, cube, grid_of, naca, open_wing, plate, wing

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.surface.surface import surface_of
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface

MARCH = VolumeMarch(first_cell=1e-3, layers=25, far_field=4.0)


@pytest.mark.parametrize(("cuts", "connections"), [(1, 12 + 2 + 1), (2, 12 + 2 + 1 + 3)])
def test_one_side_next_to_several_patches_is_connected_in_parts(cuts: int, connections: int) -> None:
    *sides, top = cube(8)
    right = [top[3:]] if cuts == 1 else [top[3:, :6], top[3:, 5:]]
    grid = march_surface(surface_of(grid_of([*sides, top[:4], *right])), MARCH).grid
    assert {patch.name for patch in grid.patches} == {"wall", "farfield"}
    assert len(grid.connections) == connections


@pytest.mark.parametrize("cells", [6, 4])
def test_sides_of_other_nodes_are_refused_with_both_places(cells: int) -> None:
    patches = [*cube(8)[:5], cube(cells)[5]]
    with pytest.raises(InputError, match=r"sides that meet have other nodes, .* at patch \d, i=.* next to"):
        surface_of(grid_of(patches))


@pytest.mark.parametrize("sweep", [0.0, 0.4])
@pytest.mark.parametrize("turned", [(), (0,), (1, 3)])
def test_an_open_trailing_edge_is_closed_by_a_base(sweep: float, turned: tuple[int, ...]) -> None:
    patches = [p[::-1] if k in turned else p for k, p in enumerate(open_wing(sweep=sweep))]
    surface = surface_of(grid_of(patches))
    assert "was closed by a base of 4 cells across, patch 4" in surface.notes[0]
    assert [str(plane) for plane in surface.planes] == ["y = 0"]
    assert np.abs(surface.nodes[surface.open_edges, 1]).max() == 0.0
    assert corner_quality(march_surface(surface, MARCH).grid) > 0.0


def test_a_base_has_the_nodes_of_the_tip_that_is_open_there() -> None:
    patches = open_wing(across=5)
    patches[3][-1, 1:-1, 0] += 1e-3 * np.array([1.0, 2.0, 2.0, 1.0])
    surface = surface_of(grid_of(patches))
    base = surface.nodes[surface.lattices[-1]]
    assert sorted(base.shape) == [3, 6, 25]
    bulge = base[..., 0].max(axis=1 if base.shape[1] == 6 else 0) - 1.0
    assert np.sort(bulge) == pytest.approx(2e-3 * np.linspace(0.0, 1.0, 25), abs=1e-12)


def test_a_wing_between_walls_gets_a_base_as_its_cells_are() -> None:
    surface = surface_of(grid_of(open_wing(thick=0.04, tip=False, sweep=0.3)))
    assert "a base of 2 cells across" in surface.notes[0]
    assert {str(plane) for plane in surface.planes} == {"y = 0", "y = 2"}


def test_ends_of_an_open_edge_with_other_numbers_of_cells_are_refused() -> None:
    upper, lower, _, tip = open_wing(across=5, sweep=0.3)
    root = between(lower[:, 0], upper[:, 0], 3)
    with pytest.raises(InputError, match="has 4 nodes across one end, 6 across the other"):
        surface_of(grid_of([upper, lower, root, tip]))


@pytest.mark.parametrize("patches", [wing(), cube(6), plate(6), open_wing(thick=0.5)])
def test_roots_plates_and_thick_openings_are_not_closed(patches: list[Floats]) -> None:
    surface = surface_of(grid_of(patches))
    assert not any("base" in note for note in surface.notes)
    assert len(surface.lattices) == len(patches)


def test_a_sharp_trailing_edge_between_walls_is_marched() -> None:
    loop = naca(32)
    loop[0] = loop[-1] = 0.5 * (loop[0] + loop[-1])
    y = np.linspace(0.0, 1.0, 7)
    main = np.stack(np.broadcast_arrays(loop[:, None, 0], y, loop[:, None, 1]), axis=-1)
    main[-1] = main[0]
    assert corner_quality(march_surface(surface_of(grid_of([main])), MARCH).grid) > 0.0


def test_a_pole_between_seams_is_refused_with_its_place() -> None:
    upper, lower, *_ = open_wing()
    for patch in (upper, lower):
        patch[0, :, 2] = 0.0
    tip = between(lower[:, -1], upper[:, -1], 8)
    with pytest.raises(InputError, match="the pole of patch 2 is where a seam with patch"):
        surface_of(grid_of([upper, lower, tip]))


def test_the_small_hole_at_the_end_of_half_a_body_is_no_plane_of_symmetry() -> None:
    x, angle = np.linspace(0.0, 1.0, 25)[None], np.linspace(0.0, np.pi, 17)[:, None]
    radius = 0.1 * np.sqrt(1.02 - x) * np.sqrt(x)
    half = np.stack(np.broadcast_arrays(x, radius * np.sin(angle), radius * np.cos(angle)), axis=-1)
    half[[0, -1], :, 1] = 0.0
    surface = surface_of(grid_of([half]))
    assert [str(plane) for plane in surface.planes] == ["y = 0"]
    at_end = (surface.nodes[surface.open_edges, 0] == 1.0).all(axis=1)
    assert at_end.sum() == 16


def test_a_slanted_plate_ends_in_no_plane_that_it_meets_at_an_angle() -> None:
    patch = plate(6)[0] @ np.array([[1.0, 0.0, 0.3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    surface = surface_of(grid_of([patch]))
    assert [str(plane) for plane in surface.planes] == ["y = 0", "y = 1"]
    notes = " ".join(surface.notes)
    assert "x = 0 are not in a plane of symmetry: the surface meets it at 73 degrees" in notes
