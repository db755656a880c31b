"""The boundary of a volume: six faces of a block, or six patches that are put together by position."""

import numpy as np
import pytest
from volume_shapes import bent_pipe, mapped, skewed

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.six_faces import FACES, SixFaces
from meshonet.geometry.blocks.six_patches import six_faces
from meshonet.geometry.curves.cubic import cubic_spline
from meshonet.geometry.errors import InputError

NODES = mapped(skewed, (5, 6, 7))


def patches(faces: list[np.ndarray]) -> Grid:
    return Grid(tuple(Block(face) for face in faces))


def test_the_faces_of_a_block_are_its_sides() -> None:
    faces = six_faces(Grid((Block(NODES),)))
    assert faces.counts == (5, 6, 7)
    np.testing.assert_array_equal(faces.west, NODES[0])
    np.testing.assert_array_equal(faces.north, NODES[:, -1])
    np.testing.assert_array_equal(faces.top, NODES[:, :, -1])


def test_patches_in_their_order_stay_as_they_are() -> None:
    block = SixFaces.of_block(NODES)
    again = six_faces(patches(list(block.faces)))
    for own, other in zip(block.faces, again.faces, strict=True):
        np.testing.assert_array_equal(own, other)
    assert again.notes == ()


@pytest.mark.parametrize("seed", range(12))
def test_patches_in_any_order_and_orientation_close_a_right_handed_volume(seed: int) -> None:
    rng = np.random.default_rng(seed)
    shuffled = []
    for face in SixFaces.of_block(NODES).faces:
        turned = face.swapaxes(0, 1) if rng.random() < 0.5 else face
        shuffled.append(turned[:: rng.choice([1, -1]), :: rng.choice([1, -1])])
    faces = six_faces(patches([shuffled[k] for k in rng.permutation(6)]))
    assert sorted(faces.counts) == [5, 6, 7]
    corner = faces.bottom[0, 0]
    steps = [faces.bottom[1, 0] - corner, faces.bottom[0, 1] - corner, faces.west[0, 1] - corner]
    assert np.linalg.det(steps) > 0
    assert {tuple(x) for x in faces.bottom.reshape(-1, 3)} <= {tuple(x) for x in NODES.reshape(-1, 3)}


def test_nearly_equal_edges_become_equal_and_a_note_says_so() -> None:
    rng = np.random.default_rng(0)
    faces = six_faces(
        patches([face + 1e-8 * rng.normal(size=face.shape) for face in SixFaces.of_block(NODES).faces])
    )
    assert "are now equal" in faces.notes[0]
    np.testing.assert_array_equal(faces.west[0], faces.south[0])


def test_a_gap_is_refused_with_the_patches_and_the_place() -> None:
    faces = [face.copy() for face in SixFaces.of_block(NODES).faces]
    faces[2][2, 0, 2] += 1e-3
    with pytest.raises(InputError, match=r"x=.*patches 2 and 4 \(south and bottom\) are 0.001 apart.*node 2"):
        six_faces(patches(faces))


def test_a_missing_patch_is_refused_with_a_corner_that_is_open() -> None:
    faces = list(SixFaces.of_block(NODES).faces)
    with pytest.raises(InputError, match="5 surface patches"):
        six_faces(patches(faces[:5]))
    with pytest.raises(InputError, match="meet in this corner"):
        six_faces(patches([*faces[:5], faces[5] + 3.0]))


def test_edges_of_other_counts_are_refused() -> None:
    faces = list(SixFaces.of_block(NODES).faces)
    faces[5] = faces[5][::2]
    with pytest.raises(InputError, match="5 and 3 nodes along their common edge"):
        six_faces(patches(faces))


def test_faces_that_do_not_share_bits_are_refused() -> None:
    faces = list(SixFaces.of_block(NODES).faces)
    with pytest.raises(InputError, match="apart along their common edge"):
        SixFaces(faces[0] + 1e-9, *faces[1:])


def test_resampled_faces_lie_on_the_surface_to_fourth_order() -> None:
    errors = []
    for n in (9, 17):
        finer = SixFaces.of_block(mapped(bent_pipe, (n, n, n))).resampled((2 * n, 2 * n, 2 * n))
        errors.append(
            max(np.abs(finer.top - mapped(bent_pipe, (2 * n, 2 * n, 2 * n))[:, :, -1]).max(), 1e-16)
        )
    assert np.log2(errors[0] / errors[1]) > 3.5
    assert [side for side in FACES if getattr(finer, side).shape != (34, 34, 3)] == []


def test_a_cubic_spline_reproduces_cubics_on_any_knots() -> None:
    knots = np.array([0.0, 0.3, 1.0, 1.1, 2.0, 3.5])
    places = np.linspace(0.0, 3.5, 29)
    np.testing.assert_allclose(cubic_spline(knots**3 - knots, knots, places), places**3 - places, atol=1e-12)
