"""Cells along lines that leave walls, and across sides of blocks, grow by no more than the limit."""

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.layers.growth_lines import GrowthLines
from meshonet.solvers.blocking.layers.layered import layered
from meshonet.solvers.blocking.layers.stretches import layered_walls
from meshonet.solvers.blocking.make import make_blocks
from meshonet.solvers.blocking.request import BlockRequest
from meshonet.solvers.layers.layer_settings import LayerSettings


def circle(x, y, radius, name, way):
    turn = way * 2.0 * np.pi * np.arange(96) / 96
    places = np.stack([x + radius * np.cos(turn), y + radius * np.sin(turn)], axis=1)
    return Loop(Curve(places, closed=True, corners=()), (), (name,))


TUNNEL = np.array([[0.0, 0.0], [2.2, 0.0], [2.2, 0.41], [0.0, 0.41]])
CHANNEL = Loop.of_polygon(TUNNEL, None, ("floor", "outlet", "roof", "inlet"))
CYLINDER = circle(0.2, 0.2, 0.05, "cylinder", -1)
DOMAINS = {
    "cylinder in a channel": (Domain((CHANNEL, CYLINDER)), ("cylinder",)),
    "channel with layers at all walls": (Domain((CHANNEL, CYLINDER)), ("floor", "roof", "cylinder")),
    "disc": (Domain((circle(0.0, 0.0, 1.0, "rim", 1),)), ("rim",)),
}


@pytest.mark.parametrize(("limit", "name"), [(1.2, name) for name in DOMAINS] + [(1.3, "disc")])
def test_cells_of_a_grid_grow_by_no_more_than_the_limit_that_is_asked_for(limit, name):
    domain, walls = DOMAINS[name]
    loops, stretches = layered_walls(domain, walls)
    layout = layered(domain, loops, LayerSettings.limited(1e-3, limit), stretches=stretches, cells=12000)
    lines = block_figures(to_grid(layout, walls=walls)).lines
    assert 1.0 < lines.leaving.max <= limit
    assert lines.growth_across.max <= limit


STEP = np.array([[0.0, 1.0], [4.0, 1.0], [4.0, 0.0], [14.0, 0.0], [14.0, 2.0], [0.0, 2.0]])
SIDES = {"south": (0, 1, 1), "north": (-1, -2, 1), "west": (0, 1, 0), "east": (-1, -2, 0)}


@pytest.mark.parametrize("constant", [1, 2])
def test_nodes_on_walls_move_with_first_cells_above_them_where_cells_along_walls_grow_too_fast(constant):
    names = ("wall", "wall", "wall", "outlet", "wall", "inlet")
    domain = Domain((Loop.of_polygon(STEP, None, names),))
    loops, stretches = layered_walls(domain, ("wall",))
    settings = LayerSettings.limited(1e-3, 1.2, constant=constant)
    grid = to_grid(layered(domain, loops, settings, stretches=stretches, cells=12000), walls=("wall",))
    for growth in block_figures(grid).lines.growth.families().values():
        assert growth.max < 1.25
    for patch in grid.patches:
        if patch.name == "wall":
            wall, above, axis = SIDES[patch.side]
            nodes = np.moveaxis(grid.blocks[patch.block].nodes, axis, 0)
            np.testing.assert_allclose(np.hypot(*(nodes[above] - nodes[wall]).T)[1:-1], 1e-3, rtol=1e-6)


@pytest.fixture
def annulus():
    """A ring of two blocks with 8 cells around, 3 across, and a wall inside."""
    turn, radius = 2.0 * np.pi * np.arange(8) / 8, np.arange(1.0, 5.0)
    z = np.exp(1j * turn)[:, None] * radius
    table = np.arange(32).reshape(8, 4)
    blocks = table[:5], np.concatenate([table[4:], table[:1]])
    places = Places.inside(32)
    loops = circle(0.0, 0.0, 4.0, "far", 1), circle(0.0, 0.0, 1.0, "body", -1)
    for number, side, way in ((0, table[:, -1], 1), (1, table[:, 0], -1)):
        places.loop[side] = number
        places.arc[side] = np.mod(way * turn, 2.0 * np.pi) / (2.0 * np.pi) * loops[number].length
    nodes = np.stack([z.real, z.imag], axis=2).reshape(-1, 2)
    return Layout(QuadMesh(Domain(loops), nodes, lattice_quads(blocks), places), blocks)


def test_lines_from_walls_and_across_sides_of_blocks_have_the_strict_limit(annulus):
    walls = annulus.mesh.places.loop == 1
    lines = GrowthLines.from_walls(annulus, walls, 1.0, 2.0)
    column, around = np.divmod(lines.nodes, 4)[0][:, 1], np.ptp(lines.nodes % 4, axis=1) == 0
    assert (lines.limit[~around] == 1.0).all()  # away from the wall
    assert (lines.limit[around] == 2.0).all()  # along it, in the blocks beside it
    none = GrowthLines.from_walls(annulus, walls & False, 1.0, 2.0)
    np.testing.assert_array_equal(none.limit == 1.0, around & (column % 4 == 0))


def test_ratios_are_compared_as_they_will_be_after_edges_have_grown_by_factors(annulus):
    mesh, z = annulus.mesh, annulus.mesh.nodes @ [1.0, 1j]
    factors = np.where(mesh.wall_nodes[mesh.edges].any(axis=1), 2.0, 1.0)
    plain, grown = (GrowthLines.of(mesh, 1.0, each).growth(z) for each in (None, factors))
    change = np.unique(np.round(np.abs(grown - plain), 12))
    np.testing.assert_allclose(change, [0.0, np.log(2.0)], atol=1e-11)


def rounded_square(half: float, radius: float) -> Domain:
    """A square with arcs of the given radius at its corners."""
    turn = 0.5 * np.pi * (np.linspace(0.0, 1.0, 25) + np.arange(4.0)[:, None])
    centres = (half - radius) * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    arcs = centres[:, None] + radius * np.stack([np.cos(turn), np.sin(turn)], axis=-1)
    return Domain.of_polygons([arcs.reshape(-1, 2)], names=[("wall",)])


@pytest.mark.parametrize(("cells", "mean"), [(1500, 95.5), (3000, 92.5)])
def test_few_cells_inside_a_rounded_square_do_not_kink_where_the_layers_end(cells: int, mean: float) -> None:
    request = BlockRequest(cells=cells, first_cell=0.08, walls=("wall",))
    made = make_blocks(DomainShape(rounded_square(20.0, 8.0)), request)
    angle = measure(made.grid)["max_angle"]
    assert angle.mean < mean
    assert angle.max < 124.0


def test_more_cells_than_asked_are_told_with_what_makes_them_fewer() -> None:
    request = BlockRequest(cells=1500, first_cell=0.005, walls=("wall",))
    made = make_blocks(DomainShape(rounded_square(1.0, 0.1)), request)
    cells = sum(block.cells for block in made.grid.blocks)
    assert cells > 1800
    remedy = "a higher {first_cell} or {growth} needs fewer rows of them"
    assert f"{cells} cells instead of 1500: {remedy}" in made.notes
