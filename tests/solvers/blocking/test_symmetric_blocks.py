"""Symmetric domains get symmetric blocks, and grids whose nodes are symmetric to rounding."""

import numpy as np
import planar_domains
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from planar_domains import SHAPES, box, circle, polygon
from scipy.spatial import cKDTree

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.blocking.block_grid import fine_layout
from meshonet.solvers.blocking.decomposition.decompose import decompose
from meshonet.solvers.blocking.decomposition.symmetry.mirrors import mirrors_of

WING = np.concatenate(
    [np.stack([x, sign * 0.3 * np.sqrt(x) * (1 - x)], axis=1)
     for x, sign in ((0.5 + 0.5 * np.cos(np.linspace(0, np.pi, 40)[:-1]), 1),
                     (0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 40)[:-1]), -1))]
)  # fmt: skip


def holes(*places, radius=0.25, count=80):
    return [circle(x, y, radius, count) for x, y in places]


SYMMETRIC = {
    # name: polygons, mirrors (angles of the lines in degrees) that grids must have
    "disc": ([circle(0, 0, 1, 160)], (0, 90)),
    "ellipse": (SHAPES["ellipse"], (0, 90)),
    "plate with four holes": ([box(-2, 2, -2, 2), *holes((-1, -1), (1, -1), (1, 1), (-1, 1))], (0, 90)),
    "tube bank": (
        [box(0, 5, 0, 2), *holes((1, 0.5), (1, 1.5), (2, 1), (3, 0.5), (3, 1.5))],
        (0,),
    ),
    "cylinder in a channel": ([box(-2, 6, -2, 2), *holes((0, 0), radius=0.5)], (0,)),
    "square turned in a channel": ([box(-2, 6, -2, 2), circle(0, 0, 0.7, 4)], (0,)),
    "H": ([polygon(0, 0, 1, 0, 1, 2, 3, 2, 3, 0, 4, 0, 4, 5, 3, 5, 3, 3, 1, 3, 1, 5, 0, 5)], (0, 90)),
    "T": ([polygon(-0.5, 0, 0.5, 0, 0.5, 3, 2, 3, 2, 4, -2, 4, -2, 3, -0.5, 3)], (90,)),
    "two wings": ([box(-3, 5, -3, 3), np.add(WING, [0, 0.6]), np.add(WING * [1, -1], [0, -0.6])], (0,)),
    "wing": ([box(-3, 5, -3, 3), WING], (0,)),
    "hexagon": (SHAPES["hexagon"], (0, 90)),
    "triangle": (SHAPES["triangle"], (90,)),
    "star": (SHAPES["star"], (0,)),
    "ring": ([circle(0, 0, 1, 60), circle(0, 0, 0.5, 45)], (0,)),
}


def turned(polygons, degrees):
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return [
        np.stack([c * p[:, 0] - s * p[:, 1] + 3, s * p[:, 0] + c * p[:, 1] - 1], axis=1) for p in polygons
    ]


def amiss(domain, nodes):
    """Return how far images of nodes in each mirror are from nodes, by the extent."""
    tree = cKDTree(nodes)
    return [tree.query(mirror.images(nodes))[0].max() / domain.extent for mirror in mirrors_of(domain)]


@pytest.mark.parametrize("name", SYMMETRIC)
def test_grids_of_symmetric_domains_are_symmetric(name):
    polygons, angles = SYMMETRIC[name]
    domain = Domain.of_polygons(polygons)
    found = [np.degrees(np.arctan2(*mirror.along[::-1])) % 180 for mirror in mirrors_of(domain)]
    np.testing.assert_allclose(found, angles, atol=1e-6)
    layout = decompose(domain)
    grids = [layout, fine_layout(layout, cells=1200), fine_layout(layout, cells=9000)]
    for each in grids:
        assert max(amiss(domain, each.mesh.nodes)) < 1e-9
        assert sum(count_folded(each.mesh.nodes[block]) for block in each.blocks) == 0


@pytest.mark.parametrize("degrees", [13.0, 45.0, 100.0])
def test_a_mirror_may_have_any_direction(degrees):
    domain = Domain.of_polygons(turned(SYMMETRIC["tube bank"][0], degrees))
    (mirror,) = mirrors_of(domain)
    assert np.degrees(np.arctan2(*mirror.along[::-1])) % 180 == pytest.approx(degrees % 180, abs=1e-6)
    assert amiss(domain, fine_layout(decompose(domain), cells=1500).mesh.nodes)[0] < 1e-9


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
    if amiss(domain, layout.mesh.nodes)[0] < 1e-9:  # a sharp corner on the mirror may leave no such blocks
        assert amiss(domain, fine.mesh.nodes)[0] < 1e-9


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
