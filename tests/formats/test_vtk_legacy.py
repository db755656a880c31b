from pathlib import Path

import meshio
import numpy as np
import pytest
import vtk
from format_shapes import c_grid, channel, memory, ring
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from meshonet.formats.source import open_source
from meshonet.formats.vtk.legacy import read_grids, write_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


def by_vtk(path: Path) -> vtk.vtkStructuredGrid:
    reader = vtk.vtkStructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()


@pytest.mark.parametrize("text", [False, True])
@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_vtk_reads_what_we_write(make: type[Grid], text: bool, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.vtk", [grid], options=frozenset({"ascii"} if text else ()))
    data = by_vtk(tmp_path / "g.vtk")
    counts = [0, 0, 0]
    data.GetDimensions(counts)
    assert counts == [grid.ni, grid.nj, 1]
    points = vtk_to_numpy(data.GetPoints().GetData())
    assert np.array_equal(points[:, 0], grid.x.ravel(order="F"))
    assert np.array_equal(points[:, 1], grid.y.ravel(order="F"))
    topology = vtk_to_numpy(data.GetFieldData().GetArray("topology"))
    assert topology.tobytes().decode() == grid.topology


@pytest.mark.parametrize("text", [False, True])
def test_meshio_reads_what_we_write(text: bool, tmp_path: Path) -> None:
    write_grids(tmp_path / "g.vtk", [ring()], options=frozenset({"ascii"} if text else ()))
    mesh = meshio.read(tmp_path / "g.vtk")
    assert np.array_equal(mesh.points[:, 0], ring().x.ravel(order="F"))
    assert [(block.type, len(block.data)) for block in mesh.cells] == [("quad", 12 * 4)]


@pytest.mark.parametrize("version", [42, 51])
@pytest.mark.parametrize("binary", [False, True])
@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_we_read_what_vtk_writes(kind: type, binary: bool, version: int, tmp_path: Path) -> None:
    grid = ring(9, 6)
    data = vtk.vtkStructuredGrid()
    data.SetDimensions(9, 6, 1)
    flat = np.zeros((54, 3), kind)
    flat[:, :2] = grid.nodes.swapaxes(0, 1).reshape(-1, 2)
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(flat, deep=True))
    data.SetPoints(points)
    for name, texts in {"topology": ["o"], "name": ["ring é 50%"], "parts": ["south 0 8 a wall"]}.items():
        array = vtk.vtkStringArray()
        array.SetName(name)
        for words in texts:
            array.InsertNextValue(words)
        data.GetFieldData().AddArray(array)
    numbers = numpy_to_vtk(np.arange(4.0))
    numbers.SetName("time steps")
    data.GetFieldData().AddArray(numbers)
    angle = numpy_to_vtk(np.arange(40.0))
    angle.SetName("angle")
    data.GetCellData().AddArray(angle)
    writer = vtk.vtkStructuredGridWriter()
    writer.SetFileVersion(version)
    writer.SetFileName(str(tmp_path / "g.vtk"))
    writer.SetInputData(data)
    writer.SetFileType(2 if binary else 1)
    writer.SetHeader("")
    writer.Write()
    (back,) = read_grids(open_source(str(tmp_path / "g.vtk")))
    assert (back.topology, back.name, back.patches[0].name) == ("o", "ring é 50%", "a wall")
    if binary:
        assert np.array_equal(back.nodes, grid.nodes.astype(kind))
    else:
        assert np.allclose(back.nodes, grid.nodes, atol=1e-5)


def vtk_text(dims: str = "3 2 1", points: str = "6 double", body: str = "", field: str = "") -> bytes:
    """Return a legacy file written by hand: a grid of two unit squares."""
    body = body or "0 0 0 1 0 0 2 0 0\n0 1 0 1 1 0 2 1 0\n"
    return (
        "# vtk DataFile Version 2.0\n\nASCII\nDATASET STRUCTURED_GRID\n"
        f"{field}DIMENSIONS {dims}\nPOINTS {points}\n{body}"
    ).encode()


def test_a_file_written_by_hand_is_read_with_a_blank_title_and_trailing_data() -> None:
    (grid,) = read_grids(memory(vtk_text() + b"POINT_DATA 6\nSCALARS a float\n1 2 3 4 5 6\n"))
    assert grid.nodes[:, 0].tolist() == [[0, 0], [1, 0], [2, 0]]
    assert grid.nodes[:, 1].tolist() == [[0, 1], [1, 1], [2, 1]]


CASES = {
    "not vtk": (b"hello\n" * 9, "does not start with '# vtk DataFile'"),
    "dataset": (
        vtk_text().replace(b"STRUCTURED_GRID", b"POLYDATA"),
        "holds 'DATASET POLYDATA'; give a DATASET STR",
    ),
    "cut header": (vtk_text()[:60], "byte .*: ends before its points; the file is cut short"),
    "cut body": (vtk_text()[:-2], "should have 18 more numbers and is too short"),
    "padded body": (vtk_text(body="1 " * 17 + " " * 9), "should have 18 more numbers and has 17"),
    "dims": (vtk_text("3 3 1"), "has '6' points and DIMENSIONS 3x3x1; make them agree"),
    "no dims": (vtk_text().replace(b"DIMENSIONS", b"SIZES"), "has '6' points and DIMENSIONS 0x0x0"),
    "negative": (vtk_text("-3 -2 1"), "has '6' points and DIMENSIONS -3x-2x1"),
    "huge": (
        vtk_text("1000000000 1000000000 1", "1000000000000000000 double"),
        "should have .* is too short",
    ),
    "huge binary": (
        vtk_text("1000000000 1 1", "1000000000 double").replace(b"ASCII", b"BINARY"),
        "should have 24000000000 more bytes and is too short",
    ),
    "words": (vtk_text(body="a " * 18), "byte .*: could not convert"),
    "dims words": (vtk_text("x y z"), "invalid literal"),
    "short dims": (vtk_text("3"), "out of range"),
    "type": (vtk_text(points="6 complex"), "number type 'complex' is not known; write double or float"),
    "field": (vtk_text(field="FIELD a 1\nb 1 999999999 int\n"), "field 'b' claims 999999999 values"),
    "field line": (vtk_text(field="FIELD a 1\nb 1\n"), "not enough values"),
    "nan": (vtk_text(body="nan " * 18), "has x = nan"),
}


@pytest.mark.parametrize("case", CASES)
def test_a_damaged_or_hostile_file_is_refused(case: str) -> None:
    data, message = CASES[case]
    with pytest.raises(InputError, match=message):
        list(read_grids(memory(data)))
