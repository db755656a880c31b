"""The worked case of SU2: its mesh parsed by another reader, its case file naming the mesh's markers."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]


def made(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the example's Makefile in a copy at `folder`."""
    if not folder.exists():
        shutil.copytree(ROOT / "examples" / "naca0012-su2", folder)
    script = folder.parent / "meshonet"
    script.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m meshonet_cli "$@"\n')
    script.chmod(0o755)
    line = ["make", "-s", f"MESHONET={script}", *words]
    return subprocess.run(line, cwd=folder, capture_output=True, text=True, timeout=500)


def test_the_case_is_made_and_its_markers_are_those_of_the_mesh(tmp_path: Path) -> None:
    done = made(tmp_path / "example", "case", "ANGLE=4")
    assert done.returncode == 0, done.stderr
    case = tmp_path / "example" / "run-4"
    settings = dict(re.findall(r"^(\w+)= *(.*)$", (case / "naca0012.cfg").read_text(), re.MULTILINE))
    assert (settings["AOA"], settings["MESH_FILENAME"]) == ("4", "mesh.su2")
    x, y, _ = (float(word) for word in settings["INC_VELOCITY_INIT"].strip("()").split(","))
    assert np.degrees(np.arctan2(y, x)) == pytest.approx(4)
    assert np.hypot(x, y) == pytest.approx(1)
    markers = dict(re.findall(r"MARKER_TAG= (\S+)\nMARKER_ELEMS= (\d+)", (case / "mesh.su2").read_text()))
    assert markers == {"wall": "160", "farfield": "160"}
    assert re.findall(r"\w+", settings["MARKER_HEATFLUX"])[0] == "wall"
    assert re.findall(r"\w+", settings["MARKER_FAR"]) == ["farfield"]
    mesh = meshio.su2.read(case / "mesh.su2")
    quads = mesh.points[mesh.cells_dict["quad"]]
    assert quads.shape == (160 * 64, 4, 2)
    x, y = np.moveaxis(quads, -1, 0)
    area = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    assert area.min() > 0
    assert area.sum() == pytest.approx(np.pi * 30**2, rel=1e-3)
    walls = mesh.cells_dict["line"][np.concatenate(mesh.cell_data["su2:tag"][1:]) == 1]
    assert mesh.points[walls][..., 0].min() == pytest.approx(0, abs=1e-3)


@pytest.mark.solver("SU2_CFD")
@pytest.mark.parametrize(
    ("angle", "name", "value", "part"), [(0, "Cd", 0.1195, 0.03), (4, "Cl", 0.2055, 0.05)]
)
def test_the_forces_on_naca_0012_are_right(
    angle: int, name: str, value: float, part: float, tmp_path: Path
) -> None:
    done = made(tmp_path / "example", f"ANGLE={angle}")
    assert done.returncode == 0, done.stderr
    words = done.stdout.split()
    assert float(words[words.index(name) + 1]) == pytest.approx(value, rel=part)
