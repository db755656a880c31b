"""Layouts at other counts: on their loops, nested, with the cells asked for."""

import numpy as np
import pytest
from known_meshes import annulus, box, corner, disc, mesh_of, rectangle

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.polygon.area import polygon_area
from meshonet.solvers.blocking.decomposition.collapse.base_complex import base_complex
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.refinement.refine import multiplied, refine

MESHES = {"rectangle": rectangle, "corner": corner, "annulus": annulus, "disc": disc}


def areas(layout):
    return np.array([polygon_area(quad) for quad in layout.mesh.nodes[layout.mesh.quads]])


@pytest.mark.parametrize("name", MESHES)
def test_all_of_the_domain_without_folds(name):
    layout = base_complex(MESHES[name]()).layout
    chords = Chords.of(layout)
    fine = refine(layout, chords.counts_for_cells(400))
    assert areas(fine).min() > 0
    assert areas(fine).sum() == pytest.approx(layout.mesh.domain.area, rel=5e-3)
    assert fine.cells == pytest.approx(400, rel=0.2)
    wall = fine.mesh.wall_nodes
    np.testing.assert_array_equal(wall, fine.mesh.places.loop >= 0)
    for number, loop in enumerate(layout.mesh.domain.loops):
        on = fine.mesh.places.loop == number
        np.testing.assert_allclose(fine.mesh.nodes[on], loop.at(fine.mesh.places.arc[on]), atol=1e-14)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("times", [2, 3])
def test_families_are_nested(name, times):
    """Every node of a layout is one of the layout with a whole multiple of its cells, bitwise."""
    coarse = base_complex(MESHES[name]()).layout
    fine = multiplied(coarse, times)
    assert fine.cells == times**2 * coarse.cells
    for old, new in zip(coarse.blocks, fine.blocks, strict=True):
        kept = new[::times, ::times]
        np.testing.assert_array_equal(fine.mesh.nodes[kept], coarse.mesh.nodes[old])
        np.testing.assert_array_equal(fine.mesh.places.cells[kept], coarse.mesh.places.cells[old])


@pytest.mark.parametrize("count", [2, 3, 5, 8])
def test_corners_inside_an_edge_are_nodes(count):
    """A roof of two kinks of 30 degrees: no block ends there, but the wall has a node at each."""
    outline = np.array([[0.0, 0], [3, 0], [3, 1], [2, 1.7], [1, 1.7], [0, 1]])
    domain = Domain.of_polygons([outline])
    assert domain.loops[0].corners == (0, 1, 2, 3, 4, 5)
    x = np.linspace(0.0, 3.0, 7)
    top = np.interp(x, outline[:1:-1, 0], outline[:1:-1, 1])
    nodes = np.stack([np.repeat(x[:, None], 3, axis=1), top[:, None] * [0, 0.5, 1]], axis=-1)
    layout = base_complex(mesh_of(domain, [nodes])).layout
    chords = Chords.of(layout)
    least = chords.least
    fine = refine(layout, np.maximum(least, count), chords)
    for point in outline:
        assert (fine.mesh.nodes == point).all(axis=1).any()
    assert np.count_nonzero(fine.mesh.places.cells) == 6
    assert areas(fine).min() > 0


def test_counts_of_a_size():
    """Three squares of side 1 and cells of 0.1: 10 along each edge."""
    chords = Chords.of(base_complex(corner()).layout)
    assert chords.counts_for_size(0.1).tolist() == [10, 10, 10, 10]
    assert chords.cells(chords.counts_for_size(0.1)) == 300


def test_walls_turn_by_at_most_25_degrees_a_cell():
    chords = Chords.of(base_complex(annulus()).layout)
    assert sorted(chords.counts_for_size(10.0).tolist()) == [2, 15]  # 360 / 25 = 14.4


def test_a_block_of_one_cell():
    domain = Domain.of_polygons([np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])])
    layout = base_complex(mesh_of(domain, [box(0, 1, 0, 1, 1, 1)])).layout
    fine = refine(layout, np.array([4, 3]))
    assert sorted(fine.blocks[0].shape) == [4, 5]
    np.testing.assert_allclose(areas(fine), 1 / 12)


def test_one_cell_along_more_than_half_of_a_wall():
    """The upper side of a section with a blunt base is longer than the rest of its outline."""
    base, below, nose = [1.0, 0.01], [1.0, -0.01], [0.0, 0.0]
    section = Loop.of_polygon(
        np.array([base, below, nose, [0.5, 0.3]]), (0, 1, 2), ("base", "lower", "upper")
    )
    right, left, front = [3.0, 2.0], [3.0, -2.0], [-3.0, 0.0]
    domain = Domain((Loop.of_polygon(np.array([right, front, left])), section))
    sides = ([base, right, below, left], [below, left, nose, front], [nose, front, base, right])
    mesh = mesh_of(domain, [np.reshape(side, (2, 2, 2)) for side in sides])
    layout = Layout(mesh, tuple(mesh.quads[:, [0, 3, 1, 2]].reshape(-1, 2, 2)))
    assert {patch.name for patch in to_grid(layout).patches} == {"outer", "base", "lower", "upper"}
    fine = refine(layout, np.full(Chords.of(layout).count, 8))
    assert areas(fine).min() > 0
    on = fine.mesh.places.loop == 1
    assert len(np.unique(fine.mesh.places.arc[on])) == np.count_nonzero(on) == 24
