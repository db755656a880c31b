"""Symmetric domains get symmetric blocks, and grids whose nodes are symmetric to rounding."""

import numpy as np
import planar_domains
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planar_domains import box, circle
from scipy.spatial import cKDTree
from symmetric_shapes import SYMMETRIC, amiss, symmetric_domain, turned

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.blocking.block_grid import fine_layout
from meshonet.solvers.blocking.decomposition.decompose import decompose
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import mirrors_of


@pytest.mark.parametrize("name", SYMMETRIC)
def test_grids_of_symmetric_domains_are_symmetric(name):
    domain, (_, _, angles) = symmetric_domain(name), SYMMETRIC[name]
    results = [np.degrees(np.arctan2(*mirror.along[::-1])) % 180 for mirror in mirrors_of(domain)]
    np.testing.assert_allclose(results, angles, atol=1e-6)
    layout = decompose(domain)
    grids = [layout, fine_layout(layout, cells=1200), fine_layout(layout, cells=9000)]
    for each in grids:
        assert amiss(name, each.mesh.nodes) < 1e-9
        assert sum(count_folded(each.mesh.nodes[block]) for block in each.blocks) == 0


@pytest.mark.parametrize("degrees", [13.0, 45.0, 100.0])
def test_a_mirror_may_have_any_direction(degrees):
    domain = symmetric_domain("tube bank", degrees)
    (mirror,) = mirrors_of(domain)
    assert np.degrees(np.arctan2(*mirror.along[::-1])) % 180 == pytest.approx(degrees % 180, abs=1e-6)
    assert amiss("tube bank", fine_layout(decompose(domain), cells=1500).mesh.nodes, degrees) < 1e-9


def from_image(domain, nodes):
    """Return how far images of nodes in the first mirror of a domain are from nodes, by the extent."""
    mirror = mirrors_of(domain)[0]
    return cKDTree(nodes).query(mirror.images(nodes))[0].max() / domain.extent


@settings(max_examples=12, deadline=None, derandomize=True)
@given(
    st.lists(st.tuples(st.floats(0.15, 0.95), st.floats(0.6, 1.3)), min_size=3, max_size=6),
    st.floats(0, 360),
    st.sampled_from([0, 4, 6, 40]),
)
def test_grids_of_mirrored_polygons_are_symmetric(corners, degrees, hole):
    angles = np.linspace(0.2, np.pi - 0.2, len(corners))
    radius = np.array([2 * r for _, r in corners])
    upper = np.stack([radius * np.cos(angles), radius * np.sin(angles)], axis=1)
    loops = [np.concatenate([upper, upper[::-1] * [1, -1]])]
    if hole:
        loops.append(circle(0.1, 0, 0.2, hole))
    domain = Domain.of_polygons(turned(loops, degrees))
    layout = decompose(domain)
    fine = fine_layout(layout, cells=1500)
    assert sum(count_folded(fine.mesh.nodes[block]) for block in fine.blocks) == 0
    if from_image(domain, layout.mesh.nodes) < 1e-9:  # a sharp corner on the mirror may leave no such blocks
        assert from_image(domain, fine.mesh.nodes) < 1e-9


@pytest.mark.parametrize("name", ["step", "annulus", "cylinder in a channel", "blob", "spiky with a hole"])
def test_other_domains_have_no_mirrors(name):
    assert mirrors_of(planar_domains.domain(name)) == ()


def test_a_drawing_that_is_nearly_symmetric_is_not():
    polygons = [box(-2, 2, -1, 1), circle(0, 1e-4, 0.3, 40)]
    (mirror,) = mirrors_of(Domain.of_polygons(polygons))
    np.testing.assert_allclose(mirror.along, [0, 1])


def test_images_of_loops_and_arcs():
    domain = Domain.of_polygons(SYMMETRIC["two wings"][0])
    (mirror,) = mirrors_of(domain)
    assert mirror.loops.tolist() == [0, 2, 1]
    for number, loop in enumerate(domain.loops):
        arcs = np.linspace(0, loop.length, 37)
        other = domain.loops[mirror.loops[number]]
        np.testing.assert_allclose(
            mirror.images(loop.at(arcs)), other.at(mirror.sums[number] - arcs), atol=1e-9
        )


def test_the_core_of_a_disc_stands_upright():
    mesh = decompose(Domain.of_polygons([circle(0, 0, 1, 160)])).mesh
    core = mesh.nodes[mesh.irregular & ~mesh.wall_nodes]
    assert len(core) == 4
    np.testing.assert_allclose(np.degrees(np.arctan2(*np.abs(core).T)), 45, atol=4)
