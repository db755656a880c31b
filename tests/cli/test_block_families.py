"""Families of grids of many blocks: one is made, every second, fourth and eighth node makes the others."""

import json
from pathlib import Path

import numpy as np
import pytest
from block_files import cells, first_cells, grid_of
from command_line import Meshonet
from domains import circle

from meshonet.formats.registry import read_grids
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
    report = meshonet(command, "plate.wkt", "--cells", 300, "--refine", 3, "--json", "-o", "0.h5").only
    family_is_nested(meshonet)
    assert report["folded"] == 0
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


def test_variants_fit_one_dataset_with_a_layout_and_counts(meshonet: Meshonet) -> None:
    outer = [[-2, -1], [4, -1], [4, 1], [-2, 1], [-2, -1]]
    sides = [["floor", "outlet", "roof", "inlet"], "body"]
    for number, thickness in enumerate((0.2, 0.35, 0.45)):
        body = (circle(0, 0, 1) * (0.5, thickness)).tolist()
        domain = {"type": "Polygon", "coordinates": [outer, [*body, body[0]]]}
        feature = {"type": "Feature", "properties": {"names": sides}, "geometry": domain}
        Path(f"{number}.geojson").write_text(json.dumps(feature))
    variants = ["0.geojson", "1.geojson", "2.geojson"]
    done = meshonet("solve-pde", *variants, "--cells", 1500, "-o", "all.h5")
    assert done.code == 2
    remedy = "try one --layout with the --count of every side, or write one file each: -o '{stem}.h5'"
    assert done.err.count(remedy) == 2
    assert meshonet("layout", variants[0], "-o", "layout.json").code == 0
    counts = ("--count", "body=48,inlet=24,outlet=24,floor=60,roof=60")
    done = meshonet("solve-pde", *variants, "--layout", "layout.json", *counts, "-o", "all.h5")
    assert done.code == 0, done.err
    assert len(list(read_grids("all.h5"))) == 3
    assert meshonet("solve-pde", *variants, "--cells", 1500, "-o", "{stem}.h5").code == 0
