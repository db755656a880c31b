"""Extra relaxation around re-entrant corners: where it is done, and what it is good for."""

import numpy as np
import pytest
from solver_shapes import arch, bump, hexagon, l_shape, spike, wrench

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.polygon.corners import find_corners
from meshonet.solvers.elliptic import corner_relaxation as patches
from meshonet.solvers.elliptic.corner_relaxation import reentrant
from meshonet.solvers.elliptic.solve import solve


def corners(boundary: Boundary) -> list[tuple[str, int]]:
    return reentrant((boundary.south, boundary.north, boundary.west, boundary.east))


def turned(boundary: Boundary) -> Boundary:
    """The same domain with xi and eta exchanged, mirrored so that cells stay positive."""
    flip = np.array([-1.0, 1.0])
    south, north = boundary.west * flip, boundary.east * flip
    return Boundary(south, north, boundary.south * flip, boundary.north * flip, "quad")


def test_corners_that_point_into_the_domain_are_found() -> None:
    notch = wrench(101, 101)
    inside = find_corners(notch.north)[2:4]
    assert corners(notch) == [("north", int(k)) for k in inside]
    assert corners(turned(notch)) == [("east", int(k)) for k in inside]
    assert [side for side, _ in corners(l_shape(101, 41))] == ["north"]
    assert [side for side, _ in corners(spike(101, 101))] == ["south"]


@pytest.mark.parametrize("make", [arch, hexagon, bump])
def test_corners_that_point_out_are_left_alone(make) -> None:  # type: ignore[no-untyped-def]
    assert corners(make(101, 101)) == []


def test_cycles_around_a_notch_converge_faster(monkeypatch: pytest.MonkeyPatch) -> None:
    boundary = wrench(321, 321)
    helped = solve(boundary, tol=1e-6)
    monkeypatch.setattr(patches, "LEAST", 10_000)
    alone = solve(boundary, tol=1e-6)
    assert helped.cycles <= 0.7 * alone.cycles
    np.testing.assert_allclose(helped.grid.nodes, alone.grid.nodes, atol=1e-4)


def test_the_default_stop_around_a_notch_leaves_less_error_than_the_discretisation() -> None:
    boundary = wrench(321, 321)
    result, full = solve(boundary).grid.nodes, solve(boundary, tol=1e-7, max_cycles=60).grid.nodes
    half = solve(wrench(161, 161), tol=1e-7, max_cycles=60).grid.nodes
    assert np.linalg.norm(result - full) < np.linalg.norm(half - full[::2, ::2]) * 2
