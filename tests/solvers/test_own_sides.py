"""Steps after the quad network do not depend on where a domain lies, nor on how its sides are named."""

from itertools import product

import numpy as np
import pytest
from random_quads import random_quad

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.neural.quad.canonical_frame import Element, canonical
from meshonet.solvers.neural.registry import load


def domain(seed: int = 2003, ni: int = 33, nj: int = 33) -> Boundary:
    boundary = random_quad(seed, ni, nj)
    assert boundary is not None
    return boundary


def relabelled(z: Complexes, element: Element) -> Complexes:
    """Return a grid (ni, nj) under other names, its mirror image where they would turn it over."""
    along, across, turned = element
    z = z[:: -1 if along else 1, :: -1 if across else 1]
    z = z.T if turned else z
    return z.conj() if sum(element) % 2 else z


def inside(z: Complexes) -> Boundary:
    """Return the boundary of a grid."""
    south, north, west, east = (np.stack([s.real, s.imag], -1) for s in (z[:, 0], z[:, -1], z[0], z[-1]))
    return Boundary(south, north, west, east, "quad")


def rim(boundary: Boundary) -> Complexes:
    """Return a grid of which only the rim is given."""
    z = np.zeros((boundary.ni, boundary.nj), complex)
    for at, side in (
        (np.s_[:, 0], boundary.south), (np.s_[:, -1], boundary.north), (0, boundary.west), (-1, boundary.east)
    ):  # fmt: skip
        z[at] = side[:, 0] + 1j * side[:, 1]
    return z


def polished(boundary: Boundary) -> Complexes:
    nodes: Floats = load("quad-general").solve([boundary], 5)[0].grid.nodes
    return np.asarray(nodes[..., 0] + 1j * nodes[..., 1])


@pytest.mark.parametrize("element", list(product((False, True), repeat=3)))
def test_named_otherwise_a_domain_has_the_same_grid_to_rounding(element: Element) -> None:
    given = rim(domain())
    moved = (3.0 - 7.0j) + 0.017 * np.exp(1.2j) * relabelled(given, element)
    expected = (3.0 - 7.0j) + 0.017 * np.exp(1.2j) * relabelled(polished(inside(given)), element)
    result = polished(inside(moved))
    assert np.abs(result - expected).max() < 1e-12 * np.ptp(np.abs(expected - expected.mean()))


def test_unequal_counts_keep_their_axes() -> None:
    boundary = domain(ni=41, nj=25)
    frame = canonical(boundary)
    assert (frame.boundary.ni, frame.boundary.nj) == (41, 25)
    assert polished(boundary).shape == (41, 25)


def test_the_way_there_and_back_ends_where_it_began() -> None:
    boundary = domain()
    frame = canonical(boundary)
    back = frame.back(np.moveaxis(tfi(frame.boundary).nodes, -1, 0))
    np.testing.assert_allclose(np.moveaxis(back, 0, -1), tfi(boundary).nodes, rtol=0, atol=1e-8)
    np.testing.assert_array_equal(back[:, 0].T, boundary.west)


def test_nodes_nearer_than_the_rounding_stay_where_they_are() -> None:
    z = rim(domain())
    z[1, 0] = z[0, 0] + 1e-11 * (z[2, 0] - z[0, 0])
    boundary = inside(z)
    frame = canonical(boundary)
    assert frame.boundary is boundary
    np.testing.assert_array_equal(frame.back(np.stack([z.real, z.imag])), np.stack([z.real, z.imag]))
