"""`import meshonet`: light, complete, and doing what the commands do."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from test_architecture import BLOCKED, HEAVY, ROOT, python

import meshonet
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.pipeline.methods import METHODS
from meshonet.solvers.pipeline.named import Each, method_named

if TYPE_CHECKING:
    from meshonet.geometry.blocks.grid import Grid


def square(n: int = 9) -> meshonet.Boundary:
    t = np.linspace(0, 1, n)
    zero, one = np.zeros(n), np.ones(n)
    edges = [(t, zero), (t, one), (zero, t), (one, t)]
    return meshonet.Boundary(*(np.stack(edge, axis=1) for edge in edges))


def test_importing_it_loads_nothing_heavy() -> None:
    names = (*HEAVY, "vtk", "pyvista", "numpy", "typer")
    done = python(BLOCKED.format(names=names) + "import meshonet; print(meshonet.__version__)")
    assert done.stdout == f"{meshonet.__version__}\n"


@pytest.mark.slow
def test_a_grid_needs_no_heavy_library(tmp_path: Path) -> None:
    code = "import meshonet; meshonet.grid('naca:0012', res=40).write('g.vts')"
    assert python(BLOCKED.format(names=HEAVY) + code, cwd=tmp_path).returncode == 0
    assert (tmp_path / "g.vts").exists()


def test_every_public_name_is_there_and_typed() -> None:
    source = Path(meshonet.__file__).read_text()
    typed = set(re.findall(r"import (\w+) as \1$", source, flags=re.MULTILINE))
    assert typed | {"__version__"} == set(meshonet.__all__) <= set(dir(meshonet))
    for name in meshonet.__all__:
        assert getattr(meshonet, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        meshonet.nothing  # noqa: B018


def test_shapes_are_files_designations_points_boundaries_and_grids(tmp_path: Path) -> None:
    edges = square()
    meshonet.write(edges, tmp_path / "edges.h5")
    ring = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    same = [edges, tmp_path / "edges.h5", str(tmp_path / "edges.h5"), meshonet.tfi(edges)]
    for shape in same:
        np.testing.assert_array_equal(meshonet.tfi(shape).nodes, meshonet.tfi(edges).nodes)
    np.testing.assert_allclose(meshonet.tfi(ring, res=9).nodes, meshonet.tfi(edges).nodes, atol=1e-12)
    assert meshonet.grid("naca:0012", res=(41, 15)).topology == "o"
    with pytest.raises(meshonet.InputError, match=r"points of shape \(4, 3\)"):
        meshonet.grid(np.zeros((4, 3)))


@pytest.mark.parametrize("make", [meshonet.infer, meshonet.solve_pde, meshonet.sample_boundary])
def test_a_list_of_shapes_is_assembled_or_refused(make: Callable[..., Any]) -> None:
    edges = square()
    for several in (["a.dat", "b.dat"], ("naca:0012", edges), [edges, edges], [Path("a.dat")]):
        with pytest.raises(meshonet.InputError, match=r"shape: a list of \d shapes; .*assemble=True"):
            make(several, res=20)
    for bad in ([[0, 0], [1]], {"x": 1}, [np.zeros((4, 2)), np.zeros((5, 2))]):
        with pytest.raises(meshonet.InputError, match=r"shape: this (list|dict) is no array; give \(n, 2\)"):
            make(bad, res=20)


def test_functions_do_what_their_commands_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from meshonet_cli.app import run

    monkeypatch.chdir(tmp_path)
    cases = {
        "infer naca:2412 --res 61x31": lambda: meshonet.infer("naca:2412", res=(61, 31)),
        "infer naca:2412 --res 61x31 --polish 2": lambda: meshonet.infer("naca:2412", res=(61, 31), polish=2),
        "solve-pde naca:2412 --res 61 --first-cell 1e-4 --growth 1.3 --topology o": lambda: (
            meshonet.solve_pde("naca:2412", res=61, wall_spacing=1e-4, growth=1.3, topology="o")
        ),
        "tfi naca:2412 --res 61x31 --blending linear --allow-invalid": lambda: meshonet.tfi(
            "naca:2412", res=(61, 31), blending="linear", allow_invalid=True
        ),
    }
    for line, make in cases.items():
        assert run([*line.split(), "-q", "-o", "made.h5"]) == 0
        made: Grid = meshonet.read("made.h5")  # type: ignore[assignment]
        np.testing.assert_array_equal(made.nodes, make().nodes, err_msg=line)


SECTION = "[[sections]]\nairfoil = 'naca:0012'\nchord = {}\nz = {}\n"
WING = ("--around", "49", "--span", "9", "--layers", "9", "--far-field", "5", "--first-cell", "1e-2")


@pytest.mark.parametrize(
    ("words", "make"),
    [
        (
            ("infer", "naca:2412", "--res", "61x31", "--y-plus", "30", "--reynolds", "1e6"),
            lambda: meshonet.infer("naca:2412", res=(61, 31), y_plus=30, reynolds=1e6),
        ),
        (
            ("stack", "wing.toml", *WING),
            lambda: meshonet.stack("wing.toml", around=49, span=9, layers=9, far_field=5, first_cell=1e-2),
        ),
        (
            ("stack", "wing.toml", "--around", "49", "--span", "9", "--surface"),
            lambda: meshonet.stack("wing.toml", around=49, span=9, surface=True),
        ),
        (
            ("sweep", "circle:0.5", "path.csv", "--cells", "100"),
            lambda: meshonet.sweep("circle:0.5", "path.csv", cells=100),
        ),
    ],
    ids=["infer", "stack", "surface", "sweep"],
)
def test_grids_have_the_notes_of_their_command(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    make: Callable[[], Grid],
) -> None:
    from meshonet_cli.app import run

    monkeypatch.chdir(tmp_path)
    Path("wing.toml").write_text(SECTION.format(1.0, 0.0) + SECTION.format(0.5, 2.0))
    Path("path.csv").write_text("0,0,0\n1,0,0\n2,0.2,0\n3,0.5,0\n")
    assert run([*words, "--json", "-o", "made.cgns"]) == 0
    printed = json.loads(capsys.readouterr().out)["notes"]
    assert printed
    spelled = [re.sub("--([a-z-]+)", lambda option: option[1].replace("-", "_"), note) for note in printed]
    assert list(make().notes) == spelled


def test_files_are_read_whole_and_one_by_one(tmp_path: Path) -> None:
    made = meshonet.tfi(square())
    made.write(tmp_path / "g.vts")
    assert isinstance(meshonet.read(tmp_path / "g.vts"), meshonet.Grid)
    with pytest.raises(meshonet.InputError, match="its ending"):
        made.write(tmp_path / "g.nothing")
    made.write(tmp_path / "odd.name", to_format="vtk")
    assert (tmp_path / "odd.name").read_bytes().startswith(b"# vtk")


def test_several_grids_are_written_into_one_file(tmp_path: Path) -> None:
    made = [meshonet.tfi(f"naca:{each}", res=(41, 17)) for each in ("0012", "2412", "4412")]
    for given in (made, tuple(made), iter(made)):
        meshonet.write(given, tmp_path / "all.h5")
        again = list(meshonet.read_all(tmp_path / "all.h5"))
        assert [grid.name for grid in again] == ["NACA 0012", "NACA 2412", "NACA 4412"]
        for grid, first in zip(again, made, strict=True):
            np.testing.assert_array_equal(grid.nodes, first.nodes)  # type: ignore[union-attr]
    meshonet.write(meshonet.sample_family("wrench", 2, res=21), tmp_path / "edges.h5")
    assert len(list(meshonet.read_all(tmp_path / "edges.h5"))) == 2
    meshonet.write([made[0]], tmp_path / "one.vts")
    assert isinstance(meshonet.read(tmp_path / "one.vts"), meshonet.Grid)


@pytest.mark.parametrize(
    ("several", "name", "message"),
    [
        (
            lambda grid: [grid, grid],
            "g.vts",
            "vts files hold one, and there are several; write one file each",
        ),
        (lambda grid: [grid, square()], "g.h5", "boundaries among grids; write them into files of their own"),
        (lambda grid: [grid, meshonet.tfi(square(5))], "g.h5", "sample 1 is 5x5 quad and the first is 9x9"),
        (lambda _: [], "g.h5", "there is nothing to write"),
        (lambda _: meshonet.read("naca:0012"), "g.h5", "Airfoil is neither a grid nor a boundary nor a lay"),
        (lambda grid: grid.nodes, "g.h5", "ndarray is neither"),
    ],
)
def test_what_does_not_go_into_one_file_is_refused(
    tmp_path: Path, several: Callable[[Grid], Any], name: str, message: str
) -> None:
    with pytest.raises(meshonet.InputError, match=message):
        meshonet.write(several(meshonet.tfi(square())), tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_pyvista_is_told_of_when_it_is_missing_and_has_the_nodes(monkeypatch: pytest.MonkeyPatch) -> None:
    made = meshonet.tfi(square())
    monkeypatch.setitem(sys.modules, "pyvista", None)
    with pytest.raises(meshonet.InputError, match="install it: pip install 'meshonet"):
        made.to_pyvista()
    fake = ModuleType("pyvista")
    fake.StructuredGrid = lambda *planes: planes  # type: ignore[attr-defined]
    fake.MultiBlock = dict  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pyvista", fake)
    x, y, z = made.to_pyvista()
    assert x.shape == y.shape == z.shape == (9, 9, 1)
    np.testing.assert_array_equal(y[..., 0], made.y)
    patch = np.random.default_rng(0).random((3, 4, 3))
    assert [plane.shape for plane in Grid.from_nodes(patch).to_pyvista()] == [(3, 4, 1)] * 3
    cube = np.stack(np.meshgrid(*[np.arange(4.0)] * 3, indexing="ij"), axis=-1)
    many = Grid((Block(cube), Block(cube + np.array([3, 0, 0])))).to_pyvista()
    assert list(many) == ["block-0", "block-1"]
    np.testing.assert_array_equal(many["block-1"][0], cube[..., 0] + 3)


@pytest.mark.parametrize("name", METHODS)
def test_every_method_makes_a_grid_or_says_why_not(name: str) -> None:
    settings = {"first_cell": 1e-3} if name == "hyperbolic" else {}
    made = meshonet.grid("naca:0012", res=(61, 41), method=name, topology="o", repair=True, **settings)
    assert made.quality().folded == 0
    assert (made.ni, made.nj) == (61, 41)


def test_a_setting_that_a_method_does_not_have_is_refused() -> None:
    with pytest.raises(meshonet.InputError, match="method winslow has no polish; leave polish out"):
        meshonet.grid("naca:0012", res=40, method="winslow", polish=2)
    with pytest.raises(meshonet.InputError, match="method 'no' is not known; use one of tfi"):
        meshonet.grid("naca:0012", res=40, method="no")
    with pytest.raises(meshonet.InputError, match="a boundary has no tol; leave tol out"):
        meshonet.sample_boundary("naca:0012", res=40, tol=1e-3)


def test_an_operator_has_its_name_in_that_of_the_method() -> None:
    named = meshonet.grid(square(33), method="operator:quad-general")
    np.testing.assert_array_equal(named.nodes, meshonet.infer(square(33), model="quad-general").nodes)


def test_a_batch_goes_on_behind_what_fails() -> None:
    broken = meshonet.sample_boundary("naca:0012", res=(41, 15))
    results = list(
        meshonet.make_grids([square(), broken, square()], meshonet.grid_request("winslow", slide=True))
    )
    assert [isinstance(result, Exception) for result in results] == [False, True, False]


def test_outcomes_say_what_to_try() -> None:
    request = meshonet.grid_request("winslow", res=41, topology="o", max_cycles=1, tol=1e-12)
    outcome = meshonet.make_grid(meshonet.read("naca:0012"), request).outcome  # type: ignore[arg-type]
    assert outcome.name == "UNCONVERGED"
    assert "allow more max_cycles or a larger tol" in outcome.message


def test_methods_are_functions_with_settings() -> None:
    method = method_named("winslow", tol=1e-9)
    assert isinstance(method, Each)
    first = method.solve([square(17)])[0]
    again = method.solve([square(17)], [first.grid])[0]
    np.testing.assert_allclose(first.grid.nodes, again.grid.nodes, atol=1e-8)


@pytest.mark.slow
def test_the_page_of_examples_prints_what_it_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import contextlib
    import io

    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs" / "reference" / "python.md").read_text()
    blocks = re.findall(r"```python\n(.*?)```(?:\n```\n(.*?)```)?", page, flags=re.DOTALL)
    assert len(blocks) >= 5
    names: dict[str, object] = {}
    for code, expected in blocks:
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(code, names)  # noqa: S102
        assert printed.getvalue() == expected, code


@pytest.mark.parametrize(
    ("parameters", "near"),
    [
        ({"yplus": 1}, "did you mean 'y_plus'?"),
        ({"resolution": 80}, "did you mean 'res'?"),
        ({"colour": 1}, ""),
    ],
)
def test_parameters_that_there_are_not_name_the_nearest(parameters: dict[str, int], near: str) -> None:
    (name,) = parameters
    with pytest.raises(meshonet.InputError, match=f"has no {name}; .*leave {name} out") as caught:
        meshonet.grid("naca:0012", **parameters)
    assert (near in str(caught.value), "did you mean" in str(caught.value)) == (True, bool(near))


def test_metrics_are_listed_and_a_wrong_name_has_the_nearest() -> None:
    quality = meshonet.tfi(square()).quality()
    assert list(quality) == list(quality.metrics)
    assert "max_angle" in quality
    with pytest.raises(KeyError, match="metric 'maxangle' is not known; did you mean 'max_angle'"):
        quality["maxangle"]


@pytest.mark.parametrize("turned", [False, True])
def test_boundaries_of_domains_are_named(turned: bool) -> None:
    box = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]])
    hole = np.array([[1.0, 0.5], [1.5, 1.0], [1.0, 1.5], [0.5, 1.0]])
    names = ["floor", "outlet", "ceiling", "inlet"]
    if turned:  # from the same first point the other way round, so that stretches come in the other order
        box, names = box[[0, 3, 2, 1]], names[::-1]
    domain = meshonet.Domain.of_polygons([box, hole], "channel", [names, "post"])
    outer = domain.loops[0]
    middles = {"floor": (2.0, 0.0), "outlet": (4.0, 1.0), "ceiling": (2.0, 2.0), "inlet": (0.0, 1.0)}
    arcs = outer.corner_arcs + np.array([2.0, 1.0, 2.0, 1.0])
    results = {outer.name_at(float(arc)): tuple(outer.at(np.array([arc]))[0]) for arc in arcs}
    assert results == middles
    made = meshonet.solve_pde(domain, cells=300)
    assert {patch.name for patch in made.patches} == {*middles, "post"}
    with pytest.raises(meshonet.InputError, match="names of 1 polygons, and 2 polygons; name each of them"):
        meshonet.Domain.of_polygons([box, hole], names=["box"])


def test_a_report_of_quality_is_shown_in_one_line() -> None:
    report = meshonet.quality(meshonet.grid("naca:0012", res=(80, 30), first_cell=1e-3), profile="viscous")
    assert isinstance(report, meshonet.QualityReport)
    assert report.profile is not None
    verdict = "passed" if report.profile.passed else "failed"
    angle = f"{report.quality['max_angle'].max:.1f}"
    assert repr(report) == f"<QualityReport: 2291 cells, 0 folded, max angle {angle}, viscous {verdict}>"
