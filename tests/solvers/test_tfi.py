"""Transfinite interpolation against closed forms and its own geometric definition."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from solver_shapes import arch, circle, naca, quad, ring, segment

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.tfi import tfi


def stretched(a: tuple[float, float], b: tuple[float, float], n: int, rng: np.random.Generator) -> np.ndarray:
    """Straight edge with random steps."""
    s = np.concatenate([[0.0], np.cumsum(rng.uniform(0.2, 1.0, n - 1))])
    s /= s[-1]
    return (1 - s)[:, None] * np.array(a) + s[:, None] * np.array(b)


def test_straight_uniform_edges_give_the_bilinear_map() -> None:
    a, b, c, d = (0.0, 0.0), (3.0, 0.5), (2.5, 2.0), (-0.5, 1.0)
    boundary = quad(segment(a, b, 7), segment(d, c, 7), segment(a, d, 5), segment(b, c, 5))
    u, v = (t[..., None] for t in np.meshgrid(np.linspace(0, 1, 7), np.linspace(0, 1, 5), indexing="ij"))
    bilinear = (
        (1 - u) * (1 - v) * np.array(a)
        + u * (1 - v) * np.array(b)
        + u * v * np.array(c)
        + (1 - u) * v * np.array(d)
    )
    for blending in ("linear", "arclength"):
        np.testing.assert_allclose(tfi(boundary, blending).nodes, bilinear, atol=1e-14)  # type: ignore[arg-type]


@pytest.mark.slow
@settings(max_examples=20, deadline=None)
@given(ni=st.integers(2, 9), nj=st.integers(2, 9), seed=st.integers(0, 1000))
def test_arc_length_blending_puts_nodes_where_lines_between_opposite_nodes_cross(
    ni: int, nj: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    south, north = stretched((0, 0), (1, 0), ni, rng), stretched((0, 1), (1, 1), ni, rng)
    west, east = stretched((0, 0), (0, 1), nj, rng), stretched((1, 0), (1, 1), nj, rng)
    nodes = tfi(quad(south, north, west, east)).nodes
    for i in range(ni):
        for j in range(nj):
            up, across = north[i] - south[i], east[j] - west[j]
            matrix = np.stack([up, -across], axis=1)
            along = np.linalg.solve(matrix, west[j] - south[i])
            np.testing.assert_allclose(nodes[i, j], south[i] + along[0] * up, atol=1e-13)


@pytest.mark.parametrize("blending", ["linear", "arclength"])
@pytest.mark.parametrize(
    "boundary",
    [arch(33, 18), naca(41, 12), arch(2, 2), arch(2, 9), naca(41, 2)],
    ids=lambda b: f"{b.name}-{b.ni}x{b.nj}",
)
def test_edges_are_those_of_the_boundary_bitwise(boundary: Boundary, blending: str) -> None:
    nodes = tfi(boundary, blending).nodes  # type: ignore[arg-type]
    assert np.array_equal(nodes[:, 0], boundary.south)
    assert np.array_equal(nodes[:, -1], boundary.north)
    assert np.array_equal(nodes[0], boundary.west)
    assert np.array_equal(nodes[-1], boundary.east)


def test_ring_between_circles_is_polar() -> None:
    nodes = tfi(ring(circle(1.0, 33), circle(3.0, 33), 9)).nodes
    np.testing.assert_allclose(
        np.hypot(*np.moveaxis(nodes, -1, 0)), np.broadcast_to(np.linspace(1, 3, 9), (33, 9)), atol=1e-13
    )


def test_the_grid_keeps_name_topology_and_parts() -> None:
    boundary = naca(41, 12)
    grid = tfi(boundary)
    assert (grid.name, grid.topology, grid.patches) == (boundary.name, "o", boundary.patches)
    assert grid.provenance == {"method": "tfi", "blending": "arclength"}


def test_an_unknown_blending_is_refused_with_the_known_ones() -> None:
    with pytest.raises(InputError, match="blending 'cubic' is not known; use linear/arclength"):
        tfi(arch(5, 5), "cubic")  # type: ignore[arg-type]
