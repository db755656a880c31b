"""Documents cannot drift: generated pages are current, links lead somewhere, the README's commands run."""

import importlib.util
import json
import os
import re
import runpy
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from aircraft_surfaces import body_patch, wing_patches, written
from command_lines import run_line, smaller
from periodic_domains import write_bank
from printed import differences
from spatial_shapes import box, cubed_sphere, half_sphere

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.neural.registry import described

ROOT = Path(__file__).parents[1]
REFERENCE = ROOT / "docs" / "reference"
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
GENERATED = {"blocking", "cli", "families", "formats", "models"}
GUIDES = [
    page for page in PAGES if page.stem not in GENERATED and "benchmarks" not in page.relative_to(ROOT).parts
]
"""The pages written by hand."""


def path_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def pages() -> object:
    """docs/make_pages.py as a module: it is a script, not part of a package."""
    spec = importlib.util.spec_from_file_location("make_pages", ROOT / "docs" / "make_pages.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_models_page_is_current() -> None:
    assert (REFERENCE / "models.md").read_text() == pages().models_page(), "run make text"  # type: ignore[attr-defined]


def test_the_page_of_held_out_errors_is_current() -> None:
    page = (ROOT / "docs" / "benchmarks" / "models.md").read_text()
    assert page == pages().errors_page(), "run make text"  # type: ignore[attr-defined]


def test_the_formats_page_is_current() -> None:
    assert (REFERENCE / "formats.md").read_text() == pages().formats_page(), "run make text"  # type: ignore[attr-defined]


def test_curves_have_a_row_for_every_epoch_of_their_model() -> None:
    tables = sorted((ROOT / "docs" / "benchmarks" / "curves").glob("*.csv"))
    assert tables
    for path in tables:
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
    assert f"```text\n{printed.rstrip()}\n```\n" in (REFERENCE / "commands" / f"{command}.md").read_text()


def test_the_reference_has_both_halves_of_switches() -> None:
    pages = {page.stem: page.read_text() for page in (REFERENCE / "commands").glob("*.md")}
    repairing = {name for name, page in pages.items() if "--repair / --no-repair" in page}
    assert repairing == {"tfi", "solve-pde", "infer"}
    assert "--slide / --no-slide" in pages["solve-pde"]


def test_the_families_page_is_current() -> None:
    assert (REFERENCE / "families.md").read_text() == pages().families_page(), "run make text"  # type: ignore[attr-defined]


def test_the_page_of_the_files_of_blocking_is_current() -> None:
    page = (ROOT / "docs" / "development" / "blocking.md").read_text()
    assert page == pages().blocking_page(), "run make text"  # type: ignore[attr-defined]


@pytest.mark.parametrize("page", PAGES, ids=path_of)
def test_links_lead_to_files_and_headings(page: Path) -> None:
    for target, _, anchor in re.findall(r"\]\(([^)#\s]*)(#([^)]*))?\)", page.read_text()):
        path = page.parent / target if target else page
        assert "://" in target or path.exists(), target
        if anchor and "://" not in target:
            headings = re.findall(r"^#+ (.*)$", path.read_text(), flags=re.MULTILINE)
            slugs = [re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings]
            assert anchor in slugs, f"{target}#{anchor}"


def blocks(page: Path, language: str = "") -> list[str]:
    fences = re.findall(r"^```([^\n]*)\n(.*?)^```$", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    return [text for word, text in fences if word == language]


def commands(page: Path) -> list[str]:
    """Commands in the blocks of a page, and Python of a line; tutorials have a test of their own."""
    if page.parent.name == "tutorials":
        return []
    begun = ("meshonet ", "python -c ")
    return [line for block in blocks(page) for line in block.splitlines() if line.startswith(begun)]


@pytest.fixture
def inputs(all_inputs: Path, tmp_path: Path) -> Path:
    """A fresh folder of what the pages' commands name."""
    return shutil.copytree(all_inputs, tmp_path / "inputs")


@pytest.fixture(scope="module")
def all_inputs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Airfoil files, a duct of four blocks, domains, grids."""
    tmp_path = tmp_path_factory.mktemp("pages")
    section = (ROOT / "examples" / "naca2412.dat").read_text()
    (tmp_path / "airfoil.dat").write_text(section)
    write_bank(tmp_path / "bank.geojson", None)
    (tmp_path / "airfoils").mkdir()
    for name in ("a", "b"):
        (tmp_path / "airfoils" / f"{name}.dat").write_text(section)
    (tmp_path / "list.txt").write_text("airfoils/a.dat\nnaca:0012\n")
    with zipfile.ZipFile(tmp_path / "airfoils.zip", "w") as archive:
        archive.writestr("naca2412.dat", section)
    sides = ["0 0\n1 0.1\n2 0", "2 0\n2 1", "0 1\n1 1.2\n2 1", "0 0\n0 1"]
    (tmp_path / "duct.csv").write_text("\n\n".join(sides) + "\n")
    shutil.copy(ROOT / "examples" / "grid-convergence" / "ellipse.csv", tmp_path)
    for name, loop in domains(tmp_path).items():
        (tmp_path / name).write_text("\n".join(f"{x:.8f} {y:.8f}" for x, y in loop) + "\n")
    cubed_sphere().write(tmp_path / "wing.xyz")
    half_sphere().write(tmp_path / "m6.fmt")
    written(tmp_path / "model.xyz", [body_patch(), *wing_patches()])
    write_step(tmp_path / "wing.step")
    for name in ("duct.xyz", "box.xyz", "wing.cgns"):
        Grid((Block(box()),)).write(tmp_path / name)
    for page in GUIDES:
        for text in blocks(page, "toml"):
            name = re.match(r"# (\w+\.toml)\n", text)
            if name:
                (tmp_path / name[1]).write_text(text)
        for file, text in re.findall(r"`(\w+\.geojson)`:\n\n```json\n(.*?)```", page.read_text(), re.DOTALL):
            (tmp_path / file).write_text(text)
    for name in ("grid.vts", "predicted.h5", "solved.h5"):
        run(f"meshonet tfi ellipse.csv --res 41x21 -o {name}", tmp_path)
    return tmp_path


def write_step(path: Path) -> None:
    """Write a ball as a STEP file where Open Cascade is installed."""
    if importlib.util.find_spec("OCP") is None:
        return
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeSphere
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(BRepPrimAPI_MakeSphere(1.0).Shape(), STEPControl_AsIs)
    writer.Write(str(path))


def domains(folder: Path) -> dict[str, Any]:
    """Write the domains of examples/domains into a folder; return points of airfoils and a blade by file."""
    path = ROOT / "examples" / "domains" / "domains.py"
    module = runpy.run_path(str(path))
    module["write_all"](folder)
    _, main, flap = module["DOMAINS"]["two-elements"]()
    return {"main.dat": main, "flap.dat": flap, "blade.dat": module["moved"](main, 35.0, 1.0, 0.0, 0.0)}


def run(line: str, folder: Path) -> None:
    """Fail if a command does, except where a gate of its own is not met."""
    done = run_line(line, folder)
    gate = done.returncode == 1 and ("--fail-on" in line or "--profile" in line)
    assert done.returncode == 0 or gate, f"{line}\n{done.stderr}"


@pytest.mark.parametrize("page", [page for page in GUIDES if commands(page)], ids=path_of)
def test_the_commands_of_a_page_run_in_their_order(page: Path, inputs: Path) -> None:
    if any(".step" in line for line in commands(page)):
        pytest.importorskip("OCP")
    for line in commands(page):
        run(smaller(line), inputs)


@pytest.mark.parametrize(
    "page",
    [
        page
        for page in GUIDES
        if blocks(page, "python") and page.stem != "python" and page.parent.name != "tutorials"
    ],
    ids=path_of,
)
@pytest.mark.filterwarnings("default")
def test_the_python_of_a_page_runs(
    page: Path, inputs: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """And prints what is behind `# prints`; docs/reference/python.md has a test of its own."""
    text = "\n".join(blocks(page, "python"))
    if "import torch" in text:
        pytest.importorskip("torch")
    if ".step" in text:
        pytest.importorskip("OCP")
    monkeypatch.chdir(inputs)
    Path("of_the_page.py").write_text(text, encoding="utf-8")
    runpy.run_path("of_the_page.py", run_name="__main__")
    if shown := " ".join(re.findall(r"# prints (.*)", text)):
        unlike = differences(shown, " ".join(capsys.readouterr().out.split()))
        assert not unlike, "\n".join([f"not what is printed by\n{text}", *unlike])


@pytest.mark.parametrize("page", GUIDES, ids=path_of)
def test_pages_are_short(page: Path) -> None:
    prose = re.sub(r"```.*?```|^\|.*?$", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    assert len(prose.split()) < 800


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
    (tmp_path / "airfoils" / "broken.dat").write_text("no airfoil\n")
    (tmp_path / "grids" / "one.vts").unlink()
    (tmp_path / "quality.json").unlink()
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert (done.returncode, "broken.dat" in done.stderr) == (2, True)
    names = [json.loads(line)["input"] for line in (tmp_path / "quality.json").read_text().splitlines()]
    assert sorted(names) == ["grids/one.vts", "grids/two.vts"]


def paths_named(page: str) -> Iterator[tuple[str, str]]:
    """Paths in backticks, and the folder in the heading above."""
    folder = ""
    for line in page.splitlines():
        words = re.findall(r"`([a-z_/]+(?:/|\.py|\.md|\.pyi|\.pyx))`", line)
        if line.startswith("#"):
            folder = words[0] if words else ""
        yield from ((word, folder) for word in words)


@pytest.mark.parametrize("name", ["architecture", "changes", "stages"])
def test_every_path_of_the_pages_for_developers_is_there(name: str) -> None:
    """From the root, a package, or the folder that the heading names; NAME stands for what is added."""
    named = list(paths_named((ROOT / "docs" / "development" / f"{name}.md").read_text()))
    assert len(named) > 15
    roots = [ROOT / each for each in ("", "docs", "tests/formats", "meshonet_cli", "kernels")]
    missing = [
        word for word, folder in named if not any((r / word).exists() for r in (*roots, ROOT / folder))
    ]
    assert not missing


@pytest.mark.parametrize("package", ["geometry", "solvers", "meshonet_cli"])
def test_the_drawing_shows_every_folder(package: str) -> None:
    drawing = blocks(ROOT / "docs" / "development" / "architecture.md", "text")[0]
    folders = {path.parent.name for path in (ROOT / package).glob("*/__init__.py")}
    assert folders <= set(re.findall(r"(\w+)/", drawing))
