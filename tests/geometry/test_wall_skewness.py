"""Y+ and skewness of cells at walls, against values by hand."""

import json

import numpy as np
import pytest
from blade_row import blade_row
from space_grids import lattice

import meshonet
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.wall_y_plus import Flow
from meshonet.geometry.quality.walls import skewness_at

REYNOLDS, LENGTH = 2e6, 0.05
FRICTION = (2.0 * np.log10(0.5 * REYNOLDS) - 0.65) ** -2.3
Y_PLUS_PER_HEIGHT = REYNOLDS / LENGTH * np.sqrt(0.5 * FRICTION)
"""Schlichting: the friction at half the length of a plate, and y+ = y u_tau / nu."""


def test_y_plus_is_that_of_a_plate() -> None:
    x, j = np.meshgrid(np.linspace(0.0, 1.0, 6), [0.0, 1.0, 3.0], indexing="ij")
    heights = np.array([1.0, 2.0, 3.0, 10.0, 11.0, 12.0]) * 1e-5
    grid = Grid((Block(np.stack([x, j * heights[:, None]], axis=-1)),), (Patch("wall", "south", 0, 5),))
    row = meshonet.quality(grid, reynolds=REYNOLDS, length=LENGTH).y_plus["wall"]
    expected = Y_PLUS_PER_HEIGHT * np.array([1e-5, 6.5e-5, 12e-5])
    assert [row.min, row.median, row.max] == pytest.approx(expected, rel=1e-12)


def test_each_wall_of_a_row_has_the_y_plus_of_its_first_cell() -> None:
    row = blade_row(tip_gap=0.1)
    grid = meshonet.stack(row, cells=20_000, y_plus=30.0, reynolds=REYNOLDS, growth=1.8)
    report = meshonet.quality(grid, reynolds=REYNOLDS, length=row.chord)
    assert set(report.y_plus) == {"blade", "tip", "hub", "shroud"}
    for name in ("blade", "hub"):
        spread = report.y_plus[name]
        assert [spread.min, spread.median, spread.max] == pytest.approx([30.0] * 3, rel=1e-9)
    walls = {wall["name"]: wall for wall in json.loads(json.dumps(report.as_dict()))["walls"]}
    for name, spread in report.y_plus.items():
        assert walls[name]["y_plus"] == vars(spread)
        per_height = Y_PLUS_PER_HEIGHT * LENGTH / row.chord
        assert walls[name]["first_cell"]["max"] * per_height == pytest.approx(spread.max, rel=1e-12)


def test_skewness_at_a_wall_is_that_of_its_cells_with_the_place() -> None:
    nodes = lattice((0, 4, 5), (0, 3, 4), (0, 2, 3))
    nodes[2, 1, -1, 0] += 0.4  # inside of the top
    nodes[1, 1, 1, 1] += 0.9  # a worse one, in cells of both ends
    walls = tuple(Patch(side, side, 0, 4, (0, 3), kind="wall") for side in ("bottom", "top"))
    grid = Grid((Block(nodes),), walls)
    every = meshonet.quality(grid).wall_skewness
    from meshonet.geometry.quality.measure import per_cell_of_blocks

    (cells,) = per_cell_of_blocks(grid, "skewness")
    for name, k in (("bottom", 0), ("top", 1)):
        assert every[name].max == cells[..., k].max() > 0.2
        assert every[name].mean == pytest.approx(cells[..., k].mean(), rel=1e-14)
        assert cells[every[name].at[1:]] == every[name].max
        assert every[name].at[3] == k
    part = Patch("part", "top", 2, 4, (1, 3), kind="wall")
    one = skewness_at(grid, [part])["part"]
    assert one.max == cells[2:, 1:, 1].max() == cells[one.at[1:]]


@pytest.mark.parametrize(
    ("values", "words"), [((1e2, 1.0), "Reynolds number of 100"), ((1e6, 0.0), "length: a length of 0; use")]
)
def test_a_flow_is_checked(values: tuple[float, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Flow(*values)
