"""What reports say of growth is what `quality` finds, whatever the kind of grid."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet import read

SQUARES = "POLYGON ((0 0, 6 0, 6 4, 0 4, 0 0), (2 1, 2 2, 3 2, 3 1, 2 1))"
WING = "".join(f'[[sections]]\nairfoil = "naca:0012"\nchord = 1\nz = {z}\n' for z in (0, 2))
BLADE = 'kind = "blade"\n' + WING
KINDS = {  # what is made, the growth that it is to keep, and whether it does along all grid lines
    "O grid": ("infer naca:0012 --first-cell 1e-4 --growth 1.2", 1.2, False),
    "C grid": ("infer naca:0012-sharp --topology c --first-cell 1e-4 --growth 1.2", 1.2, True),
    "C-H grid": ("infer naca:0012 --topology c --first-cell 1e-4 --growth 1.2", 1.2, True),
    "four sides": ("solve-pde duct.csv --res 33x41 --first-cell 5e-3 --growth 1.2", 1.2, True),
    "blocks": ("solve-pde squares.wkt --first-cell 1e-2 --growth 1.08 --cells 3000", 1.08, False),
    "cascade": ("infer naca:0012 --pitch 0,0.9 --first-cell 1e-3 --growth 1.08 --cells 4000", 1.08, False),
    "wing": ("stack wing.toml --around 33 --span 9 --first-cell 1e-2 --far-field 5", 1.2, False),
    "blade": ("stack blade.toml --around 33 --span 5 --first-cell 1e-2 --far-field 5", 1.2, False),
    "pipe": ("sweep circle:0.5 path.txt --around 200 --first-cell .05 --growth 1.1", 1.1, False),
}


@pytest.fixture
def inputs(tmp_path: Path) -> Path:
    x = np.linspace(0.0, 2.0, 41)
    floor, roof = np.stack([x, 0.1 * np.sin(x)], axis=1), np.stack([x, 1.0 + 0.0 * x], axis=1)
    ring = np.concatenate([floor, roof[::-1]])
    np.savetxt(tmp_path / "duct.csv", ring, delimiter=",")
    (tmp_path / "squares.wkt").write_text(SQUARES)
    (tmp_path / "wing.toml").write_text(WING)
    (tmp_path / "blade.toml").write_text(BLADE)
    (tmp_path / "path.txt").write_text("0 0 0\n0 0 2\n")
    return tmp_path


def largest_step_ratio(path: Path) -> float:
    """Return the largest ratio of steps along the lines of the blocks of a file, apart from interfaces."""
    largest = []
    for block in read(path).blocks:
        for axis in range(len(block.counts)):
            steps = np.linalg.norm(np.diff(np.moveaxis(block.nodes, axis, 0), axis=0), axis=-1)
            change = steps[1:] / steps[:-1]
            largest.append(np.maximum(change, 1.0 / change).max())
    return float(max(largest))


@pytest.mark.parametrize("kind", KINDS)
def test_growth_beyond_its_limit_is_in_the_report_and_no_other(
    meshonet: Meshonet, inputs: Path, kind: str
) -> None:
    words, limit, keeps = KINDS[kind]
    made = meshonet(*words.split(), "-o", "grid.cgns")
    assert made.code == 0, made.err
    reported = re.findall(r"growth ratio is (\S+), along (\S+) at .*, above the limit of ([0-9.]+)", made.err)
    judged = meshonet("quality", "grid.cgns", "--fail-on", f"growth>{limit}", "--json")
    figure = re.findall(r"growth is (\S+) along (\S+) at", judged.err)
    steps = largest_step_ratio(inputs / "grid.cgns")
    assert keeps == (not reported) == (judged.code == 0) == (steps <= limit * (1.0 + 1e-6))
    if reported:
        value, along, growth = reported[0]
        assert float(value) == pytest.approx(steps, abs=6e-4)
        assert float(value) == pytest.approx(float(figure[0][0]), abs=6e-4)
        assert along == figure[0][1]
        assert float(growth) == limit


def test_a_jump_along_a_wall_is_noted_without_a_limit_of_growth(meshonet: Meshonet, inputs: Path) -> None:
    corners = np.array([[1.0, 0.0], [1.0, 0.999], [0.999, 1.0], [0.0, 1.0], [0.0, 0.0]])
    for cut, noted in (1.0, False), (1e3, True):
        corners[2, 0] = corners[1, 1] = 1.0 - 0.2 / cut
        np.savetxt(inputs / "plate.csv", np.concatenate([corners, corners[:1]]), delimiter=",")
        made = meshonet("infer", "plate.csv", "--res", "161x41", "--topology", "o", "-o", "plate.cgns")
        assert made.code == 0, made.err
        note = re.search(r"cells along wall jump in size by a factor of (\S+) at \((\S+), (\S+)\)", made.err)
        assert (note is not None) is noted
        if note:
            wall = read(inputs / "plate.cgns").nodes[:, 0]
            steps = np.hypot(*np.diff(wall, axis=0).T)
            ratios = np.maximum(steps[1:] / steps[:-1], steps[:-1] / steps[1:])
            assert float(note[1]) == pytest.approx(ratios.max(), rel=0.01)
            where = [float(x) for x in note.groups()[1:]]
            assert where == pytest.approx(wall[1 + np.argmax(ratios)], rel=1e-5)
