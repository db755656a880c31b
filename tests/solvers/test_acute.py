"""Near acute corners the difference is straight between coarse nodes, elsewhere it is a spline."""

import numpy as np
import pytest
from solver_shapes import arch

from geometry.arrays import Floats
from geometry.boundary import Boundary
from geometry.quality import count_folded
from solvers import acute
from solvers.coarse import evaluate, thinned
from solvers.spline import bending, spline_matrix
from solvers.tfi import tfi
from solvers.variational.solve import solve


def spike(degrees: float, n: int) -> Boundary:
    """Return a domain whose corner at the origin has this angle, between a straight and a curved wall."""
    t = np.linspace(0.0, 1.0, n)
    south = np.stack([t, 0.0 * t], axis=-1)
    slope = np.tan(np.radians(degrees))
    west = np.stack([0.8 * t, slope * 0.8 * t + 0.7 * t**3], axis=-1)
    corner = west[-1] + (0.6, -0.1)
    north = (1.0 - t[:, None]) * west[-1] + t[:, None] * corner
    east = (1.0 - t[:, None]) * south[-1] + t[:, None] * corner
    return Boundary(south, north, west, east)


def kite(degrees: float, n: int) -> Boundary:
    """Return a domain with straight edges whose corner at the origin has this angle, all others wide ones."""
    t = np.linspace(0.0, 1.0, n)[:, None]
    half = 0.5 * np.radians(degrees)
    right, left = np.array([1.0, 0.0]), np.array([np.cos(2 * half), np.sin(2 * half)])
    far = 1.1 * np.array([np.cos(half), np.sin(half)])
    return Boundary(t * right, left + t * (far - left), t * left, right + t * (far - right))


def shares(nodes: Floats) -> Floats:
    """Return the shares at the nodes (m, n, 2) of a grid."""
    return acute.taken_out(acute.openings(nodes[..., 0] + 1j * nodes[..., 1], np), *nodes.shape[:2])


@pytest.mark.parametrize(("degrees", "share"), [(20.0, 1.0), (45.0, 0.5), (70.0, None)])
def test_the_share_goes_with_the_angle_of_the_corner(degrees: float, share: float | None) -> None:
    found = shares(tfi(kite(degrees, 33)).nodes)
    if share is None:
        assert not found.any()
    else:
        assert found[0, 0] == found[4, 4] == pytest.approx(share)
        assert found[10, 0] == found[0, 10] == found[-1, -1] == 0.0
        assert 0.0 < found[7, 3] < share


def test_each_corner_is_looked_at() -> None:
    nodes = tfi(spike(10.0, 33)).nodes
    whole = shares(nodes)
    assert whole.any()
    for turned, expected in ((nodes[::-1], whole[::-1]), (nodes[:, ::-1], whole[:, ::-1])):
        np.testing.assert_allclose(shares(turned), expected, atol=1e-12)


@pytest.mark.parametrize(("m", "n", "count"), [(33, 33, 65), (33, 33, 200), (65, 25, 31), (12, 9, 17)])
def test_splines_keep_the_share_that_is_left(m: int, n: int, count: int) -> None:
    rng = np.random.default_rng(0)
    difference, opened = rng.normal(size=(3, 2, m, n)), rng.random((3, 2, 2)) * [[[0]], [[1]], [[1]]]
    opened[2, 0] = 0.0
    along, across = bending(m, False), bending(n, False)
    off = np.minimum(np.abs(np.linspace(0, n - 1, count) - np.arange(n)[:, None]), 1.0)
    straight, curved = 1.0 - off, -off * (1.0 - off) * (2.0 - off) / 6.0
    second = along @ difference
    left = 1.0 - acute.taken_out(opened, m, n)[:, None]
    values, bends = (field @ spline_matrix(n, count).T for field in (difference, second))
    acute.take_out(values, bends, (difference, second), opened, across)
    expected = difference @ straight + (left * (difference @ across.T)) @ curved
    np.testing.assert_allclose(values, expected, atol=1e-10)
    expected = (left * second) @ straight + (left * (second @ across.T)) @ curved
    np.testing.assert_allclose(bends, expected, atol=1e-10)


def test_wide_corners_are_left_to_the_spline() -> None:
    boundary = arch(129, 129)
    assert not shares(tfi(thinned(boundary, 33, 33)).nodes).any()


@pytest.mark.parametrize("degrees", [4.0, 8.0, 15.0])
@pytest.mark.parametrize("n", [65, 193])
def test_a_valid_grid_in_a_spike_stays_valid_when_evaluated(degrees: float, n: int) -> None:
    boundary = spike(degrees, n)
    coarse = solve(thinned(boundary, 33, 33)).grid.nodes
    assert count_folded(coarse) == 0
    assert count_folded(evaluate(coarse, boundary)) == 0
