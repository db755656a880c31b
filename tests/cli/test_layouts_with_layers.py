"""Layouts of what layers leave of a domain: saved, and taken for other cells, layers and shapes."""

import json
from pathlib import Path

import numpy as np
import pytest
from block_files import cells, first_cells, grid_of
from command_line import Meshonet
from domains import circle

BODIES = ("naca:0012", "rod.csv", "--assemble", "--far-field", 20)
FIRST = ("--first-cell", 1e-4)


def rod(x: float, y: float, radius: float) -> None:
    text = "".join(f"{x!r},{y!r}\n" for x, y in circle(x, y, radius, 90).tolist())
    Path("rod.csv").write_text(text)


@pytest.fixture(scope="module")
def saved(tmp_path_factory: pytest.TempPathFactory) -> str:
    from meshonet_cli.app import run

    folder = tmp_path_factory.mktemp("saved")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        rod(1.5, -0.1, 0.1)
        assert run([*map(str, ("layout", *BODIES, *FIRST, "-o", "layout.json", "-q"))]) == 0
    return str(folder / "layout.json")


def test_a_layout_outside_layers_says_which_loops_are_their_fronts(saved: str) -> None:
    loops = json.loads(Path(saved).read_text())["loops"]
    assert [loop.get("front", False) for loop in loops] == [False, True, True]


@pytest.mark.parametrize(("height", "count"), [(1e-4, 8000), (1e-5, 12_000)])
def test_it_is_taken_for_other_layers_and_cells(
    meshonet: Meshonet, saved: str, height: float, count: int
) -> None:
    rod(1.5, -0.1, 0.1)
    words = ("infer", *BODIES, "--layout", saved, "--first-cell", height, "--cells", count)
    report = meshonet(*words, "--json", "-o", "g.h5").only
    assert report["folded"] == 0
    grid = grid_of("g.h5")
    assert cells(grid) == pytest.approx(count, rel=0.2)
    np.testing.assert_allclose(first_cells(grid), height, rtol=1e-6)


