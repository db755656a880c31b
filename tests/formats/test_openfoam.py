import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from check_mesh import check_mesh
from format_shapes import c_grid, channel, file_names, ring
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOGeometry import vtkOpenFOAMReader

import meshonet
from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.openfoam.write import write_grids
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.revolve import Revolution, revolved
from meshonet.geometry.errors import InputError

MAKES = [channel, ring, c_grid]
PATCHES = {
    "quad": {
        "no-slip_wall": ("wall", 3), "south": ("patch", 3), "out_let": ("patch", 4),
        "north": ("patch", 6), "inlet": ("patch", 4), "frontAndBack": ("empty", 48),
    },
    "o": {"airfoil": ("wall", 12), "far": ("patch", 12), "frontAndBack": ("empty", 96)},
    "c": {"plate": ("wall", 8), "far_side": ("patch", 20), "frontAndBack": ("empty", 84)},
}  # fmt: skip


def numbers(path: Path) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Return the rows of a list, once there are as many as it says."""
    result = re.fullmatch(r"FoamFile\n\{.*?\}\s+(\d+)\n\(\n(.*)\)\n", path.read_text(), re.S)
    assert result is not None
    count, body = result.groups()
    rows = [re.sub(r"4?\(|\)", " ", line).split() for line in body.splitlines()]
    assert len(rows) == int(count)
    return np.array(rows, float)


def patches(mesh: Path) -> dict[str, tuple[str, int, int]]:
    """Return type, count and first face of each patch."""
    text = (mesh / "boundary").read_text()
    form = r"    (\S+)\n    \{\s+type\s+(\w+);\s+nFaces\s+(\d+);\s+startFace\s+(\d+);"
    return {name: (kind, int(n), int(start)) for name, kind, n, start in re.findall(form, text)}


@pytest.mark.parametrize("layers", [1, 3])
@pytest.mark.parametrize("make", MAKES)
def test_cells_are_closed_and_faces_point_out_of_owners_in_order(
    make: type[Grid], layers: int, tmp_path: Path
) -> None:
    grid = make()
    write_grids(tmp_path / "case.foam", [extruded(grid, [0.5 * k for k in range(layers + 1)])])
    mesh = tmp_path / "constant" / "polyMesh"
    points, faces = numbers(mesh / "points"), numbers(mesh / "faces").astype(int)
    owner = numbers(mesh / "owner").astype(int).ravel()
    neighbour = numbers(mesh / "neighbour").astype(int).ravel()
    inner, cells = len(neighbour), layers * (grid.ni - 1) * (grid.nj - 1)
    assert (owner[:inner] < neighbour).all()
    order = list(zip(owner[:inner].tolist(), neighbour.tolist(), strict=True))
    assert order == sorted(set(order))
    assert owner.max() == cells - 1
    corner = points[faces]
    area = 0.5 * np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    centre = corner.mean(axis=1)
    closed, volume = np.zeros((cells, 3)), np.zeros(cells)
    for cell, sign, part in ((owner, 1, slice(None)), (neighbour, -1, slice(inner))):
        np.add.at(closed, cell, sign * area[part])
        np.add.at(volume, cell, sign * (area[part] * centre[part]).sum(axis=1) / 3)
    assert np.abs(closed).max() < 1e-14
    mesh2d = unstructured(grid)
    x, y = np.moveaxis(mesh2d.points[mesh2d.cells], -1, 0)
    plane = 0.5 * ((x[:, 2] - x[:, 0]) * (y[:, 3] - y[:, 1]) - (x[:, 3] - x[:, 1]) * (y[:, 2] - y[:, 0]))
    assert np.allclose(volume, np.tile(0.5 * plane, layers), rtol=1e-12)
    assert volume.min() > 0
    middle = np.zeros((cells, 3))
    np.add.at(middle, owner, centre / 6)
    np.add.at(middle, neighbour, centre[:inner] / 6)
    assert ((middle[neighbour] - middle[owner[:inner]]) * area[:inner]).sum(axis=1).min() > 0


@pytest.mark.parametrize("make", MAKES)
def test_patches_are_named_typed_and_cover_the_outer_faces(make: type[Grid], tmp_path: Path) -> None:
    write_grids(tmp_path / "case.foam", [make()])
    mesh = tmp_path / "constant" / "polyMesh"
    result = patches(mesh)
    assert {name: message[:2] for name, message in result.items()} == PATCHES[make().topology]
    at = len(numbers(mesh / "neighbour"))
    for _, count, start in result.values():
        assert start == at
        at += count
    assert at == len(numbers(mesh / "faces"))


@pytest.mark.parametrize("make", MAKES)
def test_vtk_opens_the_case(make: type[Grid], tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "case.foam", [extruded(grid, (0.0, 0.5))])
    reader = vtkOpenFOAMReader()
    reader.SetFileName(str(tmp_path / "case.foam"))
    reader.UpdateInformation()
    reader.EnableAllPatchArrays()
    reader.Update()
    inside = reader.GetOutput().GetBlock(0)
    assert inside.GetNumberOfCells() == (grid.ni - 1) * (grid.nj - 1)
    points = vtk_to_numpy(inside.GetPoints().GetData())
    assert len(points) == 2 * len(unstructured(grid).points)
    assert points[:, 2].max() == 0.5
    names = {reader.GetPatchArrayName(k) for k in range(reader.GetNumberOfPatchArrays())}
    assert {f"patch/{name}" for name in PATCHES[grid.topology]} <= names


def test_the_planes_of_several_layers_are_symmetry_planes(tmp_path: Path) -> None:
    parts = (Patch("front", "south", 0, 12), Patch("far", "north", 0, 12))
    write_grids(
        tmp_path / "case.foam", [extruded(Grid.from_nodes(ring().nodes, "o", parts), (0.0, 1.0, 2.0))]
    )
    result = patches(tmp_path / "constant" / "polyMesh")
    assert {name: message[:2] for name, message in result.items()} == {
        "front-2": ("wall", 24), "far": ("patch", 24),
        "back": ("symmetryPlane", 48), "front": ("symmetryPlane", 48),
    }  # fmt: skip


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("heights", [(0.0, 0.5), (0.0, 0.25, 0.5)])
@pytest.mark.parametrize("make", MAKES)
def test_check_mesh_finds_nothing(make: type[Grid], heights: tuple[float, ...], tmp_path: Path) -> None:
    grid = make(33, 17) if make is not c_grid else make(33, 33, 17)  # type: ignore[call-arg]
    write_grids(tmp_path / "case.foam", [extruded(grid, heights)])
    said = check_mesh(tmp_path)
    assert "Upper triangular ordering OK." in said
    faults = [line for line in said.splitlines() if "***" in line]
    if make is c_grid:  # its faces are skewed where the wake leaves the blunt plate, as drawn
        faults = [line for line in faults if "skewness" not in line]
    assert faults == []


def test_the_rest_of_a_case_is_left_alone(tmp_path: Path) -> None:
    for name in ("0/U", "system/controlDict", "constant/transportProperties", "constant/polyMesh/old"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("mine")
    write_grids(tmp_path / "case.foam", [ring()])
    for name in ("0/U", "system/controlDict", "constant/transportProperties"):
        assert (tmp_path / name).read_text() == "mine"
    assert file_names(tmp_path) == ["0", "case.foam", "constant", "system"]
    assert file_names(tmp_path / "constant") == ["polyMesh", "transportProperties"]
    assert file_names(tmp_path / "constant" / "polyMesh") == [
        "boundary", "faces", "neighbour", "owner", "points",
    ]  # fmt: skip
    assert file_names(tmp_path / "system") == ["controlDict", "fvSchemes", "fvSolution"]


def test_names_that_no_dictionary_could_hold_become_words(tmp_path: Path) -> None:
    parts = (Patch("0012 {a;}", "south", 0, 12), Patch("frontAndBack", "north", 0, 12))
    write_grids(tmp_path / "case.foam", [Grid.from_nodes(ring().nodes, "o", parts)])
    result = patches(tmp_path / "constant" / "polyMesh")
    assert list(result) == ["part_0012_a", "frontAndBack-2", "frontAndBack"]
    assert result["part_0012_a"][0] == "wall"


def test_overlapping_parts_give_every_face_to_one_patch(tmp_path: Path) -> None:
    parts = (Patch("wall", "south", 0, 12), Patch("slot", "south", 3, 5), Patch("far", "north", 0, 12))
    write_grids(tmp_path / "case.foam", [Grid.from_nodes(ring().nodes, "o", parts)])
    result = patches(tmp_path / "constant" / "polyMesh")
    assert {name: message[1] for name, message in result.items()} == {
        "wall": 10, "slot": 2, "far": 12, "frontAndBack": 96,
    }  # fmt: skip


@pytest.mark.parametrize("name", ["run", "runs/first", "run/case.foam", "."])
def test_a_case_is_written_into_the_folder_that_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    meshonet.write(ring(), name, to_format="openfoam")
    folder = Path(name).parent if name.endswith(".foam") else Path(name)
    (marker,) = folder.glob("*.foam")
    assert file_names(folder) == sorted([marker.name, "constant", "system"])
    assert (marker.stat().st_size, (folder / "constant/polyMesh/points").exists()) == (0, True)
    assert folder == Path() or not Path("constant").exists()


def test_a_grid_of_one_point_is_refused(tmp_path: Path) -> None:
    for nodes in (np.zeros((5, 4, 2)), np.ones((3, 3, 3, 3))):
        with pytest.raises(InputError, match="the points have no extent"):
            write_grids(tmp_path / "case.foam", [Grid.from_nodes(nodes)])
    assert file_names(tmp_path) == []


def passage() -> Grid:
    """Return a twelfth of a pipe, whose periodic sides are turned."""
    return revolved(channel(), Revolution(30.0, 4))


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("form", ["ascii", "binary"])
def test_cells_between_turned_sides_are_a_zone_with_the_name_of_the_grid(form: str, tmp_path: Path) -> None:
    grid = replace(passage(), name="stage 1")
    write_grids(tmp_path / "case.foam", [grid], options=frozenset({form}))
    assert b"\nstage_1\n{\n    type            cellZone;" in zones(tmp_path).read_bytes()
    assert re.search(r"cell zones: +1\n", check_mesh(tmp_path))


def test_a_zone_in_text_has_all_cells(tmp_path: Path) -> None:
    grid = passage()
    write_grids(tmp_path / "case.foam", [grid], options=frozenset({"ascii"}))
    labels = re.search(r"List<label>\n(\d+)\n\(\n([\d\n]+)\)\n;", zones(tmp_path).read_text())
    assert labels is not None
    cells = int(np.prod([n - 1 for n in grid.blocks[0].counts]))
    assert labels[1] == str(cells)
    assert [int(label) for label in labels[2].split()] == list(range(cells))


def test_a_grid_whose_sides_are_not_turned_has_no_zones(tmp_path: Path) -> None:
    write_grids(tmp_path / "case.foam", [channel()])
    assert not zones(tmp_path).exists()


def test_a_blade_row_without_periodic_sides_has_its_zone(tmp_path: Path) -> None:
    """As a full annulus, which may rotate too."""
    write_grids(tmp_path / "case.foam", [channel().with_provenance(method="row")])
    assert zones(tmp_path).exists()


def zones(case: Path) -> Path:
    return case / "constant" / "polyMesh" / "cellZones"
