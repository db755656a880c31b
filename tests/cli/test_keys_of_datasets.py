"""Samples of a dataset are called like their files: tables, JSON and datasets are joined by one key."""

from pathlib import Path

import h5py
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids
from meshonet.geometry.shapes.airfoil.naca import naca_points

RES = ("--res", "60x12")


@pytest.fixture
def sections() -> list[Path]:
    """Three files, two of which share a stem, with other names in their first lines."""
    paths = [Path("root.dat"), Path("tip.dat"), Path("new/tip.dat")]
    Path("new").mkdir()
    for path, digits in zip(paths, ("0012", "2412", "4412"), strict=True):
        lines = [f"{x:.6f} {y:.6f}" for x, y in naca_points(digits).tolist()]
        path.write_text("\n".join([f"Section {digits} (normalized)", *lines]) + "\n")
    return paths


def texts(path: str, name: str) -> list[str]:
    with h5py.File(path) as file:
        return list(file[name].asstr())


@pytest.mark.parametrize("command", ["infer", "sample-boundary"])
def test_names_are_stems_each_once_and_first_lines_are_titles(
    meshonet: Meshonet, sections: list[Path], command: str
) -> None:
    assert meshonet(command, *sections, "naca:0015", *RES, "-o", "all.h5", "-q").code == 0
    assert texts("all.h5", "names") == ["root", "tip", "tip-2", "NACA 0015"]
    headers = [f"Section {digits} (normalized)" for digits in ("0012", "2412", "4412")]
    assert texts("all.h5", "titles") == [*headers, ""]


@pytest.mark.parametrize("words", [("--part-size", "3"), ("--jobs", "2"), ()])
def test_json_of_both_commands_has_the_key_of_the_dataset(
    meshonet: Meshonet, sections: list[Path], words: tuple[str, ...]
) -> None:
    made = meshonet("infer", *sections, *RES, *words, "-o", "all.h5", "--json").objects
    measured = meshonet("quality", "all.h5", "--json").objects
    assert [one["name"] for one in made] == texts("all.h5", "names") == [one["name"] for one in measured]


def test_a_dataset_made_of_a_dataset_keeps_keys_and_titles(meshonet: Meshonet, sections: list[Path]) -> None:
    assert meshonet("sample-boundary", *sections[:2], *RES, "-o", "all.h5", "-q").code == 0
    assert meshonet("tfi", "all.h5", "-o", "grids.h5", "-q").code == 0
    assert meshonet("solve-pde", "grids.h5#1", "--max-cycles", "1", "-o", "one.h5", "-q").code == 0
    for name in ("names", "titles"):
        assert texts("grids.h5", name) == texts("all.h5", name)
        assert texts("one.h5", name) == texts("all.h5", name)[1:]
    (grid,) = read_grids("one.h5")
    assert (grid.name, grid.origin.title) == ("tip", "Section 2412 (normalized)")
