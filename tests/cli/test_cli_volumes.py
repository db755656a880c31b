"""Grids in space by the commands: volumes marched from surfaces, six faces filled, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet
from spatial_shapes import box, cubed_sphere

import meshonet as library
from meshonet.geometry.blocks.block import PLACES, Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.solvers.pipeline import volumes
from meshonet.solvers.solution import Outcome, Solution

MARCH = ("--method", "hyperbolic", "--wall-spacing", "1e-3", "--layers", "21", "--far-field", "4")


@pytest.fixture
def sphere(tmp_path: Path) -> str:
    """A file with six patches of the unit sphere."""
    path = tmp_path / "sphere.xyz"
    library.write(cubed_sphere(), path)
    return str(path)


@pytest.fixture
def duct(tmp_path: Path) -> str:
    """A file with a box over a bump."""
    path = tmp_path / "duct.vts"
    library.write(Grid((Block(box()),)), path)
    return str(path)


def test_a_surface_is_marched_off(meshonet: Meshonet, sphere: str, tmp_path: Path) -> None:
    out = tmp_path / "volume.cgns"
    done = meshonet("solve-pde", sphere, *MARCH, "-o", out, "--json")
    assert done.code == 0, done.err
    assert (done.only["method"], done.only["folded"]) == ("hyperbolic", 0)
    grid = library.read(out)
    assert [block.counts for block in grid.blocks] == [(9, 9, 21)] * 6
    assert len(grid.connections) == 12
    assert {patch.name for patch in grid.patches} == {"wall", "farfield"}
    for block in grid.blocks:
        first = np.linalg.norm(block.nodes[:, :, 1] - block.nodes[:, :, 0], axis=-1)
        assert first == pytest.approx(1e-3, rel=1e-6)
        far = np.linalg.norm(
            block.nodes[:, :, -1], axis=-1
        )  # corners of patches are marched a little farther
        assert far.mean() == pytest.approx(5.0, rel=0.06)
        assert far == pytest.approx(5.0, rel=0.12)


@pytest.mark.parametrize("height", [0.0, 0.3])
def test_a_flat_patch_in_space_is_a_surface(meshonet: Meshonet, tmp_path: Path, height: float) -> None:
    x, y = np.meshgrid(np.linspace(0, 2, 9), np.linspace(0, 1, 5), indexing="ij")
    plate = np.stack([x, y, np.full_like(x, height)], axis=-1)
    library.write(Grid((Block(plate),)), tmp_path / "plate.xyz")
    out = tmp_path / "volume.cgns"
    words = "--first-cell 1e-3 --layers 21 --far-field 2"
    done = meshonet("solve-pde", tmp_path / "plate.xyz", "--method", "hyperbolic", *words.split(), "-o", out)
    assert done.code == 0, done.err
    nodes = library.read(out).blocks[0].nodes
    assert nodes.shape == (9, 5, 21, 3)
    assert np.array_equal(nodes[:, :, 0], plate)
    assert nodes[..., -1, 2] == pytest.approx(height + 2.0)
    same = library.grid(
        tmp_path / "plate.xyz", method="hyperbolic", first_cell=1e-3, layers=21, far_field=2.0
    )
    assert np.array_equal(same.blocks[0].nodes, nodes)


def test_a_plane_of_symmetry_that_closes_in_is_refused(meshonet: Meshonet, tmp_path: Path) -> None:
    a, b = np.meshgrid(np.linspace(0, 1, 7), np.linspace(0, 1, 7), indexing="ij")
    floor, wall = (np.stack(each, axis=-1) for each in ((a, b, 0 * a), (0 * a, a, b)))
    library.write(Grid((Block(floor), Block(wall))), tmp_path / "corner.xyz")
    words = (*MARCH, "--symmetry", "x")
    done = meshonet("solve-pde", tmp_path / "corner.xyz", *words, "-o", tmp_path / "none.cgns")
    assert done.code == 2
    assert "the plane x = 1 closes in before the far field" in done.err
    assert not (tmp_path / "none.cgns").exists()


@pytest.mark.usefixtures("eager_threads")
@pytest.mark.parametrize("threads", [1, 2, 3])
def test_threads_do_not_change_a_bit(meshonet: Meshonet, sphere: str, tmp_path: Path, threads: int) -> None:
    for name, count in (("one", 1), ("several", threads)):
        words = *MARCH, "--threads", str(count), "-o", tmp_path / f"{name}.h5", "-q"
        assert meshonet("solve-pde", sphere, *words).code == 0
    several, single = library.read(tmp_path / "several.h5"), library.read(tmp_path / "one.h5")
    for a, b in zip(several.blocks, single.blocks, strict=True):
        assert np.array_equal(a.nodes, b.nodes)


@pytest.mark.parametrize(
    "words",
    [
        ("tfi",),
        ("tfi", "--blending", "linear"),
        ("solve-pde", "--method", "winslow"),
        ("solve-pde",),
        ("infer",),
    ],
)
def test_six_faces_are_filled_and_kept(
    meshonet: Meshonet, duct: str, tmp_path: Path, words: tuple[str, ...]
) -> None:
    out = tmp_path / "filled.vts"
    command, *options = words
    done = meshonet(command, duct, *options, "-o", out, "--json")
    assert done.code == 0, done.err
    assert done.only["folded"] == 0
    given, filled = Block(box()), library.read(out).blocks[0]
    for side in PLACES:
        assert filled.face(side) == pytest.approx(given.face(side), abs=1e-12)


def test_counts_are_asked_for_along_three_directions(meshonet: Meshonet, duct: str, tmp_path: Path) -> None:
    out = tmp_path / "filled.vts"
    assert meshonet("infer", duct, "--res", "13x11x17", "-o", out, "-q").code == 0
    assert library.read(out).blocks[0].counts == (13, 11, 17)
    assert meshonet("tfi", duct, "--res", "6", "-o", out, "-q").code == 0
    assert library.read(out).blocks[0].counts == (6, 6, 6)


@pytest.mark.parametrize(
    ("source", "words", "said"),
    [
        ("duct", "--method hyperbolic --wall-spacing 1e-3", "give its wall alone"),
        ("duct", "--method steger-sorenson", "use variational or winslow or tfi"),
        ("duct", "--res 20x30", "give NIxNJxNK"),
        ("duct", "--layers 10", "--layers is of no use to six faces"),
        ("duct", "--cells 100", "--cells is of no use to six faces"),
        ("duct", "--topology o", "--topology is of no use to six faces"),
        ("duct", "--wall-spacing 1e-3", "--first-cell is of no use to six faces"),
        ("duct", "--method variational --tol 1e-6", "--tol is of no use to variational in space"),
        ("sphere", "--method hyperbolic", "give --first-cell or --y-plus"),
        ("sphere", "--wall-spacing 1e-3 --res 20", "--res is of no use to marching"),
        ("sphere", "--wall-spacing 1e-3 --layers 2", "layers"),
    ],
)
def test_what_does_not_go_together_is_refused_in_a_line(
    meshonet: Meshonet, request: pytest.FixtureRequest, tmp_path: Path, source: str, words: str, said: str
) -> None:
    out = tmp_path / "none.h5"
    done = meshonet("solve-pde", request.getfixturevalue(source), *words.split(), "-o", out)
    assert done.code == 2
    assert said in done.err
    assert len(done.err.splitlines()) == 1
    assert not out.exists()


@pytest.mark.parametrize("words", ["--layers 9", "--symmetry z", "--res 20x20x20"])
def test_what_only_volumes_have_is_refused_in_the_plane(
    meshonet: Meshonet, tmp_path: Path, words: str
) -> None:
    done = meshonet("solve-pde", "naca:0012", *words.split(), "-o", tmp_path / "none.h5")
    assert done.code == 2
    assert "plane" in done.err


@pytest.mark.parametrize("command", ["sample-boundary", "layout"])
def test_commands_of_the_plane_refuse_grids_in_space(
    meshonet: Meshonet, sphere: str, tmp_path: Path, command: str
) -> None:
    ending = {"sample-boundary": "h5", "layout": "json"}[command]
    done = meshonet(command, sphere, "-o", tmp_path / f"none.{ending}")
    assert done.code == 2
    assert len(done.err.splitlines()) == 1


def test_python_marches_as_the_command_does(sphere: str) -> None:
    grid = library.solve_pde(
        sphere, method="hyperbolic", wall_spacing=1e-3, layers=21, far_field=4.0, threads=1
    )
    assert (len(grid.blocks), grid.quality().folded) == (6, 0)


@pytest.mark.parametrize(
    ("method", "remedy"), [("variational", "another --res"), ("winslow", "--method variational")]
)
def test_folded_volumes_are_not_answered_by_the_method_that_made_them(
    meshonet: Meshonet, duct: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, method: str, remedy: str
) -> None:
    nodes = box().copy()
    nodes[2, 2, 2] = nodes[0, 0, 0]
    solution = Solution(Grid((Block(nodes),)), method, outcome=Outcome.FOLDED)
    monkeypatch.setattr(volumes, "make_volume", lambda *_: solution)
    done = meshonet("solve-pde", duct, "--method", method, "-o", tmp_path / "out.vts")
    assert done.code == 3
    assert f"cells are folded; try {remedy}, or --allow-invalid" in done.err