def test_it_is_taken_for_other_shapes_with_the_same_blocks(meshonet: Meshonet, saved: str) -> None:
    words = ("infer", "naca:2412", *BODIES[1:], "--layout", saved, *FIRST, "--cells", 8000, "--json")
    blocks = []
    for at in ((1.5, -0.1, 0.1), (1.6, -0.15, 0.12)):
        rod(*at)
        report = meshonet(*words, "-o", "g.h5").only
        assert report["folded"] == 0
        blocks.append((report["blocks"], report["interfaces"]))
    assert blocks[0] == blocks[1]


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        ((), "the layout leaves room for layers; give --first-cell or --y-plus"),
        ((*FIRST, "--walls", "rod"), "the layout has layers around naca0012; name the same walls"),
    ],
)
def test_other_layers_than_it_is_for_are_refused(
    meshonet: Meshonet, saved: str, words: tuple[object, ...], problem: str
) -> None:
    rod(1.5, -0.1, 0.1)
    done = meshonet("infer", *BODIES, "--layout", saved, *words, "-o", "g.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1), done.err
    assert problem in done.err


def test_a_layout_of_all_of_a_domain_takes_layers_around_walls_without_sharp_corners(
    meshonet: Meshonet,
) -> None:
    rod(1.5, -0.1, 0.1)
    Path("box.csv").write_text("0,-1\n4,-1\n4,1\n0,1\n")
    words = ("box.csv", "rod.csv", "--assemble")
    assert meshonet("layout", *words, "-o", "l.json").code == 0
    done = meshonet("infer", *words, "--layout", "l.json", "--first-cell", 1e-3, "-o", "g.h5")
    assert done.code == 0, done.err
    np.testing.assert_allclose(first_cells(grid_of("g.h5")), 1e-3, rtol=1e-6)
    assert meshonet("layout", *BODIES, "-o", "sharp.json").code == 0
    done = meshonet("infer", *BODIES, "--layout", "sharp.json", *FIRST, "-o", "g.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "the layout has no layers around naca0012, which has sharp corners; give" in done.err


def test_cells_and_inputs_that_a_layout_outside_layers_cannot_be_are_refused(
    meshonet: Meshonet, saved: str
) -> None:
    rod(1.5, -0.1, 0.1)
    done = meshonet("layout", *BODIES, *FIRST, "--cells", 900, "-o", "l.json")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "--cells for the blocks outside of layers, which have no cells yet; give --cells when" in done.err
    done = meshonet("infer", saved, *FIRST, "-o", "g.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "is a layout of what layers leave of a domain; give the domain, and this with --layout" in done.err


@pytest.mark.parametrize(("option", "size"), [("--cell-size", 0.08), ("--res", 50)])
def test_a_size_of_cells_is_that_of_the_longest_edges_outside_layers(
    meshonet: Meshonet, option: str, size: float
) -> None:
    rod(1.5, -0.1, 0.1)
    Path("box.csv").write_text("0,-1\n4,-1\n4,1\n0,1\n")
    words = ("infer", "box.csv", "rod.csv", "--assemble", "--first-cell", 1e-3, option)
    assert meshonet(*words, size, "-o", "g.h5").code == 0
    grid = grid_of("g.h5")
    np.testing.assert_allclose(first_cells(grid), 1e-3, rtol=1e-6)
    outer = [patch for patch in grid.outer_patches() if patch.kind != "wall"]
    cut = {"south": np.s_[:, 0], "north": np.s_[:, -1], "west": np.s_[0], "east": np.s_[-1]}
    sides = [grid.blocks[patch.block].nodes[cut[patch.side]] for patch in outer]
    steps = np.concatenate([np.hypot(*np.diff(side[:, :2], axis=0).T) for side in sides])
    assert 0.04 < np.median(steps) <= 0.08
    assert steps.max() < 1.5 * 0.08


@pytest.mark.parametrize(
    ("walls", "problem"),
    [
        (
            ("--walls", "ramp"),
            "layers at ramp would end where the boundary goes straight on, at (2, 0); name floor as well",
        ),
        (("--walls", "step"), "would end where the boundary turns away, at (4, 2.5); name roof as well"),
    ],
)
def test_walls_that_no_layers_go_along_are_refused(
    meshonet: Meshonet, walls: tuple[str, ...], problem: str
) -> None:
    ring = [[0, 0], [2, 0], [6, 2.4], [6, 3], [4, 3], [4, 2.5], [0, 2.5], [0, 0]]
    duct(ring, ["floor", "ramp", "outlet", "top", "step", "roof", "inlet"])
    words = ("infer", "duct.geojson", "--cells", 900, "--first-cell", 1e-3)
    done = meshonet(*words, *walls, "-o", "g.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1), done.err
    assert problem in done.err


def test_layers_go_along_a_smooth_outer_loop(meshonet: Meshonet) -> None:
    rod(1.5, -0.1, 0.1)
    pipe = "".join(f"{x!r},{y!r}\n" for x, y in circle(1.4, 0, 1, 200).tolist())
    Path("pipe.csv").write_text(pipe)
    words = ("infer", "pipe.csv", "rod.csv", "--assemble", "--first-cell", 1e-3, "--walls", "pipe,rod")
    done = meshonet(*words, "-o", "g.h5")
    assert done.code == 0, done.err
    grid = grid_of("g.h5")
    assert {patch.side for patch in grid.outer_patches()} == {"south"}


def duct(ring: list[list[float]], names: list[str]) -> None:
    """Write duct.geojson, a domain inside a ring of points, with a name from each to the next."""
    geometry = {"type": "Polygon", "coordinates": [ring]}
    text = json.dumps({"type": "Feature", "geometry": geometry, "properties": {"names": [names]}})
    Path("duct.geojson").write_text(text)


@pytest.mark.parametrize("walls", ["floor", "floor,roof", "floor,outlet,roof,inlet"])
def test_layers_go_along_named_walls_of_a_duct(meshonet: Meshonet, walls: str) -> None:
    duct([[0, 0], [4, 0], [4, 1], [0, 2], [0, 0]], ["floor", "outlet", "roof", "inlet"])
    words = ("infer", "duct.geojson", "--cells", 3000, "--first-cell", 1e-3, "--walls", walls)
    done = meshonet(*words, "-o", "g.h5")
    assert done.code == 0, done.err
    grid = grid_of("g.h5")
    for patch in grid.outer_patches():
        if patch.name in walls.split(","):
            nodes = grid.blocks[patch.block].nodes[..., :2]
            lines = nodes if patch.side in ("south", "north") else nodes.transpose(1, 0, 2)
            wall, beside = (0, 1) if patch.side in ("south", "west") else (-1, -2)
            height = np.hypot(*(lines[:, beside] - lines[:, wall]).T)
            np.testing.assert_allclose(height, 1e-3, rtol=1e-6)


def test_a_layout_outside_layers_along_walls_is_taken_for_a_duct_like_it(meshonet: Meshonet) -> None:
    names = ["floor", "outlet", "roof", "inlet"]
    duct([[0, 0], [4, 0], [4, 1], [0, 2], [0, 0]], names)
    words = ("--first-cell", 1e-3, "--walls", "floor,roof")
    assert meshonet("layout", "duct.geojson", *words, "-o", "l.json").code == 0
    duct([[0, 0], [5, 0], [5, 1.5], [0, 2], [0, 0]], names)
    done = meshonet("infer", "duct.geojson", "--layout", "l.json", *words, "--refine", 1, "-o", "g.h5")
    assert done.code == 0, done.err
    assert all((n - 1) % 2 == 0 for block in grid_of("g.h5").blocks for n in block.nodes.shape[:2])


def test_counts_with_which_cells_stay_folded_are_named(meshonet: Meshonet) -> None:
    """An ellipse in a channel, whose layers need more cells around it than are given along its sides."""
    t = np.linspace(0.0, 2.0 * np.pi, 101)
    ellipse = np.stack([0.5 * np.cos(t), 0.2 * np.sin(t)], axis=1)
    ellipse[-1] = ellipse[0]
    channel = [[-2, -1], [4, -1], [4, 1], [-2, 1], [-2, -1]]
    properties = {"names": [["floor", "outlet", "ceiling", "inlet"], "body"]}
    geometry = {"type": "Polygon", "coordinates": [channel, ellipse.tolist()]}
    text = json.dumps({"type": "Feature", "properties": properties, "geometry": geometry})
    Path("channel.geojson").write_text(text)
    counts = "body=24,inlet=24,floor=60"
    done = meshonet("infer", "channel.geojson", "--first-cell", "5e-3", "--count", counts, "-o", "g.h5")
    assert done.code == 3
    assert "leave --count body=24, inlet=24, floor=60 out, or give numbers nearer to" in done.err
