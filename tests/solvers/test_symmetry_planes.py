"""Which open edges of a surface lie in planes of symmetry, and which planes close in before the far field."""

import numpy as np
import pytest
from surface_shapes import corner_quality, grid_of, half_sphere, plate, room_corner, wing

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.surface.surface import surface_of
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface
from meshonet.solvers.hyperbolic.volume.symmetry import closes_in, symmetry_of


def planes(patches: list[Floats], far: float, axis: str | None = None) -> tuple[list[str], str]:
    symmetry = symmetry_of(surface_of(grid_of(patches)), axis, far)
    return [str(plane) for plane in symmetry.planes], "; ".join(symmetry.notes)


def test_planes_that_walls_of_a_corner_face_are_none_and_named() -> None:
    result, notes = planes(room_corner(8), 2.5)
    assert result == ["z = 0", "z = 1"]
    for name in ("x = 1", "y = 1"):
        assert f"the open edges at {name} are not in a plane of symmetry: walls 1 away face it" in notes


def test_planes_beyond_the_far_field_stay() -> None:
    assert set(planes(room_corner(8), 0.8)[0]) == {"x = 1", "y = 1", "z = 0", "z = 1"}


def test_a_plane_that_closes_in_is_refused_by_name() -> None:
    with pytest.raises(InputError, match="the plane x = 1 closes in before the far field: walls 1 away"):
        planes(room_corner(8), 2.5, "x")


@pytest.mark.parametrize(
    ("patches", "names"),
    [
        (half_sphere(6), ["z = 0"]),
        (wing(), ["z = 0"]),
        (plate(6), ["x = 0", "x = 1", "y = 0", "y = 1"]),
    ],
)
def test_planes_that_walls_end_at_or_turn_away_from_stay(patches: list[Floats], names: list[str]) -> None:
    result, notes = planes(patches, 50.0)
    assert result == names
    assert "not in a plane" not in notes


def test_the_distance_is_that_of_the_walls_that_face_the_plane() -> None:
    deep = [patch * np.array([3.0, 1.0, 1.0]) for patch in room_corner(6)]
    surface = surface_of(grid_of(deep))
    assert {str(p): closes_in(surface, p) for p in surface.planes} == pytest.approx(
        {"x = 3": 3.0, "y = 1": 1.0, "z = 0": np.inf, "z = 1": np.inf}
    )


def test_a_plate_is_extruded_whichever_way_it_faces() -> None:
    for turn in ([0, 1, 2], [1, 2, 0], [2, 0, 1]):
        grid = march_surface(surface_of(grid_of([plate(8)[0][..., turn]])), VolumeMarch(1e-3, 33, 2.5)).grid
        assert corner_quality(grid) > 0.99
