"""Domains with periodic sides, from the file to the formats that know such sides, and to a flow solver."""

import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from check_mesh import check_mesh
from periodic_domains import BOTH, HEIGHT, LENGTH, write_bank
from simple_foam import converged

import meshonet
from meshonet.geometry.blocks.grid import Grid

VISCOSITY = 0.02
SIDES = '"left|right|bottom|top" { type cyclic; } frontAndBack { type empty; }'
CASE = {
    "0/U": ("volVectorField", "dimensions [0 1 -1 0 0 0 0]; internalField uniform (1 0 0);"
            f'boundaryField {{ "tube.*" {{ type noSlip; }} {SIDES} }}'),
    "0/p": ("volScalarField", "dimensions [0 2 -2 0 0 0 0]; internalField uniform 0;"
            f'boundaryField {{ "tube.*" {{ type zeroGradient; }} {SIDES} }}'),
    "constant/fvOptions": ("dictionary", "force { type meanVelocityForce; active yes; selectionMode all; "
                           "fields (U); Ubar (1 0 0); relaxation 0.2; }"),
}  # fmt: skip


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bank") / "bank.geojson"
    write_bank(path)
    return path


def made(file: Path, name: str, *words: str) -> Path:
    path = file.parent / name
    path.parent.mkdir(exist_ok=True)
    command = [sys.executable, "-m", "meshonet_cli", "infer", str(file), "-q", "-o", str(path), *words]
    cells = [] if "--cells" in words else ["--cells", "1500"]
    done = subprocess.run([*command, *cells], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="module")
def bank(file: Path) -> Grid:
    """The grid of the file, made once."""
    grid = meshonet.read(made(file, "property.h5"))
    assert isinstance(grid, Grid)
    return grid


def test_an_option_says_what_the_property_does(file: Path, bank: Grid) -> None:
    write_bank(file.parent / "plain.geojson", None)
    pairs = [word for pair in BOTH for word in ("--periodic", ",".join(pair))]
    other = meshonet.read(made(file.parent / "plain.geojson", "option.h5", *pairs))
    assert bank.connections == other.connections
    for block, like in zip(bank.blocks, other.blocks, strict=True):
        np.testing.assert_array_equal(block.nodes, like.nodes)


def test_gmsh_has_the_pairs_with_their_nodes(bank: Grid, tmp_path: Path) -> None:
    bank.write(tmp_path / "bank.msh")
    mesh = meshio.read(tmp_path / "bank.msh")
    assert len(mesh.gmsh_periodic) == 2
    for (_, _, affine, pairs), shift in zip(mesh.gmsh_periodic, ((LENGTH, 0), (0, HEIGHT)), strict=True):
        moved, master = mesh.points[pairs[:, 0]], mesh.points[pairs[:, 1]]
        np.testing.assert_array_equal(master[:, :2] + shift, moved[:, :2])
        np.testing.assert_array_equal(np.reshape(affine, (4, 4))[:2, 3], shift)


def test_su2_has_the_line_of_its_configuration(bank: Grid, tmp_path: Path) -> None:
    bank.write(tmp_path / "bank.su2")
    text = (tmp_path / "bank.su2").read_text().splitlines()
    assert text[1] == (
        "% MARKER_PERIODIC= ( left, right, 0, 0, 0, 0, 0, 0, 2, 0, 0, "
        "bottom, top, 0, 0, 0, 0, 0, 0, 0, 1.2, 0 )"
    )


@pytest.mark.client("cgnscheck")
def test_cgnscheck_finds_periodic_interfaces_without_a_fault(file: Path) -> None:
    path = made(file, "bank.cgns")
    done = subprocess.run(["cgnscheck", "-v", str(path)], capture_output=True, text=True, timeout=60)
    message = done.stdout + done.stderr
    assert done.returncode == 0
    assert "ERROR" not in message
    assert "WARNING" not in message
    grid = meshonet.read(path)
    across = sum(each.transform is not None for each in grid.connections)
    assert message.count("checking periodic property") == 2 * across > 0


@pytest.mark.client("simpleFoam")
def test_flow_through_a_staggered_bank_is_that_on_a_finer_grid(file: Path) -> None:
    gradients = [flow(file, cells) for cells in (2000, 8000)]
    assert gradients[0] == pytest.approx(gradients[1], rel=0.02)


def flow(file: Path, cells: int) -> float:
    """Return the pressure gradient of a mean velocity of 1 after simpleFoam has converged."""
    words = ["--first-cell", "5e-3", "--walls", "tube,tubes", "--cells", str(cells)]
    case = made(file, f"case{cells}/bank.foam", *words).parent
    message = check_mesh(case)
    assert "Mesh OK." in message
    assert (case / "constant/polyMesh/boundary").read_text().count("cyclic;") == 4
    said = converged(case, CASE, VISCOSITY)
    return float(said.rpartition("pressure gradient = ")[2].split()[0])
