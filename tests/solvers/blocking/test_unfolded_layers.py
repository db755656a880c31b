"""Cells that are folded beside or in layers: they are unfolded, and the layers keep their heights."""

import numpy as np
import pytest
from known_meshes import mesh_of

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.lattice import smallest_jacobians
from meshonet.geometry.layout.layout import Layout
from meshonet.solvers.blocking.layers.finished import finished
from meshonet.solvers.layers.layer_settings import LayerSettings

GROWTH, ROWS = 1.2, 20


@pytest.fixture
def layers():
    """A square of 12 by 20 cells whose heights grow by 1.2 from the south."""
    heights = GROWTH ** np.arange(ROWS)
    y = np.concatenate([[0.0], np.cumsum(heights) / heights.sum()])
    lattice = np.stack(np.meshgrid(np.linspace(0.0, 1.0, 13), y, indexing="ij"), axis=2)
    domain = Domain((Loop.of_polygon(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])),))
    mesh = mesh_of(domain, [lattice])
    order = np.lexsort((mesh.nodes[:, 1].round(9), mesh.nodes[:, 0].round(9)))
    return Layout(mesh, (order.reshape(13, ROWS + 1),))


@pytest.mark.parametrize("row", [4, 8, 12])
def test_layers_around_a_fold_keep_their_heights(layers, row):
    mesh, block = layers.mesh, layers.blocks[0]
    heights = np.diff(mesh.nodes[block][:, :, 1], axis=1)
    nodes = mesh.nodes.copy()
    nodes[block[6, row], 1] += 1.5 * heights[6, row]
    folded = Layout(mesh.with_nodes(nodes), layers.blocks)
    assert smallest_jacobians(nodes, mesh.quads).min() < 0.0
    held = np.zeros(len(nodes), dtype=bool)
    held[block[:, :2]] = True
    made = finished(folded, LayerSettings(heights[0, 0], GROWTH), held)
    assert smallest_jacobians(made.mesh.nodes, mesh.quads).min() > 0.0
    new = np.diff(made.mesh.nodes[block][:, :, 1], axis=1)
    assert np.exp(np.abs(np.diff(np.log(new), axis=1)).max()) < 1.4
    assert np.abs(np.log(new / heights)).max() < np.log(1.5)
