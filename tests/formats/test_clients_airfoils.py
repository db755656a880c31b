"""O and C grids around airfoils, as the command line makes them, before cgnscheck and checkMesh."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "WM_PROJECT_DIR": "/usr/share/openfoam"}
GRIDS = {
    "o": "infer naca:2412 --topology o --res 161x65",
    "o-viscous": "infer naca:0012 --topology o --wall-spacing 1e-4 --res 161x65",
    "c": "solve-pde naca:0012 --topology c --res 161x49",
    "c-viscous": "infer naca:0012 --topology c --te wedge --wall-spacing 1e-4 --res 241x65",
}
SOFT = ("skewness", "non-orthogonal", "aspect ratio")
"""Of the quality of a grid, not of the file: what else checkMesh marks with stars is a fault."""


def run(*words: str) -> str:
    done = subprocess.run(words, capture_output=True, text=True, env=ENVIRONMENT, timeout=120)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("airfoils")


def grid(name: str, folder: Path) -> str:
    path = folder / f"{name}.vts"
    if not path.exists():
        run(sys.executable, "-m", "meshonet_cli", *GRIDS[name].split(), "-q", "-o", str(path))
    return str(path)


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("name", GRIDS)
def test_check_mesh_finds_no_fault(name: str, folder: Path) -> None:
    case = folder / f"case-{name}"
    run(sys.executable, "-m", "meshonet_cli", "convert", grid(name, folder), str(case / "case.foam"), "-q")
    message = run("checkMesh", "-case", str(case), "-allTopology")
    faults = [line for line in message.splitlines() if "***" in line]
    assert [line for line in faults if not any(word in line for word in SOFT)] == []
    assert "Upper triangular ordering OK." in message
    assert "Cell volumes OK." in message
    assert "Mesh OK." in message


@pytest.mark.client("cgnscheck")
@pytest.mark.parametrize("layers", [(), ("--extrude", "0.1"), ("--extrude", "1", "--planes", "4")])
@pytest.mark.parametrize("name", GRIDS)
def test_cgnscheck_finds_neither_errors_nor_warnings(
    name: str, layers: tuple[str, ...], folder: Path, tmp_path: Path
) -> None:
    path = str(tmp_path / "grid.cgns")
    run(sys.executable, "-m", "meshonet_cli", "convert", grid(name, folder), path, "-q", *layers)
    message = run("cgnscheck", "-w3", path)
    assert "ERROR" not in message
    assert "WARNING" not in message
