"""The worked example of docs/guide/grid-convergence.md on smaller grids: second order, the right limit."""

import math
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "examples" / "grid-convergence"


def run(folder: Path, *words: str) -> str:
    done = subprocess.run(
        [sys.executable, *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_family_converges_with_the_order_of_the_elements(tmp_path: Path) -> None:
    words = [
        "--topology",
        "o",
        "--far-field",
        "5",
        "--res",
        "41x21",
        "--refine",
        "2",
        "--tol",
        "1e-9",
        "-o",
        "g1.vts",
    ]
    run(tmp_path, "-m", "meshonet_cli", "solve-pde", str(EXAMPLE / "ellipse.csv"), *words)
    for k in ("2", "4"):
        run(tmp_path, "-m", "meshonet_cli", "convert", "g1.vts", f"g{k}.vts", "--coarsen", k)
    table = run(tmp_path, str(EXAMPLE / "convergence.py"), "g1.vts", "g2.vts", "g4.vts").splitlines()
    assert table[0] == "grid, C, order, extrapolated, GCI"
    value, order, limit, index = (float(word) for word in table[1].split(", ")[1:])
    exact = 2 * math.pi / math.log(2 * 5 / 0.75)
    assert order == pytest.approx(2, abs=0.02)
    assert limit == pytest.approx(exact, rel=1e-5)
    assert abs(value - exact) / exact < index < 5e-4
