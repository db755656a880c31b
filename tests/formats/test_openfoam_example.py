"""The worked cases of OpenFOAM give the forces that finer grids and other codes give."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.client("simpleFoam")
@pytest.mark.parametrize(
    ("angle", "name", "value", "part"), [(0, "Cd", 0.1195, 0.015), (4, "Cl", 0.2055, 0.03)]
)
def test_the_forces_on_naca_0012_are_right(
    angle: int, name: str, value: float, part: float, tmp_path: Path
) -> None:
    folder = shutil.copytree(ROOT / "examples" / "naca0012-openfoam", tmp_path / "example")
    script = tmp_path / "meshonet"
    script.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m meshonet_cli "$@"\n')
    script.chmod(0o755)
    done = subprocess.run(
        ["make", "-s", f"ANGLE={angle}", f"MESHONET={script}"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert done.returncode == 0, done.stderr
    words = done.stdout.split()
    assert float(words[words.index(name) + 1]) == pytest.approx(value, rel=part)


@pytest.mark.client("simpleFoam")
def test_drag_and_lift_of_the_cylinder_in_a_channel_are_the_published_ones(tmp_path: Path) -> None:
    """Schaefer and Turek's benchmark 2D-1, values of FEATFLOW, on blocks of at most 25,000 cells."""
    folder = shutil.copytree(ROOT / "examples" / "cylinder-openfoam", tmp_path / "example")
    script = tmp_path / "meshonet"
    script.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m meshonet_cli "$@"\n')
    script.chmod(0o755)
    done = subprocess.run(
        ["make", "-s", "CELLS=20000", f"MESHONET={script}", f"PYTHON={sys.executable}"],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=500,
    )
    assert done.returncode == 0, done.stderr
    words = done.stdout.split()
    assert float(words[words.index("Cd") + 1]) == pytest.approx(5.57953523384, rel=0.01)
    assert float(words[words.index("Cl") + 1]) == pytest.approx(0.010618948146, rel=0.05)


@pytest.mark.client("simpleFoam")
def test_the_pressure_that_a_pipe_bend_loses_is_that_of_a_grid_twice_as_fine(tmp_path: Path) -> None:
    """And more than that of the straight pipe of its length, 32 nu U L / D^2 of Hagen and Poiseuille."""
    folder = shutil.copytree(ROOT / "examples" / "pipe-bend-openfoam", tmp_path / "example")
    script = tmp_path / "meshonet"
    script.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m meshonet_cli "$@"\n')
    script.chmod(0o755)
    pressures = []
    for counts in (["CELLS=160", "PLANES=41"], ["CELLS=640", "PLANES=81"]):
        done = subprocess.run(
            ["make", "-s", *counts, f"MESHONET={script}"],
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=500,
        )
        assert done.returncode == 0, done.stderr
        words = done.stdout.split()
        pressures.append(float(words[words.index("pressure") + 1]))
    coarse, fine = pressures
    assert coarse == pytest.approx(fine, rel=0.03)
    assert fine > 32 * 0.01 * (2 + math.pi + 3)
