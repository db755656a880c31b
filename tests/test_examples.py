"""The worked examples of every ``--help`` do what they say."""

import json
import os
import re
import runpy
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from blade_row import BLADES, write_row
from command_lines import run_line, smaller
from spatial_shapes import box

from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.blocks.revolve import Revolution, revolved
from meshonet_cli.commands import COMMANDS

ROOT = Path(__file__).parents[1]
EXAMPLES = [(command.name, example) for command in COMMANDS for example in command.loaded()[1]]
SLOW = ("train",)  # an hour; here it only has to get as far as asking for its dataset


def test_the_domains_say_how_they_are_written() -> None:
    program = [sys.executable, "examples/domains/domains.py", "--help"]
    done = subprocess.run(program, cwd=ROOT, capture_output=True, text=True, check=True)
    assert "usage: domains.py [-h] folder" in done.stdout
    assert "writes each as GeoJSON into FOLDER" in done.stdout


def test_the_tube_bank_has_the_pitches_that_are_asked_for(tmp_path: Path) -> None:
    program = [sys.executable, "examples/tube-bank/bank.py", str(tmp_path / "bank.geojson")]
    subprocess.run([*program, "--across", "2", "--along", "1.25", "--diameter", ".02"], cwd=ROOT, check=True)
    shape = json.loads((tmp_path / "bank.geojson").read_text())
    outer, tube = (np.array(ring) for ring in shape["geometry"]["coordinates"])
    assert np.ptp(outer, axis=0) == pytest.approx([2 * 1.25 * 0.02, 2 * 0.02])
    assert np.ptp(tube, axis=0) == pytest.approx([0.02, 0.02])
    assert set(shape["properties"]["names"][0]) == {"left", "right", "bottom", "top", "tubes"}


