"""Flow around a section with a base of 8 % of the chord: C grids that keep the base, in OpenFOAM."""

from pathlib import Path

import numpy as np
import pytest
from check_mesh import check_mesh
from simple_foam import converged

import meshonet
from meshonet.geometry.blocks.transform import coarser_grid
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil

VISCOSITY = 0.02
"""At a Reynolds number of 50 the wake is steady; at 100 it slowly begins to oscillate, at 200 it does."""
FORCES = (  # coefficients of a section with a chord of 1
    "functions { forces { type forceCoeffs; libs (forces); writeControl timeStep; patches (wall); "
    "rho rhoInf; rhoInf 1; magUInf 1; lRef 1; Aref 1; liftDir (0 1 0); dragDir (1 0 0); pitchAxis (0 0 1); "
    "CofR (0.25 0 0); } }"
)
CASE = {
    "0/U": ("volVectorField", "dimensions [0 1 -1 0 0 0 0]; internalField uniform (1 0 0); boundaryField { "
            "wall { type noSlip; } farfield { type freestreamVelocity; freestreamValue uniform (1 0 0); } "
            "frontAndBack { type empty; } }"),
    "0/p": ("volScalarField", "dimensions [0 2 -2 0 0 0 0]; internalField uniform 0; boundaryField { "
            "wall { type zeroGradient; } farfield { type freestreamPressure; freestreamValue uniform 0; } "
            "frontAndBack { type empty; } }"),
}  # fmt: skip


def flatback() -> Airfoil:
    x = 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, 81)))
    poly = 0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4
    half = 0.9 * poly + 0.04 * x**3
    return Airfoil(np.concatenate([np.stack([x, half], axis=1)[::-1], np.stack([x, -half], axis=1)[1:]]))


@pytest.mark.client("simpleFoam")
def test_drag_converges_over_three_levels(tmp_path: Path) -> None:
    finest = meshonet.grid(flatback(), topology="c", first_cell=2e-3, growth=1.2, far_field=10, res=(257, 41))
    assert len(finest.blocks) == 2  # the base stays
    drags = [drag(tmp_path / f"level{k}", coarser_grid(finest, k)) for k in (8, 4, 2)]
    assert drags[2] == pytest.approx(drags[1], rel=0.02)
    assert abs(drags[2] - drags[1]) < abs(drags[1] - drags[0])


def drag(case: Path, grid: meshonet.Grid) -> float:
    case.mkdir()
    grid.write(case / "flatback.foam")
    assert "Mesh OK." in check_mesh(case)
    said = converged(case, CASE, VISCOSITY, FORCES, steps=2000)
    return float(said.rpartition("Cd ")[2].split(":")[1].split()[0])
