from pathlib import Path

import numpy as np
import pytest
from format_shapes import c_grid, channel, ring
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.meshio_export import write_vtu as write_grids
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid


@pytest.mark.parametrize("thick", [False, True])
@pytest.mark.parametrize("make", [channel, ring, c_grid])
def test_vtk_reads_cells_points_and_the_numbers_of_parts(
    make: type[Grid], thick: bool, tmp_path: Path
) -> None:
    mesh = unstructured(make())
    if thick:
        write_grids(tmp_path / "g.vtu", [extruded(make(), (0.0, 0.5))])
    else:
        write_grids(tmp_path / "g.vtu", [make()])
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "g.vtu"))
    reader.Update()
    read = reader.GetOutput()
    points = vtk_to_numpy(read.GetPoints().GetData())
    assert np.array_equal(points[: len(mesh.points), :2], mesh.points)
    counts = [len(mesh.cells), *(len(edges) for edges in mesh.faces.values())]
    if thick:
        counts += [len(mesh.cells)] * 2
        assert points[len(mesh.points) :, 2].tolist() == [0.5] * len(mesh.points)
    assert np.bincount(vtk_to_numpy(read.GetCellData().GetArray("part"))).tolist() == counts
