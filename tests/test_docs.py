"""Documents cannot drift: generated pages are current, links lead somewhere, the README's commands run."""

from __future__ import annotations

import importlib.util
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from meshonet.solvers.neural.weights import described

ROOT = Path(__file__).parents[1]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")])


def pages() -> object:
    """docs/make_pages.py as a module: it is a script, not part of a package."""
    spec = importlib.util.spec_from_file_location("make_pages", ROOT / "docs" / "make_pages.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_models_page_is_current() -> None:
    assert (ROOT / "docs" / "models.md").read_text() == pages().models_page(), "run make docs"  # type: ignore[attr-defined]


def test_curves_have_a_row_for_every_epoch_of_their_model() -> None:
    found = sorted((ROOT / "docs" / "curves").glob("*.csv"))
    assert found
    for path in found:
        rows = path.read_text(encoding="utf-8").splitlines()
        assert "held_out_loss" in rows[0].split(",")
        first = path.stem == "quad-first"  # the first of two runs, whose model is not kept
        epochs = len(rows) - 1 if first else described(path.stem)["recipe"]["epochs"]
        assert [row.split(",")[0] for row in rows[1:]] == [str(k + 1) for k in range(epochs)], path.name


@pytest.mark.parametrize("command", ["tfi", "solve-pde", "infer", "train"])
def test_the_reference_is_what_help_prints(command: str) -> None:
    words = [sys.executable, "-m", "meshonet_cli", command, "--help"]
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "100"}
    printed = subprocess.run(words, env=environment, capture_output=True, text=True, timeout=60).stdout
    assert f"## {command}\n\n```text\n{printed.rstrip()}\n```\n" in (ROOT / "docs" / "cli.md").read_text()


def test_the_reference_has_both_halves_of_switches() -> None:
    page = (ROOT / "docs" / "cli.md").read_text()
    assert page.count("--repair / --no-repair") == 3
    assert "--slide / --no-slide" in page


def test_the_families_page_is_current() -> None:
    assert (ROOT / "docs" / "families.md").read_text() == pages().families_page(), "run make docs"  # type: ignore[attr-defined]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_to_files(page: Path) -> None:
    links = re.findall(r"\]\(([^)#]+?)(?:#[^)]*)?\)", page.read_text())
    missing = [link for link in links if "://" not in link and not (page.parent / link).exists()]
    assert not missing


def readme_commands() -> list[str]:
    """Every `meshonet ...` line of the README's blocks."""
    blocks = re.findall(r"```\n(.*?)```", (ROOT / "README.md").read_text(), flags=re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.startswith("meshonet ")]


def test_the_readmes_commands_run_in_their_order(tmp_path: Path) -> None:
    """On a folder that holds what they name: an airfoil file, a folder of two, a duct of four blocks."""
    section = (ROOT / "examples" / "naca2412.dat").read_text()
    (tmp_path / "airfoil.dat").write_text(section)
    (tmp_path / "airfoils").mkdir()
    for name in ("a", "b"):
        (tmp_path / "airfoils" / f"{name}.dat").write_text(section)
    blocks = ["0 0\n1 0.1\n2 0", "2 0\n2 1", "0 1\n1 1.2\n2 1", "0 0\n0 1"]
    (tmp_path / "duct.csv").write_text("\n\n".join(blocks) + "\n")
    program = f"{shlex.quote(sys.executable)} -m meshonet_cli"
    for line in readme_commands():
        shell = re.sub(r"\bmeshonet (?=[a-z])", f"{program} ", line)
        done = subprocess.run(shell, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=120)  # noqa: S602
        gated = "--fail-on" in line and done.returncode == 1
        assert done.returncode == 0 or gated, f"{line}\n{done.stderr}"


def page_commands(name: str) -> list[str]:
    blocks = re.findall(r"```\n(.*?)```", (ROOT / "docs" / name).read_text(), flags=re.DOTALL)
    return [line for block in blocks for line in block.splitlines() if line.startswith("meshonet ")]


@pytest.mark.parametrize("page", ["quality.md", "grid-convergence.md"])
def test_the_commands_of_a_page_run(page: str, tmp_path: Path) -> None:
    shutil.copy(ROOT / "examples" / "grid-convergence" / "ellipse.csv", tmp_path)
    program = f"{shlex.quote(sys.executable)} -m meshonet_cli"
    before = ["meshonet tfi ellipse.csv --res 41x21 -o grid.vts"]
    before += [f"meshonet tfi grid.vts -o {name}.h5" for name in ("predicted", "solved")]
    commands = page_commands(page)
    assert commands
    for line in [*before, *commands]:
        shell = re.sub(r"\bmeshonet (?=[a-z])", f"{program} ", line)
        done = subprocess.run(shell, shell=True, cwd=tmp_path, capture_output=True, text=True, timeout=120)  # noqa: S602
        assert done.returncode == 0, f"{line}\n{done.stderr}"


def test_the_example_makefile_grids_a_folder_and_judges_it(tmp_path: Path) -> None:
    (tmp_path / "airfoils").mkdir()
    for name in ("one", "two"):
        (tmp_path / "airfoils" / f"{name}.dat").write_text((ROOT / "examples" / "naca2412.dat").read_text())
    (tmp_path / "Makefile").write_text((ROOT / "examples" / "batch" / "Makefile").read_text())
    words = ["make", "AIRFOILS=airfoils", "RES=60", f"MESHONET={sys.executable} -m meshonet_cli"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "grids").iterdir()} == {"one.vts", "two.vts"}
    assert (tmp_path / "quality.json").read_text().count('"folded"') >= 2
