"""OpenFOAM's own check of a case."""

import os
import subprocess
from pathlib import Path


def check_mesh(case: Path, *words: str) -> str:
    """Return what checkMesh says of the folder `case`, which it must take for a mesh without moved sides."""
    done = subprocess.run(
        ["checkMesh", "-case", str(case), "-allTopology", *words],
        capture_output=True,
        text=True,
        timeout=60,
        env=os.environ | {"WM_PROJECT_DIR": "/usr/share/openfoam"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "separation" not in done.stderr
    return done.stdout
