from __future__ import annotations

from pathlib import Path

import gmsh
import numpy as np
import pytest
from format_shapes import c_grid, channel, ring
from test_gmsh import COUNTS, groups

from meshonet.formats.gmsh.geo import write_grids
from meshonet.geometry.blocks.grid import Grid


@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.usefixtures("silent_gmsh")
def test_gmsh_meshes_it_with_the_same_counts_names_and_outer_nodes(make: type[Grid], tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.geo", [grid])
    gmsh.open(str(tmp_path / "g.geo"))
    gmsh.model.mesh.generate(2)
    nodes, cells, parts = COUNTS[grid.topology]
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    assert len(tags) == nodes
    assert groups(1) == parts
    assert groups(2) == {"fluid": cells}
    quads = gmsh.model.mesh.getElementsByType(3)[0]
    assert len(quads) == cells
    points = coordinates.reshape(-1, 3)[:, :2]
    for edge in (grid.nodes[:, 0], grid.nodes[:, -1], grid.nodes[0], grid.nodes[-1]):
        gap = np.abs(edge[:, None] - points).max(axis=2).min(axis=1)
        assert gap.max() == 0
    if make is not c_grid:  # the middle of its wake is as in the drawing
        assert min(gmsh.model.mesh.getElementQualities(quads, "minSJ")) > 0
