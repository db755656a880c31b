"""What the house promises about its own build: light imports, documented commands, examples that run."""

import graphlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import grimp
import numpy as np
import pytest

from meshonet import __version__
from meshonet_cli.commands import COMMANDS
from meshonet_cli.options.sampling import SpacingName, TopologyName
from meshonet_cli.reference import reference

ROOT = Path(__file__).parents[1]
HEAVY = ("torch", "matplotlib", "numba", "scipy", "h5py", "meshio")
BLOCKED = """
import sys

class Blocked:
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in {names!r}:
            raise ImportError(f"{{name}} is not allowed here")

sys.meta_path.insert(0, Blocked())
"""


def python(code: str, *arguments: str, cwd: Path = ROOT) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run(
        [sys.executable, "-c", code, *arguments],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
    )


def airfoil(path: Path) -> Path:
    """Write NACA 0012 in Selig's order."""
    x = 0.5 * (1 + np.cos(np.linspace(0, np.pi, 61)))
    half = 0.6 * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1036 * x**4)
    points = np.concatenate([np.stack([x, half], axis=-1), np.stack([x, -half], axis=-1)[-2::-1]])
    path.write_text("NACA 0012\n" + "\n".join(f"{px:.6f} {py:.6f}" for px, py in points) + "\n")
    return path


@pytest.mark.parametrize("command", ["infer", "tfi", "solve-pde"])
def test_the_main_job_needs_no_heavy_library(tmp_path: Path, command: str) -> None:
    airfoil(tmp_path / "a.dat")
    code = BLOCKED.format(names=HEAVY) + "from meshonet_cli.app import run\nsys.exit(run(sys.argv[1:]))"
    done = python(code, command, "a.dat", "--res", "60", "-o", "g.vts", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "g.vts").exists()


def test_the_block_blocks() -> None:
    assert "not allowed" in python(BLOCKED.format(names=HEAVY) + "import scipy.linalg").stderr


def test_importing_the_command_line_loads_nothing_heavy() -> None:
    loaded = python("import meshonet_cli, sys; print(*sorted(sys.modules))").stdout.split()
    assert not {"numpy", "typer", "rich", *HEAVY} & set(loaded)


def test_help_loads_no_numpy_and_no_rich() -> None:
    run = "from meshonet_cli.app import run; run(['--help'])"
    code = f"import sys; {run}; print(*sys.modules, file=sys.stderr)"
    assert not {"numpy", "rich", "pydantic", *HEAVY} & set(python(code).stderr.split())


def test_the_overview_says_what_the_commands_say() -> None:
    from meshonet_cli.app import application

    for command in COMMANDS:
        assert (command.function.__doc__ or "").splitlines()[0] == command.summary
    assert list(application(overview=True).commands) == list(application().commands)


def test_the_overview_loads_no_command() -> None:
    run = "from meshonet_cli.app import run; run(['--help'])"
    loaded = python(f"import sys; {run}; print(*sys.modules, file=sys.stderr)").stderr.split()
    assert "meshonet_cli.app" in loaded
    assert not [name for name in loaded if name.startswith(("meshonet_cli.commands.", "meshonet.geometry"))]


def test_importing_the_package_loads_nothing_heavy() -> None:
    loaded = set(python("import meshonet, sys; print(*sys.modules)").stdout.split())
    assert "meshonet" in loaded
    assert not {"numpy", "shapely", "vtk", "pyvista", "typer", *HEAVY} & loaded


@pytest.mark.parametrize("room", ["geometry", "solvers", "formats", "kernels"])
def test_a_room_has_one_name(room: str) -> None:
    """As the folder that it also is, it would be loaded twice: no error of one is caught as the other's."""
    done = python(f"import {room}")
    assert done.returncode == 1
    assert f"ImportError: import meshonet.{room} in place of {room}" in done.stderr


def circles() -> Iterator[str]:
    """Packages among whose modules and folders are some that import each other, at first or second hand."""
    graph = grimp.build_graph("meshonet", "meshonet_cli", exclude_type_checking_imports=True)
    for package in sorted(graph.modules):
        children = graph.find_children(package)
        owner = {m: child for child in children for m in (child, *graph.find_descendants(child))}
        imports: dict[str, set[str]] = {child: set() for child in children}
        for module, child in owner.items():
            targets = graph.find_modules_directly_imported_by(module)
            imports[child] |= {owner[target] for target in targets if target in owner} - {child}
        try:
            graphlib.TopologicalSorter(imports).prepare()
        except graphlib.CycleError:
            yield package


def test_no_room_imports_in_a_circle() -> None:
    assert not list(circles())


def test_a_circle_would_be_found(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = grimp.build_graph("meshonet_cli")
    graph.add_import(importer="meshonet_cli.text", imported="meshonet_cli.app")
    monkeypatch.setattr(grimp, "build_graph", lambda *_, **__: graph)
    assert list(circles()) == ["meshonet_cli"]


def test_layers_import_one_way() -> None:
    """The contract of pyproject.toml, read here so that the test fails where the lint would."""
    program = shutil.which("lint-imports", path=str(Path(sys.executable).parent)) or "lint-imports"
    done = subprocess.run([program], cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout


def test_reading_the_registry_loads_no_format_library() -> None:
    loaded = python("import meshonet.formats.registry, sys; print(*sorted(sys.modules))").stdout.split()
    assert not set(HEAVY) & set(loaded)


def test_the_command_reference_is_current() -> None:
    page = (ROOT / "docs" / "reference" / "cli.md").read_text()
    assert page == reference(), "run: python -m meshonet_cli.reference > docs/reference/cli.md"


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_is_thin(command: object) -> None:
    import ast
    import inspect
    import textwrap

    function = command.function  # type: ignore[attr-defined]
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    assert sum(isinstance(node, ast.stmt) for node in ast.walk(tree)) - 1 <= 20
    assert "numpy" not in Path(inspect.getfile(function)).read_text()


def test_the_version_is_that_of_the_package() -> None:
    import meshonet

    assert meshonet.__version__ == __version__
    assert 'version = { attr = "meshonet.__version__" }' in (ROOT / "pyproject.toml").read_text()


def test_choices_of_options_are_those_of_the_library() -> None:
    from typing import get_args

    from meshonet.geometry.spacing.sampling import SPACINGS

    assert get_args(SpacingName) == SPACINGS
    assert set(get_args(TopologyName)) <= {"auto", "quad", "o", "c"}


def test_solve_pde_offers_every_method_that_solves() -> None:
    import re

    from meshonet.solvers.method import METHODS, method_named

    match = re.search(r"--method (\S+[|]\S+)", (ROOT / "docs" / "reference" / "cli.md").read_text())
    offered = match[1].split("|") if match else []
    assert offered == [*(name for name, row in METHODS.items() if row.solves), "auto"]
    for name in METHODS:
        assert method_named(name).name == name
