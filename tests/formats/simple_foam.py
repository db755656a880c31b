"""Cases of steady laminar flow for OpenFOAM's simpleFoam, and their runs."""

import os
import subprocess
from collections.abc import Mapping
from pathlib import Path

HEAD = "FoamFile {{ version 2.0; format ascii; class {}; object {}; }}\n"
SETTINGS = {
    "constant/turbulenceProperties": ("dictionary", "simulationType laminar;"),
    "system/fvSchemes": ("dictionary", "ddtSchemes { default steadyState; } "
    "gradSchemes { default Gauss linear; } "
                         "divSchemes { default none; div(phi,U) bounded Gauss linearUpwind grad(U); "
                         "div((nuEff*dev2(T(grad(U))))) Gauss linear; } "
                         "laplacianSchemes { default Gauss linear corrected; } "
                         "interpolationSchemes { default linear; } snGradSchemes { default corrected; }"),
    "system/fvSolution": ("dictionary", "solvers { p { solver GAMG; smoother GaussSeidel; "
    "tolerance 1e-9; relTol 0.05; } "
                          "U { solver smoothSolver; smoother GaussSeidel; tolerance 1e-10; relTol 0.1; } } "
                          "SIMPLE { consistent yes; pRefCell 0; pRefValue 0; "
    "residualControl { p 1e-5; U 1e-6; } } "
                          "relaxationFactors { equations { U 0.9; } }"),
}  # fmt: skip


def converged(
    case: Path, files: Mapping[str, tuple[str, str]], viscosity: float, functions: str = "", steps: int = 600
) -> str:
    """Write `files` and settings into a case, and return what simpleFoam printed until it converged."""
    control = (
        f"application simpleFoam; startFrom startTime; startTime 0; stopAt endTime; endTime {steps}; "
        f"deltaT 1; writeControl timeStep; writeInterval {steps}; {functions}"
    )
    properties = f"transportModel Newtonian; nu {viscosity};"
    more = {
        "system/controlDict": ("dictionary", control),
        "constant/transportProperties": ("dictionary", properties),
    }
    for name, (kind, text) in {**SETTINGS, **more, **files}.items():
        (case / name).parent.mkdir(exist_ok=True)
        (case / name).write_text(HEAD.format(kind, Path(name).name) + text + "\n")
    done = subprocess.run(
        ["simpleFoam", "-case", str(case)], capture_output=True, text=True, timeout=300,
        env=os.environ | {"WM_PROJECT_DIR": "/usr/share/openfoam"},
    )  # fmt: skip
    assert "SIMPLE solution converged" in done.stdout, done.stdout[-2000:] + done.stderr
    return done.stdout
