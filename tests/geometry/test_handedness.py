"""The signed volume of a block against what is known of it."""

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.handedness import signed_volume


def box(counts: tuple[int, int, int]) -> Floats:
    """(3, ni, nj, nk) of a parallelepiped of volume 6, far from the origin."""
    x, y, z = np.meshgrid(*(np.linspace(0, 1, n) ** 2 for n in counts), indexing="ij")
    return np.stack([2 * x + y, 3 * y - z, z]) + 1e4


def test_a_box_has_its_volume_and_a_mirrored_one_less_it() -> None:
    nodes = box((4, 5, 3))
    assert signed_volume(list(nodes)) == pytest.approx(6, rel=1e-9)
    for axis in range(3):
        assert signed_volume(list(np.flip(nodes, axis + 1))) == pytest.approx(-6, rel=1e-9)
    assert signed_volume(list(np.moveaxis(nodes, 1, 3))) == pytest.approx(6, rel=1e-9)
    assert signed_volume(list(np.swapaxes(nodes, 1, 2))) == pytest.approx(-6, rel=1e-9)


def test_a_shell_that_closes_on_itself_converges_to_its_volume_by_the_square() -> None:
    """A hollow cylinder, radius 1 to 2, height 3: of volume 9 pi, and seen from i clockwise."""
    errors = []
    for count in (17, 33):
        angle = -np.linspace(0, 2 * np.pi, count)[:, None, None]
        radius, z = np.linspace(1, 2, 4)[None, :, None], np.linspace(0, 3, 3)[None, None, :]
        one = np.ones((count, 4, 3))
        nodes = [radius * np.cos(angle) * one, radius * np.sin(angle) * one, z * one]
        errors.append(signed_volume(nodes) - 9 * np.pi)
    assert errors[0] < 0
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.05)
