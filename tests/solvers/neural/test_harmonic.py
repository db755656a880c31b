"""The harmonic extension of a boundary against solutions in closed form."""

import numpy as np
import pytest

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.families.family import FAMILIES, family
from meshonet.solvers.conformal.harmonic import extend


def rectangle(ni: int, nj: int, height: float, bump: float = 0.0) -> Boundary:
    """Sides 1 and `height`, a sine of height `bump` on the floor."""
    x, y = np.linspace(0, 1, ni), np.linspace(0, height, nj)
    floor = bump * np.sin(np.pi * x)
    floor[-1] = 0.0
    edges = [(x, floor), (x, np.full(ni, height)), (np.zeros(nj), y), (np.ones(nj), y)]
    return Boundary(*(np.stack(edge, axis=1) for edge in edges))


def test_a_rectangle_is_left_alone() -> None:
    result = extend(rectangle(9, 13, 2.0))
    xi, eta = np.meshgrid(np.linspace(0, 1, 9), np.linspace(0, 2, 13), indexing="ij")
    np.testing.assert_allclose(result, np.stack([xi, eta], axis=-1), atol=1e-14)


def test_a_sine_decays_as_laplace_says() -> None:
    """Arc lengths of the sides give the aspect, so a small bump in a rectangle of height 0.5."""
    edges = rectangle(33, 17, 0.5, bump=1e-4)
    result = extend(edges)
    xi, y = np.meshgrid(np.linspace(0, 1, 33), np.linspace(0, 0.5, 17), indexing="ij")
    wanted = y + 1e-4 * np.sin(np.pi * xi) * np.sinh(np.pi * (0.5 - y)) / np.sinh(np.pi * 0.5)
    np.testing.assert_allclose(result[..., 1], wanted, atol=1e-10)


def test_a_ring_between_circles_is_conformal() -> None:
    angle = -2 * np.pi * np.arange(65) / 64
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    circle[-1] = circle[0]
    cut = np.stack([np.linspace(1, 3, 21), np.zeros(21)], axis=1)
    result = extend(Boundary(circle, 3 * circle, cut, cut, "o"))
    np.testing.assert_allclose(
        np.hypot(result[..., 0], result[..., 1])[7], 3 ** np.linspace(0, 1, 21), rtol=1e-12
    )


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("size", [(41, 31), (40, 33)])
def test_the_boundary_is_the_boundarys_own(name: str, size: tuple[int, int]) -> None:
    kind = family(name)
    edges = kind.boundary(0.5 * (kind.low + kind.high), *size)
    result = extend(edges)
    np.testing.assert_array_equal(result[:, 0], edges.south)
    np.testing.assert_array_equal(result[:, -1], edges.north)
    if edges.topology == "o":
        np.testing.assert_array_equal(result[0], result[-1])
    else:
        np.testing.assert_array_equal(result[0], edges.west)
        np.testing.assert_array_equal(result[-1], edges.east)
    # the maximum principle, and rows next to the boundary that come close to it
    for d in (0, 1):
        rim = np.concatenate([edges.south, edges.north, edges.west, edges.east])[:, d]
        assert result[..., d].min() >= rim.min() - 1e-9 * np.ptp(rim)
        assert result[..., d].max() <= rim.max() + 1e-9 * np.ptp(rim)
