"""Poles of surfaces, sides of patches that are single points, become core patches."""

import sys
from pathlib import Path

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.geometry.surface.poles import without_poles
from meshonet.geometry.surface.surface import Surface, surface_of

sys.path.append(str(Path(__file__).parents[1] / "solvers"))
from spatial_shapes import ball
from surface_shapes import grid_of


def euler(surface: Surface) -> int:
    quads = np.sort(np.stack([surface.quads, np.roll(surface.quads, -1, axis=1)], axis=-1), axis=-1)
    return len(surface.nodes) - len(np.unique(quads.reshape(-1, 2), axis=0)) + len(surface.quads)


def least_jacobian(surface: Surface) -> float:
    """Least sine at the corners of faces, with its sign as seen from outside the unit sphere."""
    corners = surface.nodes[surface.quads]
    ahead, back = np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners
    sines = (np.cross(ahead, back) * corners).sum(axis=-1)
    return float((sines / np.linalg.norm(ahead, axis=-1) / np.linalg.norm(back, axis=-1)).min())


WHOLE = {
    "both poles of one patch": [ball(24, 20)],
    "an odd number of cells in a quarter": [ball(26, 20)],
    "two patches in each pole": [ball(12, 20, 1.0), ball(12, 20, 1.0, 1.0)],
    "one of them reversed": [ball(12, 20, 1.0), ball(12, 20, 1.0, 1.0)[::-1]],
    "four patches in two halves": [
        ball(12, 10, 1.0, begin, ends) for begin in (0.0, 1.0) for ends in ((0.0, 0.5), (0.5, 1.0))
    ],
}


@pytest.mark.parametrize("turned", [0, 1, 2, 3])
@pytest.mark.parametrize("patches", WHOLE.values(), ids=WHOLE)
def test_a_sphere_with_poles_becomes_one_without(patches: list[Floats], turned: int) -> None:
    surface = surface_of(grid_of([np.rot90(patch, turned, (0, 1)) for patch in patches]))
    assert euler(surface) == 2
    assert not len(surface.open_edges)
    assert len(surface.lattices) == len(patches) + 2
    assert np.linalg.norm(surface.nodes, axis=-1) == pytest.approx(1.0, abs=2e-3)
    assert least_jacobian(surface) > 0.55  # three cells meet at corners of cores: 120 degrees
    assert [note.startswith("the pole of patch") for note in surface.notes[:2]] == [True, True]


@pytest.mark.parametrize(("angle", "axes"), [(1.0, {2}), (0.5, {1, 2})])
def test_poles_in_planes_of_symmetry_stay_in_them(angle: float, axes: set[int]) -> None:
    surface = surface_of(grid_of([ball(16, 20, angle)]))
    assert least_jacobian(surface) > 0.55
    for node in surface.nodes[surface.open_edges.ravel()]:
        assert any(node[axis] == 0.0 for axis in axes)
    assert (np.abs(surface.nodes[:, 1:]).max(axis=1) == 0.0).sum() == 2, "the poles are nodes"


@pytest.mark.parametrize("around", [17, 19])
def test_half_a_ball_may_have_an_odd_number_of_cells_around_it(around: int) -> None:
    assert least_jacobian(surface_of(grid_of([ball(around, 20, 1.0)]))) > 0.5


def test_a_core_converges_to_the_surface() -> None:
    off = []
    for n in (12, 24, 48):
        patches, _, _ = without_poles([ball(n, n, ends=(0.0, 0.5))])
        off.append(np.abs(np.linalg.norm(patches[-1], axis=-1) - 1.0).max())
    assert off[0] > 6.0 * off[1] > 36.0 * off[2]


def test_patches_keep_their_numbers_and_what_is_beyond_the_nose() -> None:
    patch = ball(24, 40, ends=(0.0, 0.5))
    (kept, core), owners, _ = without_poles([patch])
    assert owners == [0, 0]
    assert kept.shape[0] == 25
    assert core.shape == (7, 7, 3)
    assert np.array_equal(kept[:, -20:], patch[:, -20:])


@pytest.mark.parametrize(
    ("around", "words"), [(25, "25 cells .* an even number"), (6, "6 cells .* 8 or more")]
)
def test_too_few_or_an_odd_number_of_cells_around_a_pole_is_refused(around: int, words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        surface_of(grid_of([ball(around, 12, ends=(0.0, 0.5))]))
    assert "x=-1, y=0, z=0" in str(error.value)


def test_a_surface_without_poles_stays_as_it_is() -> None:
    patch = ball(12, 8, ends=(0.2, 0.8))
    (same,), owners, notes = without_poles([patch])
    assert same is patch
    assert (owners, notes) == ([0], ())
