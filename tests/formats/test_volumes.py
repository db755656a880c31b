"""Volumes as the meshes of solvers: closed cells, every face once, names kept, periodic sides coupled."""

from collections.abc import Callable
from pathlib import Path

import meshio
import numpy as np
import pytest
from check_mesh import check_mesh
from volume_grids import VOLUMES, pipe, shifted, turned_sector

from meshonet.formats.mesh.unstructured import Unstructured, unstructured
from meshonet.formats.openfoam.write import write_grids as write_foam
from meshonet.formats.registry import format_named
from meshonet.formats.su2 import write_grids as write_su2
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

Make = Callable[[], Grid]
FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
"""Of a hexahedron as VTK counts its nodes, seen from outside counter-clockwise."""


def volume(points: Floats, cells: np.ndarray) -> Floats:
    """Volume of hexahedra by the divergence theorem."""
    total = np.zeros(len(cells))
    for face in FACES:
        a, b, c, d = (points[cells[:, k]] for k in face)
        total += (np.cross(c - a, d - b) * (a + b + c + d)).sum(axis=1) / 24
    return total


@pytest.mark.parametrize("make", VOLUMES)
def test_nodes_stand_once_and_the_boundary_is_what_one_cell_alone_has(make: Make) -> None:
    grid = make()
    mesh = unstructured(grid)
    assert len(np.unique(mesh.points, axis=0)) == len(mesh.points)
    assert volume(mesh.points, mesh.cells).min() > 0
    sides = np.concatenate([mesh.cells[:, face] for face in FACES])
    every, first, counts = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    assert counts.max() == 2
    outer = {tuple(row) for row in every[counts == 1].tolist()}
    named = np.concatenate(list(mesh.faces.values()))
    assert len(named) == len(outer)
    assert {tuple(sorted(row)) for row in named.tolist()} == outer
    rolled = {tuple(np.roll(row, -int(np.argmin(row))).tolist()) for row in sides[first[counts == 1]]}
    assert {
        tuple(np.roll(row, -int(np.argmin(row))).tolist()) for row in named
    } == rolled  # seen from outside
    assert {patch.name for patch in grid.patches if patch.kind != "interface"} <= set(mesh.faces)


@pytest.mark.parametrize("make", [shifted, turned_sector])
def test_periodic_faces_face_each_other_row_by_row(make: Make) -> None:
    mesh = unstructured(make())
    (pair,) = mesh.periodic
    own, partner = mesh.points[mesh.faces[pair.name]], mesh.points[mesh.faces[pair.partner]]
    np.testing.assert_array_equal(pair.motion(own), partner[:, [0, 3, 2, 1]])
    np.testing.assert_array_equal(pair.motion(mesh.points[pair.nodes[:, 0]]), mesh.points[pair.nodes[:, 1]])


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("words", ["ascii", "binary"])
@pytest.mark.parametrize("make", VOLUMES)
def test_check_mesh_finds_nothing(make: Make, words: str, tmp_path: Path) -> None:
    write_foam(tmp_path / "case.foam", [make()], options=frozenset({words}))
    said = check_mesh(tmp_path, "-allGeometry")
    assert "Mesh OK." in said, said
    assert "Upper triangular ordering OK." in said
    mesh = unstructured(make())
    assert f"cells:            {len(mesh.cells)}\n" in said
    assert f"points:           {len(mesh.points)}\n" in said
    assert f"hexahedra:     {len(mesh.cells)}\n" in said


@pytest.mark.parametrize("make", VOLUMES)
def test_binary_meshes_are_those_of_text(make: Make, tmp_path: Path) -> None:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOGeometry import vtkOpenFOAMReader

    seen = []
    for words in ("ascii", "binary"):
        folder = tmp_path / words
        folder.mkdir()
        write_foam(folder / "case.foam", [make()], options=frozenset({words}))
        reader = vtkOpenFOAMReader()
        reader.SetFileName(str(folder / "case.foam"))
        reader.UpdateInformation()
        reader.EnableAllPatchArrays()
        reader.Update()
        inside = reader.GetOutput().GetBlock(0)
        seen.append(vtk_to_numpy(inside.GetPoints().GetData()))
        assert inside.GetNumberOfCells() == len(unstructured(make()).cells)
    np.testing.assert_array_equal(*seen)


@pytest.mark.parametrize("make", VOLUMES)
def test_su2_has_hexahedra_and_markers_of_quads(make: Make, tmp_path: Path) -> None:
    write_su2(tmp_path / "g.su2", [make()])
    read, mesh = meshio.su2.read(tmp_path / "g.su2"), unstructured(make())
    np.testing.assert_array_equal(read.points, mesh.points)
    np.testing.assert_array_equal(read.cells_dict["hexahedron"], mesh.cells)
    assert len(read.cells_dict["quad"]) == sum(len(faces) for faces in mesh.faces.values())
    text = (tmp_path / "g.su2").read_text()
    assert text.count("MARKER_TAG=") == len(mesh.faces)
    assert ("MARKER_PERIODIC" in text) == bool(mesh.periodic)


