"""What the guide on ParaView says opens there: every cell, every place and the quality that we measure."""

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from many_blocks import butterfly
from volume_grids import pipe

from meshonet.formats.registry import format_named
from meshonet.geometry.blocks.grid import Grid

LOOK = """
import json, sys
from paraview.simple import MeshQuality, OpenDataFile
reader = OpenDataFile(sys.argv[1])
reader.UpdatePipeline()
scaled = {"QuadQualityMeasure": "Scaled Jacobian", "HexQualityMeasure": "Scaled Jacobian"}
quality = MeshQuality(Input=reader, **scaled)
quality.UpdatePipeline()
information = reader.GetDataInformation()
least = quality.CellData["Quality"].GetRange()[0]
print(json.dumps([information.GetNumberOfCells(), found.GetBounds(), least]))
"""
FILES = {"g.vtm": "vtm", "g.cgns": "cgns", "g.xyz": "plot3d:binary"}


@pytest.mark.solver("pvpython")
@pytest.mark.parametrize("make", [butterfly, pipe])
@pytest.mark.parametrize("name", [*FILES, "g.foam"])
def test_paraview_sees_the_cells_that_we_measure(make: Callable[[], Grid], name: str, tmp_path: Path) -> None:
    grid = make()
    if name == "g.foam" and make is butterfly:
        pytest.skip("cases are volumes")
    writer = format_named(FILES.get(name, "openfoam"))
    assert writer.write_grids is not None
    writer.write_grids(tmp_path / name, [grid])
    (tmp_path / "look.py").write_text(LOOK)
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    words = ["pvpython", "--force-offscreen-rendering", "look.py", name]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, env=environment, timeout=60)
    assert done.returncode == 0, done.stderr
    cells, bounds, least = json.loads(done.stdout.splitlines()[-1])
    quality = grid.quality()
    assert cells == sum(int(np.prod([n - 1 for n in block.counts])) for block in grid.blocks)
    nodes = np.concatenate([block.nodes.reshape(-1, block.nodes.shape[-1]) for block in grid.blocks])
    ends = np.stack([nodes.min(axis=0), nodes.max(axis=0)], axis=1).ravel()
    np.testing.assert_allclose(bounds[: len(ends)], ends, rtol=1e-6, atol=1e-6)
    assert least == pytest.approx(quality["scaled_jacobian"].min, abs=1e-5)
