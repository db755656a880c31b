"""Growth along grid lines, against figures known by hand and plain loops."""

import numpy as np
import pytest
from test_grid import c_grid

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality import growth as steps
from meshonet.geometry.quality.growth import LARGE, growth
from meshonet.geometry.quality.measure import per_cell, per_cell_of_blocks
from meshonet.geometry.quality.report import quality_report


def product(x: list[float], y: list[float]) -> np.ndarray:
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)


def test_a_product_grid_grows_as_its_factors() -> None:
    result = growth(Grid.from_nodes(product([0.0, 1.0, 3.0, 4.0], [0.0, 1.0, 2.0, 5.0, 8.0])))
    assert result.xi is not None
    assert result.eta is not None
    assert (result.xi.max, result.xi.mean, result.xi.at) == (2.0, 2.0, (1, 0))
    assert (result.eta.max, result.eta.mean, result.eta.at) == (3.0, pytest.approx(5 / 3), (0, 2))


def test_the_seam_is_a_place_like_any_other() -> None:
    turn = -2 * np.pi * (np.geomspace(1, 2, 13) - 1)  # the last cell is nearly twice the first
    nodes = np.stack([np.outer(np.cos(turn), [1.0, 2.0]), np.outer(np.sin(turn), [1.0, 2.0])], axis=-1)
    nodes[-1] = nodes[0]
    chord = 2 * np.sin(-np.diff(turn) / 2)
    ring, strip = growth(Grid.from_nodes(nodes, "o")).xi, growth(Grid.from_nodes(nodes, "quad")).xi
    assert ring is not None
    assert strip is not None
    assert ring.max == pytest.approx(chord[-1] / chord[0])
    assert ring.at == (12, 0)
    assert strip.max == pytest.approx((chord[1:] / chord[:-1]).max())


def test_the_wake_is_crossed() -> None:
    grid = c_grid(growth=1.001)
    crossed, cut = growth(grid).eta, growth(Grid.from_nodes(grid.nodes, "quad")).eta
    assert crossed is not None
    assert cut is not None
    assert crossed.max == pytest.approx(1.5)
    assert crossed.at[0] < 5
    assert crossed.at[1] == 0
    assert cut.max == pytest.approx(1.001)


def test_blocks_do_not_show(monkeypatch: pytest.MonkeyPatch) -> None:
    nodes = product(list(range(40)), list(range(9))) + np.random.default_rng(2).uniform(-0.3, 0.3, (40, 9, 2))
    whole = growth(Grid.from_nodes(nodes))
    monkeypatch.setattr(steps, "ROWS", 7)
    parts = growth(Grid.from_nodes(nodes))
    for one, other in ((whole.xi, parts.xi), (whole.eta, parts.eta)):
        assert one is not None
        assert other is not None
        assert (one.max, one.at) == (other.max, other.at)
        assert one.mean == pytest.approx(other.mean, rel=1e-13)
    lengths = np.linalg.norm(np.diff(nodes, axis=0), axis=-1)
    ratios = lengths[1:] / lengths[:-1]
    assert whole.xi is not None
    assert whole.xi.max == pytest.approx(np.maximum(ratios, 1 / ratios).max(), rel=1e-13)


def test_steps_of_no_length_are_large_and_single_steps_have_no_growth() -> None:
    result = growth(Grid.from_nodes(product([0.0, 1.0], [0.0, 0.0, 1.0])))
    assert result.xi is None
    assert result.eta is not None
    assert result.eta.max == LARGE


def joined(*nodes: np.ndarray) -> Grid:
    blocks = tuple(map(Block, nodes))
    return Grid(blocks, (), find_connections(blocks))


def ring(blocks: int) -> Grid:
    """Return an O grid, or the same of two blocks, whose cells at the seams grow by much."""
    turn = -2 * np.pi * (np.geomspace(1, 2, 17) - 1)
    radii = [1.0, 1.1, 1.3, 2.0]
    nodes = np.stack([np.outer(np.cos(turn), radii), np.outer(np.sin(turn), radii)], axis=-1)
    nodes[-1] = nodes[0]
    if blocks == 1:
        return Grid.from_nodes(nodes, "o")
    return joined(nodes[:9], nodes[8:])


def wedge() -> Grid:
    """Return a sector about an axis, at which lines shrink to points."""
    radius, turn = np.meshgrid([0.0, 1.0, 3.0], [0.0, 0.1, 0.2, 0.3], indexing="ij")
    section = np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1)
    x = np.broadcast_to(np.array([0.0, 1.0, 2.5])[:, None, None, None], (3, 3, 4, 1))
    return Grid((Block(np.concatenate([x, np.broadcast_to(section, (3, 3, 4, 2))], axis=-1)),))


def volume() -> Grid:
    nodes = np.stack(np.meshgrid([0, 1, 2.5, 4], [0, 1, 2, 4.0], [0, 1, 1.2, 2], indexing="ij"), axis=-1)
    return joined(nodes[:3], nodes[2:])


@pytest.mark.parametrize("grid", [ring(1), ring(2), c_grid(growth=1.001), volume(), wedge()])
def test_the_growth_at_cells_has_the_greatest_growth_of_the_report(grid: Grid) -> None:
    report = quality_report(grid).figures.growth
    cells = per_cell_of_blocks(grid, "growth")
    assert [values.shape for values in cells] == [tuple(n - 1 for n in b.counts) for b in grid.blocks]
    greatest = max(extreme.max for extreme in report.families().values())
    assert max(values.max() for values in cells) == pytest.approx(greatest, rel=1e-6)
    assert min(values.min() for values in cells) >= 1.0


def test_a_cell_has_the_growth_at_its_own_nodes() -> None:
    grid = Grid.from_nodes(product([0.0, 1.0, 3.0, 5.0, 7.0], [0.0, 1.0, 2.0]))
    np.testing.assert_allclose(per_cell(grid, "growth"), [[2.0] * 2, [2.0] * 2, [1.0] * 2, [1.0] * 2])