def test_su2_couples_periodic_markers_by_centre_angles_and_shift(tmp_path: Path) -> None:
    """The angles are about x, y and z in turn, as SU2 applies them (CGeometry::MatchPeriodic)."""
    write_su2(tmp_path / "g.su2", [turned_sector()])
    line = (tmp_path / "g.su2").read_text().splitlines()[1]
    numbers = np.array([float(word) for word in line.partition("periodic_high,")[2].rstrip(" )").split(",")])
    centre, angles, shift = numbers[:3], np.radians(numbers[3:6]), numbers[6:]
    (c1, c2, c3), (s1, s2, s3) = np.cos(angles), np.sin(angles)
    turn = (
        np.array([[c3, -s3, 0], [s3, c3, 0], [0, 0, 1]])
        @ np.array([[c2, 0, s2], [0, 1, 0], [-s2, 0, c2]])
        @ np.array([[1, 0, 0], [0, c1, -s1], [0, s1, c1]])
    )
    mesh = unstructured(turned_sector())
    own, partner = mesh.points[mesh.periodic[0].nodes.T]
    np.testing.assert_allclose((own - centre) @ turn.T + centre + shift, partner, atol=1e-12)


def same(mesh: Unstructured, points: Floats, cells: np.ndarray) -> None:
    np.testing.assert_array_equal(points, mesh.points)
    np.testing.assert_array_equal(cells, mesh.cells)


@pytest.mark.parametrize("words", ["2.2", "2.2,ascii", "4.1", "4.1,ascii"])
@pytest.mark.parametrize("make", VOLUMES)
@pytest.mark.usefixtures("silent_gmsh")
def test_gmsh_sees_hexahedra_groups_and_partners(make: Make, words: str, tmp_path: Path) -> None:
    import gmsh

    record = format_named(f"gmsh:{words}")
    assert record.write_grids is not None
    record.write_grids(tmp_path / "g.msh", [make()])
    gmsh.open(str(tmp_path / "g.msh"))
    mesh = unstructured(make())
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    order = np.argsort(tags)
    elements, nodes = gmsh.model.mesh.getElementsByType(5)
    same(mesh, coordinates.reshape(-1, 3)[order], nodes.reshape(-1, 8).astype(int) - 1)
    assert min(gmsh.model.mesh.getElementQualities(elements, "minDetJac")) > 0
    sizes = {}
    for dimension, tag in gmsh.model.getPhysicalGroups(2):
        entities = gmsh.model.getEntitiesForPhysicalGroup(dimension, tag)
        sizes[gmsh.model.getPhysicalName(dimension, tag)] = sum(
            len(gmsh.model.mesh.getElements(2, entity)[1][0]) for entity in entities
        )
    assert sizes == {name: len(faces) for name, faces in mesh.faces.items()}
    if mesh.periodic and words.startswith("4.1"):
        partner = list(mesh.faces).index(mesh.periodic[0].partner) + 1
        _, own, theirs, affine = gmsh.model.mesh.getPeriodicNodes(2, partner)
        matrix = np.array(affine).reshape(4, 4)
        moved = mesh.points[theirs.astype(int) - 1] @ matrix[:3, :3].T + matrix[:3, 3]
        np.testing.assert_allclose(moved, mesh.points[own.astype(int) - 1], atol=1e-12)


def test_a_surface_is_a_mesh_of_quads_with_edges(tmp_path: Path) -> None:
    block = pipe().blocks[0]
    surface = Grid((Block(block.face("west")),), (), (), "patch")
    record = format_named("gmsh")
    assert record.write_grids is not None
    record.write_grids(tmp_path / "g.msh", [surface])
    read = meshio.gmsh.read(tmp_path / "g.msh")
    n, m = surface.blocks[0].counts
    assert len(read.cells_dict["quad"]) == (n - 1) * (m - 1)
    np.testing.assert_array_equal(read.points, unstructured(surface).points)


def poles() -> Grid:
    """A ball without its heart: an O grid around an axis, whose two ends are lines."""
    around, down, r = np.meshgrid(
        np.linspace(0, 2 * np.pi, 9), np.linspace(0, np.pi, 7), np.linspace(1, 2, 4), indexing="ij"
    )
    nodes = np.stack(
        [r * np.sin(down) * np.cos(around), r * np.sin(down) * np.sin(around), -r * np.cos(down)], axis=-1
    )
    nodes[-1] = nodes[0]
    nodes[:, 0, :, :2] = nodes[:, -1, :, :2] = 0
    whole = ((0, 6), (0, 3))
    seam = Connection(0, "west", whole, 0, "east", whole, (1, 2))
    patches = (Patch("wall", "bottom", 0, 8), Patch("far", "top", 0, 8))
    return Grid((Block(nodes),), patches, (seam,), "ball")


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("words", ["ascii", "binary"])
def test_cells_at_an_axis_are_prisms(words: str, tmp_path: Path) -> None:
    write_foam(tmp_path / "case.foam", [poles()], options=frozenset({words}))
    said = check_mesh(tmp_path, "-allGeometry")
    assert "prisms:        48\n" in said, said
    assert "hexahedra:     96\n" in said
    assert "***" not in said.replace(" ***High aspect ratio", "")
    assert f"points:           {8 * 5 * 4 + 2 * 4}\n" in said
    assert "south" not in (tmp_path / "constant" / "polyMesh" / "boundary").read_text()


@pytest.mark.parametrize("name", ["su2", "gmsh"])
def test_formats_of_hexahedra_refuse_an_axis_with_its_place(name: str, tmp_path: Path) -> None:
    record = format_named(name)
    assert record.write_grids is not None
    message = (
        "block 0, south, i=0, k=0, x=0, y=0, z=-1: a .* has hexahedra, and an edge along i has no length"
    )
    with pytest.raises(InputError, match=message):
        record.write_grids(tmp_path / "g", [poles()])
