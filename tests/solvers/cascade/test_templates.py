"""Every template makes valid grids of cascades and blade rows; the next one is tried where one fails."""

import blade_row
import numpy as np
import pytest
from test_passage import blade, periodic_nodes

from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.quality.measure import count_folded
from meshonet.solvers.cascade import templates
from meshonet.solvers.cascade.cascade import Cascade
from meshonet.solvers.cascade.cascade_layout import cascade_layout
from meshonet.solvers.cascade.passage import BLADE
from meshonet.solvers.cascade.templates import TEMPLATES, around_blade
from meshonet.solvers.layers.layer_settings import LayerSettings
from meshonet.solvers.pipeline.rows import make_row
from meshonet.solvers.rows import middle_section
from meshonet.solvers.rows.request import RowRequest

every_template = pytest.mark.parametrize("template", TEMPLATES, ids=lambda each: each.__module__)


def with_layers(stagger: float, camber: float = 0.08) -> Cascade:
    return Cascade(blade(stagger, camber), (0.0, 0.9), settings=LayerSettings(1e-4))


@pytest.fixture
def only(monkeypatch):
    """Sets the templates that are tried."""

    def set_templates(*chosen):
        for module in (templates, middle_section):
            monkeypatch.setattr(module, "TEMPLATES", chosen)

    return set_templates


@every_template
@pytest.mark.parametrize("stagger", [-50.0, 0.0, 50.0])
def test_four_blocks_surround_the_blade_from_its_upper_side_to_its_leading_edge(template, stagger):
    passage = with_layers(stagger, camber=0.0).passage
    layout = template(passage, at_corners=True)
    nodes, places = layout.mesh.nodes, layout.mesh.places
    around = around_blade(layout, places.loop == BLADE)
    assert len(around) == 4
    upper, trailing, lower, leading = (nodes[layout.blocks[k][:, 0]].mean(axis=0) for k in around)
    stream = np.array([np.cos(np.radians(stagger)), np.sin(np.radians(stagger))])
    across = np.array([-stream[1], stream[0]])
    assert (upper - lower) @ across > 0.0
    assert (trailing - leading) @ stream > 0.5
    np.testing.assert_array_equal(layout.blocks[around[0]][-1, 0], layout.blocks[around[1]][0, 0])


@every_template
@pytest.mark.parametrize("stagger", [-60.0, 0.0, 60.0])
@pytest.mark.parametrize("camber", [0.0, 0.08])
def test_a_cascade_is_valid_and_periodic(template, stagger, camber, only):
    only(template)
    grid = to_grid(cascade_layout(with_layers(stagger, camber), cells=4000))
    assert sum(count_folded(block.nodes) for block in grid.blocks) == 0
    sides = periodic_nodes(grid)
    np.testing.assert_array_equal(sides["periodic1"] + np.array([0.0, 0.9]), sides["periodic2"])


@every_template
def test_a_blade_row_is_valid(template, only):
    only(template)
    request = RowRequest(threads=1, cells=20_000, first_cell=0.01, growth=1.8)
    assert make_row(blade_row.blade_row(0.05), request).grid.quality().folded == 0


def test_the_next_template_is_tried_where_one_folds_cells(only):
    def folding(passage, *, at_corners):
        raise NoValidGridError("cells of the passage stay folded")

    expected = cascade_layout(with_layers(30.0), cells=1500).mesh.nodes
    only(folding, TEMPLATES[0])
    np.testing.assert_array_equal(cascade_layout(with_layers(30.0), cells=1500).mesh.nodes, expected)
    request = RowRequest(threads=1, cells=20_000, first_cell=0.01, growth=1.8)
    assert make_row(blade_row.blade_row(), request).grid.quality().folded == 0
    only(folding)
    with pytest.raises(NoValidGridError, match="stay folded"):
        cascade_layout(with_layers(30.0), cells=1500)
