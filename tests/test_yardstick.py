"""The comparison open to other programs: its shapes, its judge, its files, and a program that enters."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "benchmarks"))
from yardstick import networks
from yardstick.files import read_boundaries, read_grids, read_plot3d, write_boundaries, write_grids
from yardstick.judge import judge, summary
from yardstick.networks import OPERATORS, PHYSICS, answered, trained
from yardstick.shapes import BODIES, KINDS, Shape, shapes
from yardstick.words import HEAD, TAIL

from meshonet.formats.registry import read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.quality.measure import measure
from meshonet.solvers.algebraic.tfi import tfi
from meshonet.solvers.neural.models.architectures import ARCHITECTURES
from meshonet_cli.app import run

FOLDER = Path(__file__).parents[1] / "benchmarks"
PROGRAM = """
import sys
sys.path.insert(0, sys.argv[1])
from pathlib import Path
from yardstick.files import read_plot3d, write_plot3d
source, output = map(Path, sys.argv[2:])
output.mkdir()
for file in source.glob("*.xyz"):
    south, north, west, east = read_plot3d(file)
    t = [k / (west.shape[1] - 1) for k in range(west.shape[1])]
    lines = [[[1 - s] for s in t]], [[[s] for s in t]]
    write_plot3d(output / file.name, [south * lines[0] + north * lines[1]])
