import itertools

import numpy as np
import pytest
from format_shapes import channel

from meshonet.formats.mesh.slices import planar
from meshonet.geometry.errors import InputError

GRID = channel(6, 4)
X, Y = GRID.x, GRID.y


@pytest.mark.parametrize("planes", [1, 2, 5])
@pytest.mark.parametrize(("axis", "flat"), [*itertools.product(range(3), range(3))])
def test_a_plane_is_found_in_any_direction(planes: int, axis: int, flat: int) -> None:
    coordinates = [np.stack([c] * planes, axis) for c in (X, Y)]
    span = np.stack([np.full(X.shape, 0.25 * k) for k in range(planes)], axis)
    coordinates.insert(flat, span)
    assert np.array_equal(planar(coordinates), GRID.nodes)


def test_two_dimensions_without_z() -> None:
    assert np.array_equal(planar([X[..., None], Y[..., None]]), GRID.nodes)


def test_float32_copies_of_a_plane_are_copies() -> None:
    x = np.stack([X, X + 1e-8], 2)
    coordinates = [x, np.stack([Y, Y], 2), np.stack([0 * X, 0 * X + 1], 2)]
    assert planar(coordinates).shape == (6, 4, 2)


def test_copies_that_do_not_step_the_same_way_are_three_dimensional() -> None:
    x, y, z = np.stack([X] * 3, 2), np.stack([Y] * 3, 2), np.stack([0 * X, 0 * X + 1, 0 * X + 2], 2)
    x[..., 2] += 1.0  # the third plane is moved along x too
    with pytest.raises(InputError, match="a grid of 6x4x3 nodes is three-dimensional"):
        planar([x, y, z])


def test_two_different_planes_are_three_dimensional() -> None:
    coordinates = [np.stack([X, 1.5 * X], 2), np.stack([Y, Y], 2), np.stack([0 * X, 0 * X + 1], 2)]
    with pytest.raises(InputError, match="a grid of 6x4x2 nodes is three-dimensional; give a plane one"):
        planar(coordinates)


def test_three_dimensions_are_refused_with_their_size() -> None:
    block = np.random.default_rng(1).random((3, 5, 4, 3))
    with pytest.raises(InputError, match="a grid of 5x4x3 nodes is three-dimensional"):
        planar(list(block))


def test_a_curved_surface_is_refused() -> None:
    with pytest.raises(InputError, match="6x4x1 nodes lie on a curved or tilted surface; give"):
        planar([X[..., None], Y[..., None], (X * Y)[..., None]])


def test_a_line_is_refused() -> None:
    with pytest.raises(InputError, match="a grid of 5x1x1 nodes has no cells; give at least 2"):
        planar([np.arange(5.0).reshape(5, 1, 1)] * 2)
