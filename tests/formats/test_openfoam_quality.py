"""Non-orthogonality, skewness and aspect ratio are those that checkMesh prints."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from format_shapes import c_grid, ring

from meshonet.formats.openfoam.write import write_grids
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.find_connections import find_connections
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.shared_nodes import with_equal_nodes
from meshonet.geometry.quality.checkmesh import faces

sys.path.append(str(Path(__file__).parents[1] / "geometry"))
from space_grids import lattice, pipe


def joined(*nodes: Floats) -> Grid:
    blocks = [Block(each) for each in nodes]
    connections = find_connections(blocks)
    return Grid(with_equal_nodes(blocks, connections), (), connections)


def shaken() -> Grid:
    x, y = np.meshgrid(np.arange(9.0), 0.4 * np.arange(7), indexing="ij")
    return Grid.from_nodes(
        np.stack([x, y], axis=-1) + np.random.default_rng(4).uniform(-0.12, 0.12, (9, 7, 2))
    )


def shaken_blocks() -> Grid:
    """Three volumes around an edge, two of them longer than the third."""
    nodes = [
        lattice(x, y, (0, 3, 4))
        for x, y in (((0, 4, 5), (0, 3, 4)), ((4, 9, 5), (0, 3, 4)), ((0, 4, 5), (3, 5, 3)))
    ]
    shift = np.random.default_rng(3).uniform(-0.25, 0.25, (10, 6, 4, 3))
    for block in nodes:
        block += shift[tuple(np.rint(np.moveaxis(block, -1, 0)).astype(int))]
    blocks = [Block(block) for block in nodes]
    return Grid(tuple(blocks), (), find_connections(blocks))


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("name", ["quad", "o", "c", "pipe", "blocks"])
def test_check_mesh_says_the_same(tmp_path: Path, name: str) -> None:
    makes: dict[str, Callable[[], Grid]] = {
        "quad": shaken,
        "o": lambda: ring(33, 17),
        "c": lambda: c_grid(33, 33, 17),
        "pipe": lambda: joined(pipe(5, 13, 4, 0.3)),
        "blocks": shaken_blocks,
    }
    grid = makes[name]()
    write_grids(tmp_path / "case.foam", [extruded(grid, (0.0, 0.1)) if grid.form == "plane" else grid])
    done = subprocess.run(
        ["checkMesh", "-case", str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=60,
        env=os.environ | {"WM_PROJECT_DIR": "/usr/share/openfoam"},
    )

    def theirs(pattern: str) -> float:
        result = re.search(pattern + r" ([-+.\de]+)", done.stdout)
        assert result, done.stdout
        return float(result[1])

    ours = faces(grid)
    assert ours.non_orthogonality is not None
    assert ours.face_skewness is not None
    assert ours.box_ratio is not None
    assert ours.non_orthogonality.max == pytest.approx(theirs("non-orthogonality Max:"), rel=1e-5, abs=1e-5)
    assert ours.non_orthogonality.mean == pytest.approx(theirs("average:"), rel=1e-5, abs=1e-5)
    assert ours.face_skewness.max == pytest.approx(theirs("Max skewness ="), rel=1e-5)
    assert ours.box_ratio.max == pytest.approx(theirs("Max aspect ratio ="), rel=1e-5)
