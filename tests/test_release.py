"""What is released says the same everywhere, and is small."""

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from command_pages import man_page

import meshonet

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
ROOMS = ("geometry", "solvers", "formats", "kernels")
FOLDERS = {name: Path(name) for name in ("meshonet", "meshonet_cli")} | {
    name: Path("meshonet") / name for name in ROOMS
}
"""Where each folder of the repository is installed."""
NOT_INSTALLED = {"", ".c", ".h", ".pxi", ".pyx", ".pyc", ".so"}
CONDA = {"matplotlib": "matplotlib-base"}
"""Packages of conda that are called otherwise than PyPI's."""


def pictures() -> list[Path]:
    """Pictures of the documentation that are kept; those of galleries are made."""
    made = (ROOT / "docs" / "reference" / "api", ROOT / "docs" / "gallery" / "python")
    files = [path for end in ("png", "jpg", "svg") for path in (ROOT / "docs").rglob(f"*.{end}")]
    return [path for path in files if not any(folder in path.parents for folder in made)]


def test_the_recipe_has_the_requirements_of_the_package() -> None:
    recipe = (ROOT / "recipe" / "recipe.yaml").read_text()
    run = re.findall(r"- (\S+ ?\S*)", recipe[recipe.index("  run:") : recipe.index("tests:")])
    wanted = [re.split(r"(?=[<>=])", text, maxsplit=1) for text in PROJECT["dependencies"]]
    assert run == [f"python {PROJECT['requires-python']}"] + [
        f"{CONDA.get(name, name)} {limits}" for name, limits in wanted
    ]
    (script,) = PROJECT["scripts"].items()
    assert f"- {' = '.join(script)}\n" in recipe
    build = tomllib.loads((ROOT / "pyproject.toml").read_text())["build-system"]["requires"]
    assert all(f"- {text.replace('>=', ' >=')}\n" in recipe for text in build)


def test_the_version_is_the_same_everywhere() -> None:
    assert f'version: "{meshonet.__version__}"' in (ROOT / "recipe" / "recipe.yaml").read_text()
    assert f"\nversion: {meshonet.__version__}\n" in (ROOT / "CITATION.cff").read_text()
    assert PROJECT["dynamic"] == ["version"]


def test_the_citation_has_the_paper() -> None:
    text = (ROOT / "CITATION.cff").read_text()
    assert re.search(r"^cff-version: 1\.2\.0$", text, re.MULTILINE)
    assert "2501.11937" in text
    assert "2501.11937" in (ROOT / "README.md").read_text()


def test_licences_go_with_the_package() -> None:
    assert set(PROJECT["license-files"]) == {"LICENSE", "NOTICE"}
    assert all((ROOT / name).is_file() for name in PROJECT["license-files"])


def test_pictures_are_small() -> None:
    sizes = {path: path.stat().st_size for path in pictures()}
    assert sum(sizes.values()) < 3_000_000
    assert {path for path, size in sizes.items() if size > 200_000} == set()
    (first,) = re.findall(r"!\[[^]]*\]\(([^)]+)\)", (ROOT / "README.md").read_text())[:1]
    assert (ROOT / first).stat().st_size < 200_000


@pytest.mark.parametrize("links", [True, False], ids=["with links", "without links"])
def test_every_file_but_sources_of_c_is_installed(tmp_path: Path, links: bool) -> None:
    for name in FOLDERS:
        ignored = shutil.ignore_patterns("__pycache__", "*.so")
        shutil.copytree(ROOT / name, tmp_path / name, symlinks=True, ignore=ignored)
    for name in ("setup.py", "pyproject.toml", "README.md", "LICENSE", "NOTICE"):
        shutil.copy2(ROOT / name, tmp_path)
    for room in [] if links else ROOMS:  # as zipfile unpacks an archive, and git clones where links cannot be
        (tmp_path / "meshonet" / room).unlink()
        (tmp_path / "meshonet" / room).write_text(f"../{room}")
    build = [sys.executable, "setup.py", "--quiet", "build_py", "--build-lib", "lib"]
    subprocess.run(build, cwd=tmp_path, check=True, timeout=120)

    library = tmp_path / "lib"
    installed = {path.relative_to(library) for path in library.rglob("*") if path.is_file()}
    assert installed == {
        folder / path.relative_to(ROOT / name)
        for name, folder in FOLDERS.items()
        for path in (ROOT / name).rglob("*")
        if path.suffix not in NOT_INSTALLED
    }


def test_the_manual_page_has_every_command_and_is_understood() -> None:
    page = man_page()
    assert page.startswith('.TH MESHONET 1 "" "meshonet')
    for command in ("infer", "solve\\-pde", "doctor"):
        assert f'.SS "meshonet {command}"' in page
    if shutil.which("man"):
        done = subprocess.run(
            ["man", "--warnings=w", "-l", "-"], input=page, capture_output=True, text=True, timeout=60,
            env={"MANPAGER": "cat", "LC_ALL": "C.UTF-8", "PATH": "/usr/bin:/bin"},
        )  # fmt: skip
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_is_shown_and_completes(shell: str) -> None:
    command = [sys.executable, "-m", "meshonet_cli"]
    variables = {
        "bash": {"COMP_WORDS": "meshonet pl", "COMP_CWORD": "1"},
        "zsh": {"_TYPER_COMPLETE_ARGS": "meshonet pl"},
        "fish": {"_TYPER_COMPLETE_ARGS": "meshonet pl", "_TYPER_COMPLETE_FISH_ACTION": "get-args"},
    }
    environment = {"PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT)}
    script = subprocess.run(
        command, env=environment | {"_MESHONET_COMPLETE": f"source_{shell}"}, capture_output=True, text=True
    )
    assert "_MESHONET_COMPLETE" in script.stdout
    completed = subprocess.run(
        command, env=environment | variables[shell] | {"_MESHONET_COMPLETE": f"complete_{shell}"},
        capture_output=True, text=True,
    )  # fmt: skip
    assert "plot" in completed.stdout
    assert "infer" not in completed.stdout
