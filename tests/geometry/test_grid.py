"""Where a grid meets itself."""

import numpy as np
import pytest

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.growth import across_wake, beyond_seam
from meshonet.geometry.quality.measure import per_cell


def c_grid(wake: int = 4, around: int = 9, nj: int = 5, growth: float = 1.5) -> Grid:
    """A half disc of radius 1 with a wake behind it, whose cells are thicker above than below."""
    angle = np.linspace(-np.pi / 2, -3 * np.pi / 2, around)
    nose = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    out = np.stack([np.linspace(0, 3, wake + 1)[1:], np.zeros(wake)], axis=-1)
    south = np.concatenate([out[::-1], [[0.0, 0.0]], 0.3 * nose[1:-1], [[0.0, 0.0]], out])
    away = np.concatenate([np.tile([0, -1], (wake + 1, 1)), nose[1:-1], np.tile([0, 1.5], (wake + 1, 1))])
    reach = growth ** np.arange(nj) - 1
    nodes = south[:, None] + reach[None, :, None] * away[:, None]
    return Grid.from_nodes(nodes, "c")


def test_the_wake_is_where_nodes_coincide() -> None:
    assert c_grid(wake=4).wake == 4
    assert c_grid(wake=1).wake == 1
    assert Grid.from_nodes(c_grid().nodes, "quad").wake == 0
    open_everywhere = c_grid().nodes.copy()
    open_everywhere[0, 0, 0] += 1e-12
    with pytest.raises(InputError, match="does not begin and end with the nodes of a wake; make both sides"):
        Grid.from_nodes(open_everywhere, "c")


def test_lines_go_across_the_wake() -> None:
    grid = c_grid()
    lines = across_wake(grid)
    assert lines.shape == (5, 3, 2)
    np.testing.assert_array_equal(lines[:, 1], grid.nodes[:5, 0])
    assert (lines[:, 0, 1] > 0).all()
    assert (lines[:, 2, 1] < 0).all()
    np.testing.assert_array_equal(lines[..., 0], np.tile(lines[:, :1, 0], (1, 3)))
    assert across_wake(Grid.from_nodes(grid.nodes, "quad")).shape == (0, 3, 2)


def test_lines_go_on_beyond_the_seam() -> None:
    turn = np.linspace(0, -2 * np.pi, 9)
    nodes = np.array([1.0, 2.0])[None, :, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)[:, None]
    nodes[-1] = nodes[0]
    assert beyond_seam(Grid.from_nodes(nodes, "o")).shape == (10, 2, 2)
    np.testing.assert_array_equal(beyond_seam(Grid.from_nodes(nodes, "o"))[-1], nodes[1])
    assert beyond_seam(Grid.from_nodes(nodes, "quad")).shape == (9, 2, 2)


def test_area_ratio_looks_across_the_wake() -> None:
    grid = c_grid(growth=1.01)
    ratio = per_cell(grid, "area_ratio")
    np.testing.assert_allclose(ratio[0, 0], 1.5, rtol=0.02)  # half as thick again above as below
    np.testing.assert_allclose(ratio[:3, 0], ratio[-1:-4:-1, 0], rtol=1e-12)
    assert per_cell(Grid.from_nodes(grid.nodes, "quad"), "area_ratio")[0, 0] < 1.1


def test_a_grid_says_what_it_is_in_one_line() -> None:
    x, y = np.meshgrid(np.linspace(0, 2, 5), np.linspace(0, 1, 3), indexing="ij")
    grid = Grid.from_nodes(np.stack([x, y], axis=-1), name="duct")
    assert repr(grid) == "Grid('duct', quad, 5 x 3 nodes, patches ['south', 'east', 'north', 'west'])"


def test_a_grid_of_many_blocks_says_how_many_instead_of_their_sizes_and_each_name_once() -> None:
    x, y = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 3), indexing="ij")
    nodes = [np.stack([x + k, y], axis=-1) for k in range(9)]
    patches = tuple(Patch("wall", "south", 0, 4, block=k) for k in range(9))
    grid = Grid(tuple(map(Block, nodes)), patches, (), "row")
    assert repr(grid) == "Grid('row', blocks, 9 blocks of 135 nodes, patches ['wall'])"


def test_quality_prints_as_a_table_of_metrics() -> None:
    x, y = np.meshgrid(np.linspace(0, 2, 5), np.linspace(0, 1, 3), indexing="ij")
    rows = str(Grid.from_nodes(np.stack([x, y], axis=-1)).quality()).splitlines()
    assert rows[0] == "8 cells, 0 folded"
    assert rows[2].split() == ["max_angle", "90", "90", "90"]
