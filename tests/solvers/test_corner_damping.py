"""Near acute corners lines are straight between coarse nodes, elsewhere they are splines."""

import numpy as np
import pytest
from solver_shapes import arch

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample.grids import refine_grid, thinned
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.energy.variational import solve


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
    opened = acute.openings(nodes[..., 0] + 1j * nodes[..., 1], np).reshape(4, 1, 1)
    return np.asarray((opened * acute.fading(*nodes.shape[:2])).max(axis=0))


@pytest.mark.parametrize(("degrees", "share"), [(20.0, 1.0), (45.0, 0.5), (70.0, None)])
def test_the_share_goes_with_the_angle_of_the_corner(degrees: float, share: float | None) -> None:
    result = shares(tfi(kite(degrees, 33)).nodes)
    if share is None:
        assert not result.any()
    else:
        assert result[0, 0] == result[4, 4] == pytest.approx(share)
        assert result[10, 0] == result[0, 10] == result[-1, -1] == 0.0
        assert 0.0 < result[7, 3] < share


def test_each_corner_is_looked_at() -> None:
    nodes = tfi(spike(10.0, 33)).nodes
    whole = shares(nodes)
    assert whole.any()
    for turned, expected in ((nodes[::-1], whole[::-1]), (nodes[:, ::-1], whole[:, ::-1])):
        np.testing.assert_allclose(shares(turned), expected, atol=1e-12)


def test_wide_corners_are_left_to_the_spline() -> None:
    boundary = arch(129, 129)
    assert not shares(tfi(thinned(boundary, 33, 33)).nodes).any()


@pytest.mark.parametrize("degrees", [4.0, 8.0, 15.0])
@pytest.mark.parametrize("n", [65, 193])
def test_a_valid_grid_in_a_spike_stays_valid_when_evaluated(degrees: float, n: int) -> None:
    boundary = spike(degrees, n)
    coarse = solve(thinned(boundary, 33, 33)).grid.nodes
    assert count_folded(coarse) == 0
    assert count_folded(refine_grid(coarse, boundary)) == 0