"""


def square(n: int = 5) -> tuple[Shape, np.ndarray]:
    nodes = np.stack(np.meshgrid(np.linspace(0, 2, n), np.linspace(0, 1, n), indexing="ij"), axis=-1)
    return Shape("square", "quad", nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1]), nodes


@pytest.mark.parametrize("kind", KINDS)
def test_shapes_are_boundaries_that_depend_on_their_seed_alone(kind: str) -> None:
    first, second = list(shapes(kind, 3, 4)), list(shapes(kind, 3, 2))
    assert np.array_equal(first[1].south, second[1].south)
    assert not np.array_equal(first[0].north, next(shapes(kind, 4, 1)).north)
    for s in first:
        boundary = Boundary(s.south, s.north, s.west, s.east, s.topology)  # type: ignore[arg-type]
        assert boundary.periodic == (kind in BODIES)
        assert measure(boundary.grid(tfi(boundary).nodes)).cells == 64 * 64


def test_the_judge_knows_rectangles_shears_and_folds() -> None:
    shape, nodes = square()
    right = judge(shape, nodes)
    assert (right.folded, right.boundary) == (0, 0.0)
    assert (right.largest, right.smallest, right.skew) == pytest.approx((90.0, 90.0, 0.0))
    sheared = nodes + nodes[..., 1:] * [np.tan(np.radians(30)), 0.0]
    leaning = judge(shape, sheared)
    assert (leaning.largest, leaning.smallest, leaning.skew) == pytest.approx((120.0, 60.0, 30.0))
    assert leaning.boundary == pytest.approx(np.tan(np.radians(30)) / np.hypot(2, 1))
    nodes[2, 2] = nodes[3, 2] + [0.1, 0.0]
    assert judge(shape, nodes).folded == 2
    with pytest.raises(ValueError, match="square: "):
        judge(shape, nodes[1:])


def test_the_judge_agrees_with_the_product() -> None:
    for kind in ("wavy", "star"):
        shape = next(shapes(kind, 2, 1))
        sides = shape.south, shape.north, shape.west, shape.east
        grid = tfi(Boundary(*sides, shape.topology))  # type: ignore[arg-type]
        own, ours = judge(shape, grid.nodes), measure(grid)
        assert own.folded == ours.folded
        assert own.largest == pytest.approx(ours["max_angle"].max, abs=1e-9)


def test_files_are_read_as_they_were_written_and_by_the_product(tmp_path: Path) -> None:
    drawn = list(shapes("bumps", 1, 2, 9, 5))
    write_boundaries(tmp_path / "bumps.h5", drawn)
    write_boundaries(tmp_path / "bumps", drawn)
    again = read_boundaries(tmp_path / "bumps.h5")
    ours = list(read_shapes(str(tmp_path / "bumps.h5")))
    for k, shape in enumerate(drawn):
        blocks = read_plot3d(tmp_path / "bumps" / f"{shape.name}.xyz")
        assert np.array_equal(again[k].west, shape.west)
        assert np.array_equal(blocks[0][:, 0], shape.south)
        assert np.array_equal(blocks[3][0], shape.east)
        assert np.array_equal(ours[k].east, shape.east)  # type: ignore[attr-defined]
    _, nodes = square()
    write_grids(tmp_path / "grids.h5", {"square": nodes})
    assert np.array_equal(read_grids(tmp_path / "grids.h5")["square"], nodes)
    grid = tfi(ours[0])  # type: ignore[arg-type]
    grid.write(tmp_path / "ours.xyz")
    assert np.array_equal(read_plot3d(tmp_path / "ours.xyz")[0], grid.nodes)


def test_missing_grids_are_counted() -> None:
    shape, nodes = square()
    assert summary([shape, Shape("other", "quad", *[nodes[0]] * 4)], {"square": nodes})["missing"] == 1
    assert summary([shape], {}) == {"shapes": 1, "missing": 1}


def test_another_program_enters_with_plot3d(tmp_path: Path) -> None:
    """A program that joins south and north by straight lines, which knows nothing of meshonet."""
    yardstick = [sys.executable, str(FOLDER / "yardstick")]
    program = tmp_path / "lines.py"
    program.write_text(PROGRAM)
    folder = str(tmp_path / "shapes")
    subprocess.run([*yardstick, "shapes", folder, "--count", "2", "--plot3d"], check=True)
    words = f"{sys.executable} {program} {FOLDER} {{boundaries}} {{grids}}"
    kinds = ["--kinds", "bumps,star", "--plot3d"]
    subprocess.run([*yardstick, "run", folder, "Straight lines", words, *kinds], check=True)
    report = subprocess.run([*yardstick, "judge", folder], check=True, capture_output=True, text=True).stdout
    rows = report.splitlines()
    assert rows[0].startswith("| four-sided | Straight lines | 2 of 12 | 0 (0) | ")
    assert rows[1].startswith("| body | Straight lines | 2 of 6 | ")


def test_the_judge_holds_nothing_of_the_product() -> None:
    code = "import sys; sys.path.insert(0, sys.argv[1])\nimport yardstick.judge, yardstick.files\n"
    code += "sys.exit(any(name.split('.')[0] == 'meshonet' for name in sys.modules))"
    subprocess.run([sys.executable, "-c", code, str(FOLDER)], check=True)


def test_transfinite_surfaces_of_gmsh_are_structured_and_keep_the_boundary(tmp_path: Path) -> None:
    pytest.importorskip("gmsh")
    drawn = list(shapes("wavy", 1, 1, 9, 7))
    write_boundaries(tmp_path / "in.h5", drawn)
    script = FOLDER / "yardstick" / "gmsh_transfinite.py"
    subprocess.run([sys.executable, script, tmp_path / "in.h5", tmp_path / "out.h5"], check=True)
    figures = judge(drawn[0], read_grids(tmp_path / "out.h5")["wavy-0"])
    assert (figures.folded, figures.boundary) == (0, 0.0)


def test_every_network_that_has_entered_can_be_trained_and_has_its_rows() -> None:
    entered = (*OPERATORS, *PHYSICS)
    assert set(entered) <= set(ARCHITECTURES)
    page = (FOLDER.parent / "docs" / "benchmarks" / "yardstick.md").read_text(encoding="utf-8")
    for model in entered:
        for what in ("four-sided", "body"):
            assert f"| {what} | meshonet train --model {model} | " in page
    assert page.startswith(HEAD.format(count=20, seed=1))
    assert page.endswith(TAIL)


def in_this_process(*words: object, codes: tuple[int, ...] = (0,)) -> None:
    """As `networks.meshonet`, without the start of Python and torch for each command."""
    assert run([*map(str, words), "-q"]) in codes, words


def test_a_command_that_fails_is_an_error_of_the_comparison(tmp_path: Path) -> None:
    networks.meshonet("tfi", "naca:0012", "--res", "9x5", "-o", tmp_path / "grid.h5")
    assert (tmp_path / "grid.h5").exists()
    with pytest.raises(subprocess.CalledProcessError):
        networks.meshonet("tfi", tmp_path / "missing.h5", "-o", tmp_path / "grid.h5", codes=(0, 3))


def test_networks_are_trained_and_asked_for_the_shapes_of_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("torch")
    monkeypatch.setattr(networks, "meshonet", in_this_process)
    drawn = list(shapes("wavy", 1, 2, 17, 17))
    write_boundaries(tmp_path / "wavy.h5", drawn)
    network = trained(tmp_path / "trained", "quad", "pod-deeponet", shapes=6, epochs=1)
    assert trained(tmp_path / "trained", "quad", "pod-deeponet") == network, "kept"
    answered(tmp_path / "wavy.h5", tmp_path / "one.h5", "mgnet", steps=1)
    assert list(read_grids(tmp_path / "one.h5")) == ["wavy-0"], "a network for one geometry"
    assert judge(drawn[0], read_grids(tmp_path / "one.h5")["wavy-0"]).boundary == 0.0
