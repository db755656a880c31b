"""Volumes and surfaces in VTK's formats, as VTK sees them and as they come back."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import vtk
from surface_grids import SURFACES, leaf, sheet, sphere, tube
from volume_grids import VOLUMES, box, c_volume, pipe
from vtk.util.numpy_support import vtk_to_numpy

from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.registry import format_named, read_grids
from meshonet.formats.vtk import vts
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

Make = Callable[[], Grid]
ONE_BLOCK: list[Make] = [box, c_volume, leaf, tube, sheet]


def written(name: str, grid: Grid, folder: Path) -> Path:
    record = format_named(name)
    assert record.write_grids is not None
    path = folder / f"g{record.suffixes[0]}"
    record.write_grids(path, [grid])
    return path


def seen(path: Path, reader: vtk.vtkAlgorithm) -> vtk.vtkDataSet:
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutputDataObject(0)


def points_of(data: vtk.vtkPointSet) -> Floats:
    return vtk_to_numpy(data.GetPoints().GetData())


def volumes_of(data: vtk.vtkDataSet) -> Floats:
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(data)
    sizes.Update()
    return vtk_to_numpy(sizes.GetOutput().GetCellData().GetArray("Volume"))


def in_file_order(block: Block) -> Floats:
    return np.stack([values.ravel(order="F") for values in np.moveaxis(block.nodes, -1, 0)], axis=-1)


@pytest.mark.parametrize("name", ["vts", "vtk", "vtk:ascii"])
@pytest.mark.parametrize("make", ONE_BLOCK)
def test_a_block_comes_back_with_all_that_it_is(make: Make, name: str, tmp_path: Path) -> None:
    grid = make()
    (back,) = read_grids(str(written(name, grid, tmp_path)), name)
    assert np.array_equal(back.nodes, grid.nodes)
    assert (back.name, back.patches, back.connections) == (grid.name, grid.patches, grid.connections)
    assert dict(back.provenance) == dict(grid.provenance)


@pytest.mark.parametrize("name", ["vts", "vtk", "vtk:ascii"])
@pytest.mark.parametrize("make", ONE_BLOCK)
def test_vtk_sees_a_structured_grid(make: Make, name: str, tmp_path: Path) -> None:
    reader = vtk.vtkXMLStructuredGridReader() if name == "vts" else vtk.vtkStructuredGridReader()
    data = seen(written(name, make(), tmp_path), reader)
    dims = [0, 0, 0]
    data.GetDimensions(dims)
    assert tuple(dims) == (*make().blocks[0].counts, 1)[:3]
    assert np.array_equal(points_of(data), in_file_order(make().blocks[0]))
    assert make not in VOLUMES or volumes_of(data).min() > 0


def test_vtk_finds_cell_data_in_the_right_cells(tmp_path: Path) -> None:
    grid = box()
    cells = tuple(count - 1 for count in grid.blocks[0].counts)
    values = np.arange(np.prod(cells), dtype=float).reshape(cells)
    vts.write(tmp_path / "g.vts", grid, {"number": values})
    data = seen(tmp_path / "g.vts", vtk.vtkXMLStructuredGridReader())
    stored = data.GetCellData().GetArray("number")
    for place in np.ndindex(cells):
        corners = grid.blocks[0].nodes[tuple(slice(k, k + 2) for k in place)].reshape(-1, 3)
        cell = data.FindCell(corners.mean(axis=0), None, 0, 1e-12, vtk.reference(0), [0.0] * 3, [0.0] * 8)
        assert stored.GetValue(cell) == values[place]
    with pytest.raises(InputError, match=r"cell array 'number' has shape \(3, 4, 5\); give \(4, 3, 5\)"):
        vts.write(tmp_path / "g.vts", grid, {"number": values.swapaxes(0, 1)})


@pytest.mark.parametrize("make", [*VOLUMES, *SURFACES, sheet])
def test_blocks_come_back_from_a_vtm_in_which_vtk_finds_them(make: Make, tmp_path: Path) -> None:
    grid = make()
    path = written("vtm", grid, tmp_path)
    (back,) = read_grids(str(path))
    for block, old in zip(back.blocks, grid.blocks, strict=True):
        assert np.array_equal(block.nodes, old.nodes)
    assert (back.name, set(back.patches), back.connections) == (
        grid.name,
        set(grid.patches),
        grid.connections,
    )
    tree = seen(path, vtk.vtkXMLMultiBlockDataReader()).GetBlock(0)
    for k, block in enumerate(grid.blocks):
        assert np.array_equal(points_of(tree.GetBlock(k)), in_file_order(block))


@pytest.mark.parametrize("make", [pipe, c_volume, sphere, leaf])
def test_blocks_that_vtk_wrote_are_joined_where_they_touch(make: Make, tmp_path: Path) -> None:
    blocks = vtk.vtkMultiBlockDataSet()
    for k, block in enumerate(make().blocks):
        points = vtk.vtkPoints()
        points.SetDataTypeToDouble()
        for point in in_file_order(block):
            points.InsertNextPoint(*point)
        made = vtk.vtkStructuredGrid()
        made.SetDimensions(*(*block.counts, 1)[:3])
        made.SetPoints(points)
        blocks.SetBlock(k, made)
    writer = vtk.vtkXMLMultiBlockDataWriter()
    writer.SetFileName(str(tmp_path / "g.vtm"))
    writer.SetInputData(blocks)
    writer.Write()
    (back,) = read_grids(str(tmp_path / "g.vtm"))
    assert back.connections == make().connections
    assert [block.counts for block in back.blocks] == [block.counts for block in make().blocks]


@pytest.mark.parametrize("make", VOLUMES)
def test_vtu_has_hexahedra_without_seams(make: Make, tmp_path: Path) -> None:
    data = seen(written("vtu", make(), tmp_path), vtk.vtkXMLUnstructuredGridReader())
    mesh = unstructured(make())
    assert data.GetNumberOfPoints() == len(mesh.points) == len(np.unique(mesh.points, axis=0))
    solid = vtk_to_numpy(data.GetCellData().GetArray("part")) == 0
    assert solid.sum() == sum(np.prod([n - 1 for n in block.counts]) for block in make().blocks)
    assert volumes_of(data)[solid].min() > 0


def test_vtu_of_a_closed_surface_has_all_its_area_and_no_seams(tmp_path: Path) -> None:
    data = seen(written("vtu", sphere(), tmp_path), vtk.vtkXMLUnstructuredGridReader())
    assert data.GetNumberOfPoints() == 98
    assert {data.GetCellType(k) for k in range(data.GetNumberOfCells())} == {vtk.VTK_QUAD}
    skin = vtk.vtkGeometryFilter()
    skin.SetInputData(data)
    edges = vtk.vtkFeatureEdges()
    edges.SetInputConnection(skin.GetOutputPort())
    edges.FeatureEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    assert edges.GetOutput().GetNumberOfCells() == 0


def test_a_layer_that_others_wrote_is_a_plane_grid_and_two_are_a_volume(tmp_path: Path) -> None:
    x, y = np.meshgrid(np.linspace(0, 1, 4), np.linspace(0, 1, 3), indexing="ij")
    for planes, shape in ((2, (4, 3, 2)), (3, (4, 3, 3, 3))):
        z = np.linspace(0, 1, planes)
        points = vtk.vtkPoints()
        for k, j, i in np.ndindex(planes, 3, 4):
            points.InsertNextPoint(x[i, j], y[i, j], z[k])
        made = vtk.vtkStructuredGrid()
        made.SetDimensions(4, 3, planes)
        made.SetPoints(points)
        writer = vtk.vtkXMLStructuredGridWriter()
        writer.SetFileName(str(tmp_path / "g.vts"))
        writer.SetInputData(made)
        writer.Write()
        (back,) = read_grids(str(tmp_path / "g.vts"))
        assert back.nodes.shape == shape
