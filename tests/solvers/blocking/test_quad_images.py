"""Images of quads in a mirror follow from one quad and its image, across the edges that quads share."""

import numpy as np
import pytest

from meshonet.kernels._native import connect_quads, quad_images


def lattice(ni: int, nj: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (n, 2) of the nodes of a rectangle, and its quads (m, 4), in an order of chance."""
    draw = np.random.default_rng(ni)
    number = draw.permutation(ni * nj).reshape(ni, nj)
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    quads = np.stack(corners, axis=-1).reshape(-1, 4)
    quads = np.stack([np.roll(quad, draw.integers(4)) for quad in draw.permutation(quads)])
    places = np.empty((ni * nj, 2))
    places[number.ravel()] = np.argwhere(np.ones((ni, nj)))
    return places, quads


def twin(quads: np.ndarray) -> np.ndarray:
    return np.asarray(connect_quads(np.ascontiguousarray(quads, np.intp), int(quads.max()) + 1)[1])


@pytest.mark.parametrize(("ni", "nj"), [(2, 2), (6, 4), (7, 7), (30, 41)])
@pytest.mark.parametrize("mirror", [(1, -1), (-1, 1)])
def test_images_in_a_rectangle_are_the_quads_in_the_mirrored_places(
    ni: int, nj: int, mirror: tuple[int, int]
) -> None:
    places, quads = lattice(ni, nj)
    middle = 0.5 * np.array([ni - 1, nj - 1])
    mirrored = {tuple(place): node for node, place in enumerate((places - middle) * mirror + middle)}
    to = np.array([mirrored[tuple(place)] for place in places])
    wanted = [{*to[quad]} for quad in quads]
    image = next(k for k, quad in enumerate(quads) if {*quad} == wanted[0])
    corner = int(np.flatnonzero(quads[image] == to[quads[0, 0]])[0])
    images, first = quad_images(twin(quads), 0, image, corner)
    turned = quads[images[:, None], (first[:, None] - np.arange(4)) % 4]
    assert np.array_equal(turned, to[quads])


def test_a_quad_of_the_boundary_is_no_image_of_one_inside() -> None:
    places, quads = lattice(6, 6)
    inner = [k for k, quad in enumerate(quads) if (places[quad] > 0).all() and (places[quad] < 5).all()]
    outer = next(k for k, quad in enumerate(quads) if (places[quad] == 0).any())
    assert all(quad_images(twin(quads), inner[0], outer, corner) is None for corner in range(4))


def test_quads_that_are_not_joined_are_not_reached() -> None:
    quads = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])
    images, _ = quad_images(twin(quads), 0, 0, 0)
    assert images.tolist() == [0, -1]


@pytest.mark.parametrize("wrong", [(-1, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 4)])
def test_quads_and_corners_that_there_are_not_are_refused(wrong: tuple[int, int, int]) -> None:
    with pytest.raises(ValueError, match="that there is not"):
        quad_images(np.full((1, 4), -1, np.intp), *wrong)
