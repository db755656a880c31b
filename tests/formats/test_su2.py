from pathlib import Path

import meshio
import numpy as np
import pytest
from format_shapes import c_grid, channel, ring

from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.su2 import write_grids
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch

MARKERS = {
    "quad": {"no-slip_wall": 3, "south": 3, "out_let": 4, "north": 6, "inlet": 4},
    "o": {"airfoil": 12, "far": 12},
    "c": {"plate": 8, "far_side": 14 + 3 + 3},
}


def markers(path: Path) -> dict[str, int]:
    """Return the count that the file's text gives each marker, once it has as many rows."""
    lines = path.read_text().splitlines()
    at = lines.index(next(line for line in lines if line.startswith("NMARK=")))
    result = {}
    rest = lines[at + 1 :]
    while rest:
        name, count = rest[0].split("MARKER_TAG= ")[1], int(rest[1].split("MARKER_ELEMS= ")[1])
        assert all(row[0].isdigit() for row in rest[2 : 2 + count])
        result[name] = count
        rest = rest[2 + count :]
    assert int(lines[at].split("=")[1]) == len(result)
    return result


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_meshio_reads_the_merged_nodes_bit_for_bit_and_every_cell_positive(
    make: type[Grid], tmp_path: Path
) -> None:
    grid = make()
    write_grids(tmp_path / "g.su2", [grid])
    mesh = meshio.su2.read(tmp_path / "g.su2")
    quads = mesh.cells_dict["quad"]
    nodes = {tuple(node) for node in grid.nodes.reshape(-1, 2).tolist()}
    assert {tuple(point) for point in mesh.points.tolist()} == nodes
    assert len(mesh.points) == len(nodes)
    assert len(quads) == (grid.ni - 1) * (grid.nj - 1)
    x, y = np.moveaxis(mesh.points[quads], -1, 0)
    areas = 0.5 * np.sum(x * np.roll(y, -1, 1) - np.roll(x, -1, 1) * y, axis=1)
    assert areas.min() > 0
    assert len(mesh.cells_dict["line"]) == sum(MARKERS[grid.topology].values())
    assert markers(tmp_path / "g.su2") == MARKERS[grid.topology]


def test_the_lines_of_a_marker_are_edges_of_its_part(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.su2", [ring()])
    mesh = meshio.su2.read(tmp_path / "g.su2")
    radius = np.hypot(*mesh.points[mesh.cells_dict["line"]].T)
    assert np.allclose(radius[:, :12], 1)
    assert np.allclose(radius[:, 12:], 4)


def test_a_layer_has_hexahedra_and_its_planes_as_markers(tmp_path: Path) -> None:
    grid = ring()
    write_grids(tmp_path / "g.su2", [extruded(grid, (0.0, 0.5))])
    mesh = meshio.su2.read(tmp_path / "g.su2")
    assert len(mesh.cells_dict["hexahedron"]) == 48
    assert mesh.points[:, 2].max() == 0.5
    assert len(mesh.points) == 2 * len(unstructured(grid).points)
    assert markers(tmp_path / "g.su2") == {"airfoil": 12, "far": 12, "back": 48, "front": 48}


def test_several_layers_have_their_outermost_planes_as_markers(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.su2", [extruded(ring(), (0.0, 0.5, 1.0, 1.5))])
    mesh = meshio.su2.read(tmp_path / "g.su2")
    hexahedra = mesh.points[mesh.cells_dict["hexahedron"]]
    assert len(hexahedra) == 3 * 48
    assert np.allclose(hexahedra[:, 4:, 2] - hexahedra[:, :4, 2], 0.5)
    assert markers(tmp_path / "g.su2") == {"airfoil": 36, "far": 36, "back": 48, "front": 48}


def test_names_that_no_configuration_could_list_become_different_words(tmp_path: Path) -> None:
    parts = (Patch("a (b)", "south", 0, 12), Patch("a, b", "north", 0, 12))
    write_grids(tmp_path / "g.su2", [Grid.from_nodes(ring().nodes, "o", parts)])
    assert markers(tmp_path / "g.su2") == {"a_b": 12, "a_b-2": 12}
