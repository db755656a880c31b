"""The worked cases of OpenFOAM give the forces that finer grids and other codes give."""

import math
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def printed(name: str, folder: Path, *variables: str) -> list[str]:
    """Return the words that `make` prints in a copy of an example, the same copy for a second run."""
    script = folder / "meshonet"
    script.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m meshonet_cli "$@"\n')
    script.chmod(0o755)
    copy = shutil.copytree(ROOT / "examples" / name, folder / "example", dirs_exist_ok=True)
    command = ["make", "-s", *variables, f"MESHONET={script}", f"PYTHON={sys.executable}"]
    done = subprocess.run(command, cwd=copy, capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def value_of(word: str, words: list[str]) -> float:
    return float(words[words.index(word) + 1])


@pytest.mark.client("simpleFoam")
@pytest.mark.parametrize(
    ("angle", "name", "value", "part"), [(0, "Cd", 0.1195, 0.015), (4, "Cl", 0.2055, 0.03)]
)
def test_the_forces_on_naca_0012_are_right(
    angle: int, name: str, value: float, part: float, tmp_path: Path
) -> None:
    words = printed("naca0012-openfoam", tmp_path, f"ANGLE={angle}")
    assert value_of(name, words) == pytest.approx(value, rel=part)


@pytest.mark.client("simpleFoam")
def test_drag_and_lift_of_the_cylinder_in_a_channel_are_the_published_ones(tmp_path: Path) -> None:
    """Schaefer and Turek's benchmark 2D-1, values of FEATFLOW, on blocks of at most 25,000 cells."""
    words = printed("cylinder-openfoam", tmp_path, "CELLS=20000")
    assert value_of("Cd", words) == pytest.approx(5.57953523384, rel=0.01)
    assert value_of("Cl", words) == pytest.approx(0.010618948146, rel=0.05)


@pytest.mark.client("simpleFoam")
def test_the_pressure_that_a_pipe_bend_loses_is_that_of_a_grid_twice_as_fine(tmp_path: Path) -> None:
    sizes = ("CELLS=160", "PLANES=41"), ("CELLS=640", "PLANES=81")
    coarse, fine = (value_of("pressure", printed("pipe-bend-openfoam", tmp_path, *size)) for size in sizes)
    assert coarse == pytest.approx(fine, rel=0.03)
    assert fine > 32 * 0.01 * (2 + math.pi + 3)


@pytest.mark.client("SRFSimpleFoam")
def test_flow_through_a_rotor_converges_with_both_kinds_of_periodic_sides(tmp_path: Path) -> None:
    pressures = []
    for kind in ("cyclic", "cyclicAMI"):
        words = printed("blade-row", tmp_path, f"TYPE={kind}", "ITERATIONS=30")
        first, last = (float(words[k + 1]) for k, word in enumerate(words) if word == "errors")
        assert last < first / 20
        pressures.append(value_of("pressure", words))
    assert pressures[0] == pytest.approx(pressures[1], rel=2e-3)
