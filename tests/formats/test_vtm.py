import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import vtk
from format_shapes import channel, file_names, memory, ring
from many_blocks import MANY, butterfly, by_block, duct

from meshonet.formats.output import whole_file
from meshonet.formats.source import open_source
from meshonet.formats.vtk.vtm import read_grids, write_grids
from meshonet.formats.vtk.vts_read import read_grids as read_vts
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

INDEX = '<VTKFile type="vtkMultiBlockDataSet"><vtkMultiBlockDataSet>{}</vtkMultiBlockDataSet></VTKFile>'


def test_blocks_of_any_size_and_topology_come_back(tmp_path: Path) -> None:
    grids = [ring(name="one"), channel(name="<two> Ω")]
    with whole_file(str(tmp_path / "all.vtm")) as part:
        write_grids(part, grids)
    assert file_names(tmp_path) == ["all.vtm", "all_blocks"]
    assert file_names(tmp_path / "all_blocks") == ["block-0.vts", "block-1.vts"]
    for back, grid in zip(read_grids(open_source(str(tmp_path / "all.vtm"))), grids, strict=True):
        assert np.array_equal(back.nodes, grid.nodes)
        assert (back.name, back.topology, back.patches) == (grid.name, grid.topology, grid.patches)


@pytest.mark.parametrize("heights", [(), (0.0, 0.5)])
@pytest.mark.parametrize("make", MANY)
def test_a_grid_of_blocks_is_one_among_others(
    make: Callable[[], Grid], heights: tuple[float, ...], tmp_path: Path
) -> None:
    grid = make()
    grids = [ring(), grid, grid, channel()]
    write_grids(tmp_path / "g.vtm", [extruded(each, heights) if heights else each for each in grids])
    result = list(read_grids(open_source(str(tmp_path / "g.vtm"))))
    assert [each.topology for each in result] == ["o", "blocks", "blocks", "quad"]
    for back in result[1:3]:
        for block, old in zip(back.blocks, grid.blocks, strict=True):
            assert np.array_equal(block.nodes, old.nodes)
        assert (back.name, back.connections, back.provenance) == (
            grid.name, grid.connections, grid.provenance
        )  # fmt: skip
        assert back.patches == by_block(grid.patches)
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(tmp_path / "g.vtm"))
    reader.Update()
    nested = reader.GetOutput().GetBlock(1)
    assert nested.GetNumberOfBlocks() == len(grid.blocks)
    assert nested.GetBlock(0).GetNumberOfPoints() == max(len(heights), 1) * grid.blocks[0].nodes.size // 2


def test_a_block_of_a_grid_is_a_grid_by_itself(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.vtm", [duct()])
    (back,) = read_vts(open_source(str(tmp_path / "g_blocks" / "block-1.vts")))
    assert back.topology == "quad"
    assert {patch.name for patch in back.patches} == {"wall", "outlet"}


def test_a_missing_block_is_named(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.vtm", [duct()])
    text = (tmp_path / "g.vtm").read_text()
    (tmp_path / "g.vtm").write_text(re.sub(r".*block-1.vts.*\n", "", text))
    with pytest.raises(InputError, match=r"connection of east of block 0 to .* of block 1 leaves its side"):
        list(read_grids(open_source(str(tmp_path / "g.vtm"))))


def test_blocks_that_vtk_wrote_are_joined_where_they_touch(tmp_path: Path) -> None:
    blocks = vtk.vtkMultiBlockDataSet()
    for k, block in enumerate((*butterfly().blocks, *duct().blocks)):
        points = vtk.vtkPoints()
        points.SetDataTypeToDouble()
        for x, y in block.nodes.swapaxes(0, 1).reshape(-1, 2) + np.array([9.0 * (k > 4), 0]):
            points.InsertNextPoint(x, y, 0)
        made = vtk.vtkStructuredGrid()
        made.SetDimensions(*block.counts, 1)
        made.SetPoints(points)
        blocks.SetBlock(k, made)
    writer = vtk.vtkXMLMultiBlockDataWriter()
    writer.SetFileName(str(tmp_path / "g.vtm"))
    writer.SetInputData(blocks)
    writer.SetCompressorTypeToZLib()
    writer.Write()
    first, second = read_grids(open_source(str(tmp_path / "g.vtm")))
    assert (len(first.blocks), len(first.connections)) == (5, 8)
    assert (len(second.blocks), len(second.connections)) == (2, 1)


def test_vtk_opens_all_blocks(tmp_path: Path) -> None:
    write_grids(tmp_path / "all.vtm", [extruded(each, (0.0, 1.0)) for each in (ring(), channel())])
    reader = vtk.vtkXMLMultiBlockDataReader()
    reader.SetFileName(str(tmp_path / "all.vtm"))
    reader.Update()
    blocks = reader.GetOutput()
    assert [blocks.GetBlock(k).GetNumberOfPoints() for k in range(blocks.GetNumberOfBlocks())] == [130, 70]


def test_a_second_run_replaces_the_blocks_of_the_first(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.vtm", [ring(), ring()])
    write_grids(tmp_path / "g.vtm", [channel()])
    assert file_names(tmp_path / "g_blocks") == ["block-0.vts"]


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "g_blocks").mkdir()
    (tmp_path / "g_blocks" / "thesis.tex").write_text("mine")
    with pytest.raises(InputError, match="folder g_blocks holds other files, which would be lost; choose"):
        write_grids(tmp_path / "g.vtm", [ring()])
    assert (tmp_path / "g_blocks" / "thesis.tex").read_text() == "mine"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("hello", "is not well-formed XML"),
        ("<a/>", r"is a VTK file of type \?; give one of type vtkMultiBlockDataSet"),
        (INDEX.format(""), "names no files"),
        (INDEX.format('<DataSet file="../x.vts"/>'), "names '../x.vts', which is not below its folder"),
        (INDEX.format('<DataSet file="/etc/passwd"/>'), "which is not below its folder"),
        (INDEX.format('<DataSet file="b/x.vtu"/>'), "which is no .vts; give blocks that are structured"),
        (INDEX.format('<DataSet file="b/x.vts"/>'), "names 'b/x.vts', which is not there"),
        (INDEX.format('<DataSet file="bad.vts"/>'), "bad.vts: .*is not"),
    ],
)
def test_what_is_wrong_is_named_with_its_remedy(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "g.vtm").write_text(text)
    (tmp_path / "bad.vts").write_text("<VTKFile>")
    with pytest.raises(InputError, match=message):
        list(read_grids(open_source(str(tmp_path / "g.vtm"))))


def test_a_stream_has_no_files_beside_it() -> None:
    with pytest.raises(InputError, match="names files beside itself, and a stream has none; give its path"):
        list(read_grids(memory(b"<VTKFile/>")))