@pytest.fixture
def folder(inputs: Path, tmp_path: Path) -> Path:
    """The inputs in a folder of their own, so that one example cannot live on what another left behind."""
    return Path(shutil.copytree(inputs, tmp_path / "here"))


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the examples take for granted: airfoils, a channel, grids."""
    made = tmp_path_factory.mktemp("examples")
    x = 0.5 * (1 + np.cos(np.linspace(0, np.pi, 41)))
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    points = np.concatenate([np.stack([x, half], axis=-1), np.stack([x, -half], axis=-1)[-2::-1]])
    rows = "\n".join(f"{px:.6f} {py:.6f}" for px, py in points)
    (made / "airfoils").mkdir()
    for name in ("airfoil.dat", "airfoils/one.dat", "airfoils/two.dat"):
        (made / name).write_text(f"section\n{rows}\n")
    for name, (scale, dx, dy) in {"main.dat": (1.0, 0.0, 0.0), "flap.dat": (0.3, 1.05, -0.1)}.items():
        placed = "\n".join(f"{scale * px + dx:.6f} {scale * py + dy:.6f}" for px, py in points)
        (made / name).write_text(f"section\n{placed}\n")
    outer, hole = [[0, 0], [3, 0], [3, 2], [0, 2], [0, 0]], [[1, 1], [1, 1.4], [1.4, 1.4], [1.4, 1], [1, 1]]
    plate = {"type": "Polygon", "coordinates": [outer, hole]}
    (made / "plate.geojson").write_text(json.dumps(plate))
    for name in ("wing.cgns", "box.xyz"):
        Grid((Block(box()),)).write(made / name)
    with zipfile.ZipFile(made / "airfoils.zip", "w") as archive:
        archive.write(made / "airfoils" / "one.dat", "naca0012.dat")
    section = '[[sections]]\nairfoil = "airfoil.dat"\nchord = {}\nz = {}\n'
    (made / "wing.toml").write_text(section.format(1, 0) + section.format(0.5, 2) + "sweep = 20\n")
    bend = "[[pieces]]\nline = 2\n[[pieces]]\narc = 90\nradius = 2\ntowards = [0, 1, 0]\n"
    (made / "bend.toml").write_text(bend)
    write_row(made).rename(made / "rotor.toml")
    shutil.copy(ROOT / "examples" / "aircraft" / "jet.toml", made / "aircraft.toml")
    square = np.stack(np.meshgrid([0.0, 1.0], [1.0, 1.5, 2.0], indexing="ij"), axis=-1)
    walls = (Patch("hub", "south", 0, 1, kind="wall"), Patch("shroud", "north", 0, 1, kind="wall"))
    revolved(Grid((Block(square),), walls), Revolution(360.0 / BLADES, 3)).write(made / "rotor.cgns")
    cell = np.stack(np.meshgrid(np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 5), indexing="ij"), axis=-1)
    periods = [
        Connection(0, low, ((0, 4),), 0, high, ((0, 4),), (1,), Motion(shift))
        for low, high, shift in (("west", "east", (1.0, 0.0)), ("south", "north", (0.0, 1.0)))
    ]
    Grid((Block(cell),), (), tuple(periods)).write(made / "cell.cgns")
    (made / "path.csv").write_text("0,0,0\n9,0,0\n18,5,1\n")
    (made / "duct.csv").write_text("0,0\n1,0.2\n2,0\n2,1\n0,1\n")
    assert run_line("meshonet layout plate.geojson -o plate.json", made).returncode == 0
    for name in ("grid.vts", "other.vts"):
        assert run_line(f"meshonet tfi airfoil.dat --res 120x60 -o {name}", made).returncode == 0
    (made / "grids").mkdir()
    for name in ("a.vts", "b.vts"):
        shutil.copy(made / "grid.vts", made / "grids" / name)
    return made


@pytest.mark.parametrize(("command", "example"), EXAMPLES, ids=[example for _, example in EXAMPLES])
def test_the_examples_of_the_help_work(folder: Path, command: str, example: str) -> None:
    done = run_line(smaller(example), folder)
    if command in SLOW:
        assert done.returncode == 2
        assert done.stderr.startswith("error: ")
        assert "--help" not in done.stderr  # that would be an error of usage
    else:
        judged = "--profile" in example and done.returncode == 1 and "gate not met" in done.stderr
        assert done.returncode == 0 or judged, done.stderr
        assert "error" not in done.stderr


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_help_shows_its_examples(folder: Path, command: object) -> None:
    name, examples = command.name, command.loaded()[1]  # type: ignore[attr-defined]
    shown = run_line(f"meshonet {name} --help", folder).stdout
    assert shown == run_line(f"meshonet {name} -h", folder).stdout
    assert examples
    for example in examples:
        assert f"  {example}\n" in shown
    assert any(
        example.startswith(f"meshonet {name}") or f" meshonet {name} " in example for example in examples
    )


def test_the_wall_that_is_optimised_has_less_skewed_cells_and_its_throat(tmp_path: Path) -> None:
    output = tmp_path / "throat.vts"
    script = ROOT / "examples" / "shape-optimisation" / "throat.py"
    command = [sys.executable, str(script), "--steps", "6", "-o", str(output)]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=True)
    first, last = (float(word) for word in re.findall(r"0\.\d+", done.stdout))
    assert last < 0.95 * first
    top = next(read_grids(str(output))).nodes[:, -1]
    assert top[30] == pytest.approx((1.5, 0.6))
    assert top[0, 1] == top[-1, 1] == pytest.approx(1.0)


def test_the_section_that_is_stiffest_in_torsion_is_the_disc(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch")
    script = str(ROOT / "examples" / "shape-optimisation" / "torsion.py")
    results = []
    for words in (["3"], ["3", "--finite-differences"], ["12"]):
        monkeypatch.setattr(sys, "argv", [script, "--nodes", "5", "--steps", *words])
        runpy.run_path(script, run_name="__main__")
        results.append([float(word) for word in re.findall(r"\d\.\d{4,5}", capsys.readouterr().out)])
    assert results[0] == pytest.approx(results[1], abs=2e-3)  # both ways the same shape
    stiffness, disc, least, most = results[2]
    assert 0.9 * disc < stiffness < disc  # of a polygon of 16 sides, on 4 x 4 elements
    assert 0.93 < least < most < 1.07
