"""Families of grids of many blocks: one is made, every second, fourth and eighth node makes the others."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from block_files import cells, first_cells, grid_of
from command_line import Meshonet
from domains import circle

from meshonet.geometry.quality.measure import count_folded

PLATE = "POLYGON ((0 0, 2 0, 4 0.3, 4 2, 0 2, 0 0), (1 0.7, 1 1.2, 1.5 1.2, 1.5 0.7, 1 0.7))"
FIRST = 1e-4


@pytest.fixture
def inputs() -> None:
    Path("plate.wkt").write_text(PLATE)
    rod = "".join(f"{x!r},{y!r}\n" for x, y in circle(1.5, -0.1, 0.1, 90).tolist())
    Path("rod.csv").write_text(rod)


@pytest.mark.parametrize("command", ["solve-pde", "infer"])
def test_four_levels_of_blocks_are_nested_and_valid(meshonet: Meshonet, inputs: None, command: str) -> None:
    told = meshonet(command, "plate.wkt", "--cells", 300, "--refine", 3, "--json", "-o", "0.h5").only
    family_is_nested(meshonet)
    assert told["folded"] == 0
    assert cells(grid_of("3.h5")) == pytest.approx(300, rel=0.25)


def test_four_levels_of_two_bodies_with_layers_are_nested_and_valid(meshonet: Meshonet, inputs: None) -> None:
    bodies = ("naca:0012", "rod.csv", "--assemble", "--far-field", 20, "--first-cell", FIRST)
    done = meshonet("solve-pde", *bodies, "--cells", 1500, "--refine", 3, "-o", "0.h5")
    assert done.code == 0, done.err
    family_is_nested(meshonet)
    np.testing.assert_allclose(first_cells(grid_of("0.h5")), FIRST, rtol=1e-6)
    assert cells(grid_of("3.h5")) == pytest.approx(1500, rel=0.25)


def family_is_nested(meshonet: Meshonet) -> None:
    finest = grid_of("0.h5")
    for level in range(4):
        if level:
            assert meshonet("convert", "0.h5", f"{level}.h5", "--coarsen", 2**level).code == 0
        grid, times = grid_of(f"{level}.h5"), 2**level
        assert len(grid.connections) == len(finest.connections)
        for coarse, fine in zip(grid.blocks, finest.blocks, strict=True):
            np.testing.assert_array_equal(coarse.nodes, fine.nodes[::times, ::times])
            assert count_folded(coarse.nodes) == 0


def test_more_levels_than_a_grid_can_have_are_refused(meshonet: Meshonet, inputs: None) -> None:
    done = meshonet("solve-pde", "plate.wkt", "--cells", 100_000, "--refine", 5, "-o", "g.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "100000 cells halved 5 times are 1.02e+08; use fewer: 20000000 are the most" in done.err
