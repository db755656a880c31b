"""Every option of every command, given nonsense: exit code 2, a line with the remedy, nothing written."""

import shutil
from pathlib import Path

import pytest
from command_line import Meshonet, dataset, duct

import meshonet as library
from meshonet_cli.app import application

INPUTS = {
    "sample-boundary": ("naca:0012", "--res", "41x11", "-o", "made.h5"),
    "tfi": ("naca:0012", "--res", "41x11", "-o", "made.vts"),
    "solve-pde": ("naca:0012", "--res", "41x11", "-o", "made.vts"),
    "infer": ("naca:0012", "--res", "41x11", "-o", "made.vts"),
    "quality": ("grid.vts",),
    "convert": ("grid.vts", "made.vts"),
    "plot": ("grid.vts", "-o", "made.png"),
    "models": (),
    "doctor": (),
    "layout": ("step.wkt", "-o", "made.json"),
    "stack": ("wing.toml", "--around", "49", "--span", "9", "--layers", "18", "-o", "made.h5"),
    "deform": ("grid.vts", "--shift", "south=0,-0.1", "-o", "made.h5"),
    "sweep": ("circle:0.5", "path.csv", "--around", "16", "-o", "made.h5"),
}
"""What each command does well with; train loads a library of its own first, and has tests of its own."""

NONSENSE = ("some words", "-7", "nan", "1e400", "1e-300", "9" * 30, "", "\udcff")
TAKES_WORDS = ("--output", "--log-csv")
"""Options that name a file or folder, and may be called anything."""


PARSERS = application().commands


def options(command: str) -> list[str]:
    """Every option of a command that takes a value."""
    parameters = PARSERS[command].params
    return [p.opts[-1] for p in parameters if p.opts[-1].startswith("--") and not p.is_flag]


CASES = [(command, option) for command in INPUTS for option in options(command) if option not in TAKES_WORDS]


def test_no_command_is_left_out() -> None:
    assert {*INPUTS, "train"} == set(PARSERS)


@pytest.fixture(scope="module")
def inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the commands do well with."""
    folder = tmp_path_factory.mktemp("inputs")
    duct_h5 = dataset(folder / "duct.h5", "quad", duct())
    library.tfi(duct_h5).write(folder / "grid.vts")
    (folder / "step.wkt").write_text("POLYGON ((0 0, 1 0, 1 1, 3 1, 3 2, 0 2, 0 0))")
    section = '[[sections]]\nairfoil = "naca:0012"\nchord = 1\nz = {}\n'
    (folder / "wing.toml").write_text(section.format(0) + section.format(1))
    (folder / "path.csv").write_text("0 0 0\n9 0 0\n18 3 0\n")
    return folder


@pytest.mark.parametrize(("command", "option"), CASES)
def test_nonsense_gets_a_line(
    meshonet: Meshonet, inputs: Path, tmp_path: Path, command: str, option: str
) -> None:
    shutil.copytree(inputs, tmp_path, dirs_exist_ok=True)
    refused = 0
    for value in NONSENSE:
        before = {path.name for path in tmp_path.iterdir()}
        done = meshonet(command, *INPUTS[command], option, value)
        message = f"{command} {option} {value!r}: {done.err}"
        assert "internal error" not in done.err, message
        assert done.code in (0, 2), message
        if done.code == 2:
            refused += 1
            assert done.err.startswith("error: "), message
            assert done.err.count("\n") == 1, message
            assert ";" in done.err, message  # what to do comes after what is wrong
            assert {path.name for path in tmp_path.iterdir()} == before, message
    assert refused >= 4, f"{command} {option} takes nearly anything"
