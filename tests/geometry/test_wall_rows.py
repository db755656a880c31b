"""The cells at a wall, against figures known by hand."""

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.quality.walls import WallRow, wall_rows


def wall_row(grid: Grid, patch: Patch) -> WallRow:
    (row,) = wall_rows(grid, [patch])
    return row


def channel(sheared: float = 0.0) -> Grid:
    """Heights 1, 1, 1.005, 2 from the floor, 2 from the ceiling; steps along x are 3."""
    x, y = np.meshgrid(3.0 * np.arange(6), [0.0, 1.0, 2.0, 3.005, 5.0], indexing="ij")
    return Grid.from_nodes(np.stack([x + sheared * y, y], axis=-1))


@pytest.mark.parametrize(
    ("side", "last", "height", "equal"),
    [("south", 5, 1.0, 3), ("north", 5, 1.995, 1), ("west", 4, 3.0, 5), ("east", 4, 3.0, 5)],
)
def test_every_side_can_be_a_wall(side: str, last: int, height: float, equal: int) -> None:
    row = wall_row(channel(), Patch("wall", side, 0, last))  # type: ignore[arg-type]
    assert (row.name, row.side, row.equal_cells) == ("wall", side, equal)
    assert (row.height.min, row.height.mean, row.height.max) == pytest.approx((height, height, height))
    assert row.off_square.max == pytest.approx(0, abs=1e-12)


def test_angles_of_both_cells_at_a_node_count() -> None:
    row = wall_row(channel(sheared=1.0), Patch("wall", "south", 0, 5))
    assert row.off_square.min == pytest.approx(45)
    assert row.off_square.max == pytest.approx(45)
    assert row.height.mean == pytest.approx(np.sqrt(2))
    turn = np.linspace(0, -2 * np.pi, 9)  # an octagon: its cells have corners of 67.5 and 112.5 degrees
    nodes = np.array([1.0, 2.0])[None, :, None] * np.stack([np.cos(turn), np.sin(turn)], axis=-1)[:, None]
    nodes[-1] = nodes[0]
    ring = wall_row(Grid.from_nodes(nodes, "o"), Patch("wall", "south", 0, 8))
    assert ring.off_square.min == pytest.approx(22.5)
    assert ring.off_square.max == pytest.approx(22.5)


def test_only_the_stretch_counts() -> None:
    nodes = channel().nodes.copy()
    nodes[3, 1, 1] = 0.25
    grid = Grid.from_nodes(nodes)
    assert wall_row(grid, Patch("wall", "south", 0, 2)).height.min == 1.0
    assert wall_row(grid, Patch("wall", "south", 2, 5)).height.min == 0.25
    assert wall_row(grid, Patch("wall", "south", 2, 5)).height.mean == pytest.approx(3.25 / 4)
    assert wall_row(grid, Patch("wall", "south", 2, 5)).equal_cells == 1
