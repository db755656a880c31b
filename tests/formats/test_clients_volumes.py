"""A wing and a pipe bend, as the command line makes them, before cgnscheck and checkMesh."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from meshonet.geometry.blocks.grid import Grid

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT), "WM_PROJECT_DIR": "/usr/share/openfoam"}
WING = """
[[sections]]
airfoil = "naca:2412"
chord = 1.0
z = 0.0

[[sections]]
airfoil = "naca:0012-sharp"
chord = 0.5
z = 2.0
sweep = 20
twist = -2
"""
BEND = """
[[pieces]]
line = 1
[[pieces]]
arc = 90
radius = 1.2
towards = [0, 1, 0]
"""
GRIDS = {
    "wing": "stack wing.toml --around 65 --span 25",
    "blade": "stack blade.toml --around 65 --span 13",
    "pipe": "sweep circle:0.5 bend.toml --around 40 --first-cell 0.01",
    "ring": "sweep circle:0.5 ring.csv --around 32",
    "wedge": "convert plane.h5 --revolve 5",
    "sector": "convert plane.h5 --revolve 60",
    "turn": "convert plane.h5 --revolve 360",
    "elbow": "sweep circle:0.5 --revolve 90 --axis 0,-2,1,0",
}
PATCHES = {
    "wing": {"wing": "wall", "tip": "wall", "symmetry": "symmetryPlane", "farfield": "patch"},
    "blade": {"blade": "wall", "hub": "wall", "shroud": "wall", "farfield": "patch"},
    "pipe": {"wall": "wall", "inlet": "patch", "outlet": "patch"},
    "ring": {"wall": "wall"},
    "wedge": {"east": "patch", "north": "patch", "west": "patch", "wedge1": "wedge", "wedge2": "wedge"},
    "sector": dict.fromkeys(("east", "north", "west"), "patch")
    | dict.fromkeys(("periodic1", "periodic2"), "cyclic"),
    "turn": dict.fromkeys(("east", "north", "west"), "patch"),
    "elbow": {"wall": "wall", "inlet": "patch", "outlet": "patch"},
}


def run(*words: str, folder: Path) -> str:
    done = subprocess.run(words, capture_output=True, text=True, env=ENVIRONMENT, timeout=300, cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("volumes")
    (made / "wing.toml").write_text(WING)
    (made / "blade.toml").write_text(f'kind = "blade"\n{WING}')
    (made / "bend.toml").write_text(BEND)
    plane = np.stack(np.meshgrid(np.linspace(0.0, 2.0, 9), np.linspace(0.0, 1.0, 6), indexing="ij"), axis=-1)
    Grid.from_nodes(plane).write(made / "plane.h5")
    (made / "ring.csv").write_text("2,0,0\n0,2,0\n-2,0,0\n0,-2,0\n2,0,0\n")
    return made


def written(name: str, ending: str, folder: Path) -> Path:
    path = folder / f"{name}{ending}"
    run(sys.executable, "-m", "meshonet_cli", *GRIDS[name].split(), "-q", "-o", str(path), folder=folder)
    return path


@pytest.mark.client("checkMesh")
@pytest.mark.parametrize("name", GRIDS)
def test_check_mesh_finds_no_fault(name: str, folder: Path) -> None:
    path = written(name, "/case.foam", folder)
    message = run("checkMesh", "-case", str(path.parent), "-allTopology", folder=folder)
    assert "***" not in message
    assert "Mesh OK." in message
    boundary = (path.parent / "constant" / "polyMesh" / "boundary").read_text().partition("}")[2].split()
    types = {boundary[k - 1]: boundary[k + 2].strip(";") for k, word in enumerate(boundary) if word == "{"}
    assert types == PATCHES[name]


@pytest.mark.client("cgnscheck")
@pytest.mark.parametrize("name", GRIDS)
def test_cgnscheck_finds_neither_errors_nor_warnings(name: str, folder: Path) -> None:
    message = run("cgnscheck", str(written(name, ".cgns", folder)), folder=folder)
    assert "ERROR" not in message.upper().replace("0 ERRORS", "")
    assert "WARNING" not in message.upper().replace("0 WARNINGS", "")
