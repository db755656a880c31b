"""A grid on few nodes evaluated on many is a sum of matrices, and what these miss of the edges near them."""

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.kernels._native import resample
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample.quad import REACH
from meshonet.solvers.algebraic.resample.spline import bending, places
from meshonet.solvers.algebraic.tfi import interpolate, parameters
from meshonet.solvers.neural.quad.coarse_grids import rims, thinned, transfinite

RNG = np.random.default_rng(5)


def wavy(ni: int, nj: int) -> Floats:
    """Return two planes (2, 2, ni, nj) of skewed, wavy grids."""
    xi, eta = np.meshgrid(np.linspace(0, 1, ni), np.linspace(0, 1, nj), indexing="ij")
    first = [xi + 0.3 * eta**2 + 0.05 * np.sin(5 * xi * eta), eta - 0.1 * np.cos(4 * xi) + 0.4 * xi * eta]
    return np.array([first, [3.0 - 2.0 * first[1], 1.0 + first[0] * (1.0 + 0.2 * xi)]])


def placed(m: int, n: int, ni: int, nj: int) -> tuple:
    """Return the places of ni x nj nodes in a grid of m x n."""
    return places(m, ni), places(n, nj)


def matrices(m: int, count: int) -> tuple[Floats, Floats]:
    """Return (count, m): linear interpolation, and what second derivatives add."""
    off = np.clip(np.linspace(0, m - 1, count)[:, None] - np.arange(m), -1.0, 1.0)
    off = np.abs(off)
    return 1.0 - off, -off * (1.0 - off) * (2.0 - off) / 6.0


def shares_of(coarse: Floats) -> list[Floats]:
    torch = pytest.importorskip("torch")
    from meshonet.solvers.neural.differentiable.resample import inwards

    return [share.numpy() for share in inwards(torch.from_numpy(np.ascontiguousarray(coarse)))]


@pytest.mark.parametrize(
    ("m", "n", "ni", "nj"),
    [(33, 33, 65, 65), (9, 12, 40, 23), (5, 4, 17, 8), (3, 2, 7, 6), (2, 3, 2, 9), (33, 21, 12, 33)],
)
@pytest.mark.parametrize("straightened", [False, True])
def test_it_is_the_sum_of_matrices(m: int, n: int, ni: int, nj: int, straightened: bool) -> None:
    sides = rims(wavy(ni, nj))
    coarse = wavy(m, n) + 0.02 * RNG.normal(size=(2, 2, m, n))
    opened = np.array([[[0.7, 0.0], [1.0, 0.2]], [[0.0, 0.0], [0.0, 0.0]]])
    straight = (RNG.random((2, m, n)) < 0.3).astype(np.uint8) if straightened else None
    nodes = np.empty((2, 2, ni, nj))
    fine = placed(m, n, ni, nj)
    near = acute.NEAR, acute.FAR, REACH
    resample(coarse, sides, fine, opened.reshape(2, 4), *near, nodes, straight)

    left = 1.0 - (opened.reshape(2, 4, 1, 1) * acute.fading(m, n)).max(axis=1)
    left = (left * (1.0 if straight is None else 1 - straight))[:, None]
    (low, high), (line, curve) = matrices(m, ni), matrices(n, nj)
    along, across = bending(m, False), bending(n, False).T
    values = coarse @ line.T + (left * (coarse @ across)) @ curve.T
    bends = (left * (along @ coarse)) @ line.T + (left * (along @ coarse @ across)) @ curve.T
    expected = low @ values + high @ bends
    south, north, west, east = ((low @ one @ line.T)[:, None] for one in shares_of(coarse))
    missed = [side - own for side, own in zip(sides[2:], rims(expected)[2:], strict=True)]
    expected += west * missed[0][:, :, None] + east * missed[1][:, :, None]
    missed = [side - own for side, own in zip(sides[:2], rims(expected)[:2], strict=True)]
    expected += south * missed[0][..., None] + north * missed[1][..., None]
    inner = (..., slice(1, -1), slice(1, -1))
    np.testing.assert_allclose(nodes[inner], expected[inner], atol=1e-13)
    for side, given in zip(rims(nodes), sides, strict=True):
        assert np.array_equal(side, given)


@pytest.mark.parametrize(("m", "n", "ni", "nj"), [(33, 33, 65, 65), (9, 5, 40, 23), (4, 6, 3, 2)])
def test_the_beginning_is_the_interpolation_of_thinned_edges(m: int, n: int, ni: int, nj: int) -> None:
    sides = rims(wavy(ni, nj))
    for k, result in enumerate(transfinite(thinned(sides, m, n))):
        south, north, west, east = (side[k].T for side in thinned(sides, m, n))
        expected = np.empty((2, m, n))
        interpolate(
            *expected, (south, north, west, east), parameters((south, north, west, east), "arclength")
        )
        np.testing.assert_allclose(result, expected, rtol=0, atol=1e-14)


def test_arrays_that_do_not_fit_are_refused() -> None:
    sides = rims(wavy(9, 7))
    fine = placed(5, 5, 9, 7)
    coarse, opened, nodes = wavy(5, 5), np.zeros((2, 4)), np.empty((2, 2, 9, 7))
    near, straight = (acute.NEAR, acute.FAR, REACH), np.zeros((2, 5, 4), np.uint8)
    for given, report in (
        ((coarse[:1], sides, fine, opened, *near, nodes), "is needed"),
        ((coarse, tuple(side[:1] for side in sides), fine, opened, *near, nodes), "is needed"),
        ((coarse, sides, fine[::-1], opened, *near, nodes), "is needed"),
        ((coarse, sides, placed(8, 8, 9, 7), opened, *near, nodes), "index 4 out of range"),
        ((coarse, sides, fine, opened, *near, nodes, straight), "is needed"),
    ):
        with pytest.raises(ValueError, match=report):
            resample(*given)
