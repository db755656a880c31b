"""The worked case of OpenFOAM gives the forces that finer grids and other codes give at Re 1000."""

from __future__ import annotations

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
