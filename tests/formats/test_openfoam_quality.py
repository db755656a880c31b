"""Non-orthogonality, skewness and aspect ratio are those that checkMesh prints."""

import os
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from format_shapes import c_grid, ring

from meshonet.formats.openfoam.write import write_grids
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.checkmesh import faces


def shaken() -> Grid:
    x, y = np.meshgrid(np.arange(9.0), 0.4 * np.arange(7), indexing="ij")
    return Grid.from_nodes(
        np.stack([x, y], axis=-1) + np.random.default_rng(4).uniform(-0.12, 0.12, (9, 7, 2))
    )


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("name", ["quad", "o", "c"])
def test_check_mesh_says_the_same(tmp_path: Path, name: str) -> None:
    grid = {"quad": shaken, "o": lambda: ring(33, 17), "c": lambda: c_grid(33, 33, 17)}[name]()
    write_grids(tmp_path / "case.foam", [extruded(grid, (0.0, 0.1))])
    done = subprocess.run(
        ["checkMesh", "-case", str(tmp_path)],
        capture_output=True,
        text=True,
        timeout=60,
        env=os.environ | {"WM_PROJECT_DIR": "/usr/share/openfoam"},
    )

    def theirs(pattern: str) -> float:
        found = re.search(pattern + r" ([-+.\de]+)", done.stdout)
        assert found, done.stdout
        return float(found[1])

    ours = faces(grid)
    assert ours.non_orthogonality is not None
    assert ours.face_skewness is not None
    assert ours.box_ratio is not None
    assert ours.non_orthogonality.max == pytest.approx(theirs("non-orthogonality Max:"), rel=1e-5, abs=1e-5)
    assert ours.non_orthogonality.mean == pytest.approx(theirs("average:"), rel=1e-5, abs=1e-5)
    assert ours.face_skewness.max == pytest.approx(theirs("Max skewness ="), rel=1e-5)
    assert ours.box_ratio.max == pytest.approx(theirs("Max aspect ratio ="), rel=1e-5)
