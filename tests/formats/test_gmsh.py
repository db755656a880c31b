from pathlib import Path

import gmsh
import meshio
import numpy as np
import pytest
from format_shapes import c_grid, channel, ring

from meshonet.formats.gmsh.geo import write_grids as write_geo
from meshonet.formats.gmsh.msh import write_grids
from meshonet.formats.registry import format_named
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch


def groups(dimension: int) -> dict[str, int]:
    """Return the elements in each physical group of the open mesh."""
    result = {}
    for _, tag in gmsh.model.getPhysicalGroups(dimension):
        entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        elements = [gmsh.model.mesh.getElements(dimension, entity)[1] for entity in entities]
        result[gmsh.model.getPhysicalName(dimension, tag)] = sum(len(e) for block in elements for e in block)
    return result


COUNTS = {
    "quad": (35, 24, {"inlet": 4, "no-slip wall": 3, "south": 3, "out let": 4, "north": 6}),
    "o": (60, 48, {"airfoil": 12, "far": 12}),
    "c": (56, 42, {"plate": 8, "far side": 14 + 3 + 3}),
}


VERSIONS = pytest.mark.parametrize("version", ["gmsh", "gmsh-ascii", "gmsh41", "gmsh41-ascii"])


@VERSIONS
@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.usefixtures("silent_gmsh")
def test_gmsh_sees_cells_and_named_boundaries(make: type[Grid], version: str, tmp_path: Path) -> None:
    grid = make()
    writer = format_named(version).write_grids
    assert writer is not None
    writer(tmp_path / "g.msh", [grid])
    gmsh.open(str(tmp_path / "g.msh"))
    nodes, cells, parts = COUNTS[grid.topology]
    assert len(gmsh.model.mesh.getNodes()[0]) == nodes
    assert groups(1) == parts
    assert groups(2) == {"fluid": cells}
    quads = gmsh.model.mesh.getElementsByType(3)[0]
    assert min(gmsh.model.mesh.getElementQualities(quads, "minDetJac")) > 0
    points = gmsh.model.mesh.getNodes()[1].reshape(-1, 3)
    assert np.array_equal(np.unique(points[:, 0]), np.unique(grid.x))


@VERSIONS
@pytest.mark.parametrize(("make", "layers"), [(channel, 3), (ring, 1), (c_grid, 1)])
@pytest.mark.usefixtures("silent_gmsh")
def test_gmsh_sees_layers_of_right_handed_hexahedra(
    make: type[Grid], layers: int, version: str, tmp_path: Path
) -> None:
    grid = make()
    writer = format_named(version).write_grids
    assert writer is not None
    writer(tmp_path / "g.msh", [extruded(grid, [0.5 * k for k in range(layers + 1)])])
    gmsh.open(str(tmp_path / "g.msh"))
    nodes, cells, parts = COUNTS[grid.topology]
    assert len(gmsh.model.mesh.getNodes()[0]) == (layers + 1) * nodes
    beside = {name: layers * count for name, count in parts.items()}
    assert groups(2) == {**beside, "back": cells, "front": cells}
    assert groups(3) == {"fluid": layers * cells}
    hexahedra = gmsh.model.mesh.getElementsByType(5)[0]
    assert min(gmsh.model.mesh.getElementQualities(hexahedra, "minDetJac")) > 0
    faces = gmsh.model.mesh.getElementsByType(3)[1].reshape(-1, 4)
    assert len(np.unique(np.sort(faces, axis=1), axis=0)) == len(faces)


@VERSIONS
def test_meshio_reads_the_names_back(version: str, tmp_path: Path) -> None:
    writer = format_named(version).write_grids
    assert writer is not None
    writer(tmp_path / "g.msh", [ring()])
    mesh = meshio.gmsh.read(tmp_path / "g.msh")
    assert {name: message.tolist() for name, message in mesh.field_data.items()} == {
        "airfoil": [1, 1], "far": [2, 1], "fluid": [3, 2],
    }  # fmt: skip


@pytest.mark.usefixtures("silent_gmsh")
def test_a_part_may_be_called_as_the_cells_or_hold_quotes(tmp_path: Path) -> None:
    parts = (Patch("fluid", "south", 0, 12), Patch('a "b"', "north", 0, 12))
    write_grids(tmp_path / "g.msh", [Grid.from_nodes(ring().nodes, "o", parts)])
    gmsh.open(str(tmp_path / "g.msh"))
    assert groups(1) == {"fluid": 12, "a 'b'": 12}
    assert groups(2) == {"fluid-cells": 48}


@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.usefixtures("silent_gmsh")
def test_a_geo_file_is_meshed_with_the_same_counts_names_and_outer_nodes(
    make: type[Grid], tmp_path: Path
) -> None:
    grid = make()
    write_geo(tmp_path / "g.geo", [grid])
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
