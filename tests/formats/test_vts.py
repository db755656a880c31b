import itertools
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
import vtk
from format_shapes import c_grid, channel, ring
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from meshonet.formats.source import open_source
from meshonet.formats.vtk.vts import write, write_grids
from meshonet.formats.vtk.vts_read import read_grids
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


def by_vtk(path: Path) -> vtk.vtkStructuredGrid:
    reader = vtk.vtkXMLStructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


def dims(data: vtk.vtkStructuredGrid) -> tuple[int, int, int]:
    counts = [0, 0, 0]
    data.GetDimensions(counts)
    return counts[0], counts[1], counts[2]


def vtk_grid(nodes: Floats, kind: type = np.float64) -> vtk.vtkStructuredGrid:
    data = vtk.vtkStructuredGrid()
    ni, nj = nodes.shape[:2]
    data.SetDimensions(ni, nj, 1)
    flat = np.zeros((ni * nj, 3), kind)
    flat[:, :2] = nodes.swapaxes(0, 1).reshape(-1, 2)
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(flat, deep=True))
    data.SetPoints(points)
    return data


@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_vtk_reads_what_we_write(make: type[Grid], tmp_path: Path) -> None:
    grid = make()
    write(tmp_path / "g.vts", grid)
    data = by_vtk(tmp_path / "g.vts")
    assert dims(data) == (grid.ni, grid.nj, 1)
    points = vtk_to_numpy(data.GetPoints().GetData())
    assert points.dtype == np.float64
    assert np.array_equal(points[:, 0], grid.x.ravel(order="F"))
    assert np.array_equal(points[:, 1], grid.y.ravel(order="F"))
    assert not points[:, 2].any()


def test_vtk_sees_names_as_field_data(tmp_path: Path) -> None:
    write(tmp_path / "g.vts", channel())
    fields = by_vtk(tmp_path / "g.vts").GetFieldData()
    texts = {}
    for k in range(fields.GetNumberOfArrays()):
        array = fields.GetAbstractArray(k)
        texts[array.GetName()] = [array.GetValue(n) for n in range(array.GetNumberOfValues())]
    assert texts["topology"] == ["quad"]
    assert texts["name"] == ["channel Ω"]
    assert texts["parts"] == ["west 0 4 inlet", "south 0 3 no-slip wall", "east 0 4 out let"]


def test_vtk_finds_cell_data_in_the_right_cells(tmp_path: Path) -> None:
    grid = channel()
    angle = np.arange((grid.ni - 1) * (grid.nj - 1), dtype=float).reshape(grid.ni - 1, grid.nj - 1)
    write(tmp_path / "g.vts", grid, {"max angle": angle, "folded & <bad>": angle > 5})
    data = by_vtk(tmp_path / "g.vts")
    stored = data.GetCellData()
    for i, j in itertools.product(range(grid.ni - 1), range(grid.nj - 1)):
        cell = data.FindCell([*grid.nodes[i:i + 2, j:j + 2].mean(axis=(0, 1)).tolist(), 0.0], None, 0, 0.0,
                             vtk.reference(0), [0.0] * 3, [0.0] * 4)  # fmt: skip
        assert stored.GetArray("max angle").GetValue(cell) == angle[i, j]
        assert stored.GetArray("folded & <bad>").GetValue(cell) == (angle[i, j] > 5)


def test_cell_data_of_another_shape_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"cell array 'a' has shape \(7, 5\); give \(6, 4\)"):
        write(tmp_path / "g.vts", channel(), {"a": np.zeros((7, 5))})


def test_vtk_sees_a_right_handed_layer_of_hexahedra(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.vts", [extruded(ring(), (0.0, 0.25))])
    data = by_vtk(tmp_path / "g.vts")
    assert dims(data) == (13, 5, 2)
    assert data.GetBounds()[4:] == (0.0, 0.25)
    volumes = vtk.vtkCellSizeFilter()
    volumes.SetInputData(data)
    volumes.Update()
    assert (vtk_to_numpy(volumes.GetOutput().GetCellData().GetArray("Volume")) > 0).all()


MODES = ("ascii", "binary", "raw", "base64")


@pytest.mark.parametrize("words", [32, 64])
@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize("compressor", [None, vtk.vtkZLibDataCompressor, vtk.vtkLZMADataCompressor])
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_we_read_whatever_vtk_writes(
    kind: type, mode: str, compressor: type | None, order: str, words: int, tmp_path: Path
) -> None:
    grid = ring(23, 17)
    writer = vtk.vtkXMLStructuredGridWriter()
    writer.SetFileName(str(tmp_path / "g.vts"))
    writer.SetInputData(vtk_grid(grid.nodes, kind))
    getattr(
        writer,
        {"ascii": "SetDataModeToAscii", "binary": "SetDataModeToBinary"}.get(mode, "SetDataModeToAppended"),
    )()
    writer.SetEncodeAppendedData(mode == "base64")
    writer.SetCompressor(compressor() if compressor else None)
    writer.SetBlockSize(1024)
    (writer.SetByteOrderToBigEndian if order == "big" else writer.SetByteOrderToLittleEndian)()
    (writer.SetHeaderTypeToUInt32 if words == 32 else writer.SetHeaderTypeToUInt64)()
    assert writer.Write() == 1
    (back,) = read_grids(open_source(str(tmp_path / "g.vts")))
    expected = grid.nodes.astype(kind)
    if mode == "ascii" and kind is np.float32:
        assert np.allclose(back.nodes, expected, rtol=1e-6, atol=1e-6)
    else:
        assert np.array_equal(back.nodes, expected)
    assert (back.topology, back.name) == ("o", "g")


def test_names_survive_a_save_by_vtk(tmp_path: Path) -> None:
    grid = channel()
    write(tmp_path / "g.vts", grid)
    for compressed, encoded in itertools.product((False, True), repeat=2):
        writer = vtk.vtkXMLStructuredGridWriter()
        writer.SetFileName(str(tmp_path / "again.vts"))
        writer.SetInputData(by_vtk(tmp_path / "g.vts"))
        writer.SetCompressor(vtk.vtkZLibDataCompressor() if compressed else None)
        writer.SetEncodeAppendedData(encoded)
        writer.Write()
        (back,) = read_grids(open_source(str(tmp_path / "again.vts")))
        assert (back.patches, back.name, dict(back.provenance)) == (
            grid.patches,
            grid.name,
            dict(grid.provenance),
        )


def test_lz4_is_refused_by_name(tmp_path: Path) -> None:
    writer = vtk.vtkXMLStructuredGridWriter()
    writer.SetFileName(str(tmp_path / "g.vts"))
    writer.SetInputData(vtk_grid(ring().nodes))
    writer.SetCompressor(vtk.vtkLZ4DataCompressor())
    writer.Write()
    with pytest.raises(
        InputError, match="Points: compressor 'vtkLZ4DataCompressor' cannot be read; write it with zlib"
    ):
        list(read_grids(open_source(str(tmp_path / "g.vts"))))


def test_writing_never_holds_a_second_grid(tmp_path: Path) -> None:
    grid = ring(1200, 1000)
    tracemalloc.start()
    write(tmp_path / "g.vts", grid)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.1 * grid.nodes.nbytes
