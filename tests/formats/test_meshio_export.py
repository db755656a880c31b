from pathlib import Path

import meshio
import numpy as np
import pytest
from format_shapes import c_grid, channel, ring

from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.registry import format_named
from meshonet.geometry.blocks.grid import Grid

NEW = ("avs", "tec", "mdpa", "med", "vol", "xdmf")


@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.parametrize("name", ["stl", "ply", "obj", "off", "abaqus", "medit", *NEW])
def test_the_cells_cover_the_grid(
    name: str, make: type[Grid], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    grid, record = make(), format_named(name)
    suffix = next(suffix for suffix, kind in record.suffix_options.items() if f"meshio:{kind}" == record.name)
    path = tmp_path / f"g{suffix}"
    assert record.write_grids is not None
    record.write_grids(path, [grid])
    assert capsys.readouterr() == ("", "")
    mesh = meshio.read(path)
    area = 0.0
    for cells in mesh.cells:
        x, y = np.moveaxis(mesh.points[cells.data][..., :2], -1, 0)
        own = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
        assert own.min() > 0
        area += float(own.sum())
    flat = unstructured(grid)
    x, y = np.moveaxis(flat.points[flat.cells], -1, 0)
    wanted = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum()
    assert area == pytest.approx(wanted, rel=1e-5)
