"""What the house promises about its own build: light imports, documented commands, examples that run."""

import ast
import graphlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import grimp
import numpy as np
import pytest
from command_pages import reference

from meshonet import __version__
from meshonet.geometry.blocks.grid import Grid
from meshonet_cli.commands import COMMANDS
from meshonet_cli.options.sampling import TopologyName

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


@pytest.mark.slow
@pytest.mark.parametrize("command", ["infer", "tfi", "solve-pde"])
def test_the_main_job_needs_no_heavy_library(tmp_path: Path, command: str) -> None:
    airfoil(tmp_path / "a.dat")
    code = BLOCKED.format(names=HEAVY) + "from meshonet_cli.app import run\nsys.exit(run(sys.argv[1:]))"
    done = python(code, command, "a.dat", "--res", "60", "-o", "g.vts", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "g.vts").exists()


def test_the_main_job_does_not_grow(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What it runs through of this project; the limits rise only with a metric that every report contains."""
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    from path_length import code_objects

    objects = code_objects(
        ["infer", str(airfoil(tmp_path / "a.dat")), "--res", "800", "-o", "g.vts", "--quiet"]
    )
    assert len(objects) <= 112
    assert sum(map(len, objects.values())) <= 500


WING = "".join(f'[[sections]]\nairfoil = "naca:0012"\nchord = 1\nz = {z}\n' for z in (0, 1))


@pytest.mark.parametrize(
    ("words", "others"),
    [
        (
            "stack wing.toml --around 33 --span 7 --layers 12 -o wing.cgns",
            "geometry.aircraft geometry.rows solvers.aircraft solvers.rows.row_grid solvers.sweeping.sweep "
            "formats.aircraft formats.rows geometry.quality.gates",
        ),
        ("quality grid.vts", "geometry.quality.periodic"),
        ("plot grid.vts -o grid.png", "geometry.quality.figures geometry.domain"),
        ("infer naca:0012 --first-cell 1e-3 --res 61x41 -o a.cgns", "geometry.domain geometry.layout"),
    ],
    ids=["stack of a wing", "quality", "plot", "infer with layers"],
)
def test_a_command_loads_no_modules_of_other_shapes(tmp_path: Path, words: str, others: str) -> None:
    (tmp_path / "wing.toml").write_text(WING)
    Grid.from_nodes(np.stack(np.meshgrid(*[np.arange(4.0)] * 2, indexing="ij"), axis=-1)).write(
        tmp_path / "grid.vts"
    )
    code = "import sys; from meshonet_cli.app import run; assert run(sys.argv[1:]) == 0; print(*sys.modules)"
    done = python(code, *words.split(), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    names = tuple(f"meshonet.{name}" for name in others.split())
    assert not [name for name in done.stdout.split() if name.startswith(names)]


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
        assert (command.loaded()[0].__doc__ or "").splitlines()[0] == command.summary
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


NAMED = re.compile(r"(\w+(?:\.\w+)*)(?::\w+)?")
"""A module, or a function in it, as in tables of functions and in import_module."""


@cache
def import_graph() -> grimp.ImportGraph:
    """Return what imports what, in functions too, and by strings as by statements."""
    graph = grimp.build_graph("meshonet", "meshonet_cli", exclude_type_checking_imports=True)
    for module in graph.modules:
        for target in named_modules(module, graph.modules):
            graph.add_import(importer=module, imported=target)
    return graph


def named_modules(module: str, modules: set[str]) -> set[str]:
    """Return the modules that the source of `module` names in strings, all that fit a name put together."""
    spec = importlib.util.find_spec(module)
    assert spec is not None
    assert spec.origin is not None
    own = {"__name__": module, "__package__": spec.parent or module}
    imported: set[str] = set()
    for node in ast.walk(ast.parse(Path(spec.origin).read_text())):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            words = [match for word in node.value.split() if (match := NAMED.fullmatch(word))]
            imported |= {word[1] for word in words if "." in word[1]} & modules
            imported |= {f"{own['__package__']}.{word[1]}" for word in words if ":" in word[0]} & modules
        elif isinstance(node, ast.JoinedStr) and re.match(
            r"meshonet(_cli)?\.\w", prefix := beginning(node, own)
        ):
            imported |= {name for name in modules if name.startswith(prefix)}
        elif isinstance(node, ast.Call) and ast.unparse(node).endswith("import_module('meshonet')"):
            imported.add("meshonet")
    return imported - {module}


def beginning(text: ast.JoinedStr, own: Mapping[str, str]) -> str:
    """Return how a formatted string begins, as far as that is known."""
    known = ""
    for part in text.values:
        if isinstance(part, ast.Constant):
            known += str(part.value)
        elif (
            isinstance(part, ast.FormattedValue) and isinstance(part.value, ast.Name) and part.value.id in own
        ):
            known += own[part.value.id]
        else:
            break
    return known


def circles() -> Iterator[tuple[str, str]]:
    """Yield packages whose modules and folders import each other, at first or second hand, and a circle."""
    graph = import_graph()
    for package in sorted(graph.modules):
        children = graph.find_children(package)
        owner = {m: child for child in children for m in (child, *graph.find_descendants(child))}
        imports: dict[str, set[str]] = {child: set() for child in children}
        for module, child in owner.items():
            targets = graph.find_modules_directly_imported_by(module)
            if package in targets:  # with all that it imports itself
                targets = targets | graph.find_modules_directly_imported_by(package)
            imports[child] |= {owner[target] for target in targets if target in owner} - {child}
        try:
            graphlib.TopologicalSorter(imports).prepare()
        except graphlib.CycleError as error:
            yield package, " <- ".join(error.args[1])


def test_no_room_imports_in_a_circle() -> None:
    assert not dict(circles())


def test_a_circle_would_be_found(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = grimp.build_graph("meshonet_cli")
    graph.add_import(importer="meshonet_cli.terminal.text", imported="meshonet_cli.app")
    monkeypatch.setitem(globals(), "import_graph", lambda: graph)
    assert "meshonet_cli" in dict(circles())


def test_an_import_by_a_string_is_found() -> None:
    graph = import_graph()
    for importer, imported in (
        ("meshonet.solvers.pipeline.methods", "meshonet.solvers.neural.inference"),  # a table
        ("meshonet.solvers.pipeline.volumes", "meshonet.solvers.volumes.winslow"),  # put together
        ("meshonet.formats.table", "meshonet.formats.plot3d.write"),  # from its own package on
        ("meshonet_cli.commands", "meshonet_cli.commands.infer"),  # of its own package, put together
    ):
        assert imported in graph.find_modules_directly_imported_by(importer)


def test_layers_import_one_way() -> None:
    """The contract of pyproject.toml, read here so that the test fails where the lint would."""
    program = shutil.which("lint-imports", path=str(Path(sys.executable).parent)) or "lint-imports"
    done = subprocess.run([program], cwd=ROOT, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stdout


def test_reading_the_registry_loads_no_format_library() -> None:
    loaded = python("import meshonet.formats.registry, sys; print(*sorted(sys.modules))").stdout.split()
    assert not set(HEAVY) & set(loaded)


def test_the_command_reference_is_current() -> None:
    folder = ROOT / "docs" / "reference" / "commands"
    assert {path.name: path.read_text() for path in folder.iterdir()} == reference(), "run make text"


@pytest.mark.parametrize("command", COMMANDS, ids=lambda command: command.name)
def test_every_command_is_thin(command: object) -> None:
    import inspect
    import textwrap

    function, _ = command.loaded()  # type: ignore[attr-defined]
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    assert sum(isinstance(node, ast.stmt) for node in ast.walk(tree)) - 1 <= 20
    assert "numpy" not in Path(inspect.getfile(function)).read_text()


def test_the_version_is_that_of_the_package() -> None:
    import meshonet

    assert meshonet.__version__ == __version__
    assert 'version = { attr = "meshonet.__version__" }' in (ROOT / "pyproject.toml").read_text()


def test_choices_of_options_are_those_of_the_library() -> None:
    from typing import get_args

    assert set(get_args(TopologyName)) <= {"auto", "quad", "o", "c"}


@pytest.mark.parametrize(
    ("command", "column", "more"), [("tfi", "algebraic", []), ("solve-pde", "solves", ["auto"])]
)
def test_commands_offer_every_method_of_theirs(command: str, column: str, more: list[str]) -> None:
    from meshonet.solvers.pipeline.methods import METHODS
    from meshonet.solvers.pipeline.named import method_named
    from meshonet_cli.app import application

    (option,) = (each for each in application().commands[command].params if each.name == "method")
    names = [name for name, row in METHODS.items() if getattr(row, column)]
    assert list(option.type.choices) == (option.metavar or "").split("|") == [*names, *more]
    for name in names:
        assert method_named(name).name == name


Documented = ast.Module | ast.ClassDef | ast.FunctionDef
PACKAGES = ("geometry", "solvers", "formats", "meshonet_cli", "meshonet/api")


def lengths(text: str) -> Iterator[tuple[str, int]]:
    """Lines of a module, called nothing, and of the body of each of its functions, without docstrings."""
    tree = ast.parse(text)
    parts = [node for node in ast.walk(tree) if isinstance(node, Documented)]
    of_docstring = {
        line
        for node in parts
        if ast.get_docstring(node) is not None
        for line in range(node.body[0].lineno, (node.body[0].end_lineno or 0) + 1)
    }
    yield "", len(set(range(1, len(text.splitlines()) + 1)) - of_docstring)
    for node in parts:
        if isinstance(node, ast.FunctionDef):
            yield node.name, len(set(range(node.body[0].lineno, (node.end_lineno or 0) + 1)) - of_docstring)


@pytest.mark.parametrize("package", PACKAGES)
def test_modules_have_300_lines_and_functions_50_at_most(package: str) -> None:
    """As docs/development/architecture.md says; tests, benchmarks and C are read as they are."""
    outside = [
        f"{path}: {name or 'module'} has {lines} lines"
        for path in sorted((ROOT / package).rglob("*.py"))
        for name, lines in lengths(path.read_text(encoding="utf-8"))
        if lines > (50 if name else 300)
    ]
    assert not outside


def test_lines_are_counted_without_docstrings() -> None:
    text = (
        '"""What it is."""\n\ndef f(\n    a,\n):\n    """One.\n\n    Two.\n    """\n    b = a\n    return b\n'
    )
    assert list(lengths(text)) == [("", 6), ("f", 2)]
