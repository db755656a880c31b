"""Layers at walls of four-sided domains: those named, or those that may be walls by their names."""

import math
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.across import rows_at

FIRST = 1e-4


def nozzle(axis: str = "axis", turned: bool = False) -> Path:
    """Write half of a nozzle with named sides, beside its axis, `turned` by 90 degrees about the origin."""
    x = np.linspace(0.0, 0.2, 41)
    sides = {
        axis: [[0.0, 0.0], [0.2, 0.0]],
        "wall": np.stack([x, 0.03 - 0.012 * np.sin(np.pi * x / 0.2) ** 2], axis=1).tolist(),
        "inlet": [[0.0, 0.0], [0.0, 0.03]],
        "outlet": [[0.2, 0.0], [0.2, 0.03]],
    }
    parts = []
    for name, points in sides.items():
        rows = [(-y + 0.0, x) if turned else (x, y) for x, y in points]
        parts.append(f"# {name}\n" + "\n".join(f"{x:.17g} {y:.17g}" for x, y in rows))
    Path("nozzle.csv").write_text("\n\n".join(parts) + "\n")
    return Path("nozzle.csv")


def first_cells(path: str) -> dict[str, float]:
    """Return the median first-cell height off each patch of a planar grid of one block."""
    (grid,) = read_grids(path)
    rows = {
        "south": (grid.nodes[:, 0], grid.nodes[:, 1]), "north": (grid.nodes[:, -1], grid.nodes[:, -2]),
        "west": (grid.nodes[0], grid.nodes[1]), "east": (grid.nodes[-1], grid.nodes[-2]),
    }  # fmt: skip
    return {
        p.name: float(np.median(np.linalg.norm(np.subtract(*rows[p.side]), axis=1))) for p in grid.patches
    }


@pytest.mark.parametrize("command", ["infer", "solve-pde", "tfi"])
@pytest.mark.parametrize("turned", [False, True])
def test_no_layers_are_at_sides_that_are_no_walls_by_their_names(
    meshonet: Meshonet, command: str, turned: bool
) -> None:
    words = ("--res", "61x41", "--first-cell", FIRST, "-o", "g.h5", "--json")
    report = meshonet(command, nozzle(turned=turned), *words).only
    heights = first_cells("g.h5")
    assert heights["wall"] == pytest.approx(FIRST, rel=1e-8)
    assert min(heights[name] for name in ("axis", "inlet", "outlet")) > 3 * FIRST
    assert (report["ni"], report["nj"], report["folded"]) == (61, 41, 0)


@pytest.mark.parametrize("words", ["--first-cell wall=1e-4", "--walls wall --first-cell 1e-4"])
@pytest.mark.parametrize("res", ["61x41", "61 --growth 1.2"])
def test_named_walls_of_a_four_sided_domain_have_layers_in_one_block(
    meshonet: Meshonet, words: str, res: str
) -> None:
    done = meshonet("infer", nozzle("centre"), "--res", *res.split(), *words.split(), "-o", "g.h5", "--json")
    assert (done.only["topology"], done.only["ni"]) == ("quad", 61)
    heights = first_cells("g.h5")
    assert heights["wall"] == pytest.approx(FIRST, rel=1e-8)
    assert heights["centre"] > 3 * FIRST
    assert done.only["quality"]["max_angle"]["max"] < 95.0


def test_xi_runs_along_walls_that_are_not_the_lowest_edge(meshonet: Meshonet) -> None:
    """A square whose walls are left and right by their names, with as many nodes along them as asked for."""
    corners = [[0, 0], [1, 0], [1, 2], [0, 2], [0, 0]]
    names = ["inlet", "right wall", "outlet", "left wall"]
    text = f'{{"type": "Feature", "properties": {{"names": [{names}]}}, "geometry": '.replace("'", '"')
    Path("up.geojson").write_text(text + f'{{"type": "Polygon", "coordinates": [{corners}]}}}}')
    report = meshonet(
        "infer", "up.geojson", "--res", "41x31", "--first-cell", "1e-3", "-o", "g.h5", "--json"
    ).only
    (grid,) = read_grids("g.h5")
    assert {p.name: p.side for p in grid.patches} == {
        "right wall": "south", "outlet": "east", "left wall": "north", "inlet": "west",
    }  # fmt: skip
    assert (report["ni"], report["nj"]) == (41, 31)
    assert np.ptp(grid.nodes[:, 0, 1]) == 2.0
    heights = first_cells("g.h5")
    assert heights["left wall"] == pytest.approx(1e-3)
    assert heights["right wall"] == pytest.approx(1e-3)
    assert any("xi runs along the walls" in note for note in report["notes"])


def test_walls_on_neighbouring_sides_make_many_blocks_unless_one_is_asked_for(meshonet: Meshonet) -> None:
    words = ("--first-cell", "wall=1e-4,inlet=1e-4", "-o", "g.h5", "--json")
    assert meshonet("infer", nozzle(), *words).only["topology"] == "blocks"
    assert meshonet("infer", nozzle(), *words, "--blocks", "single").only["topology"] == "quad"
    report = meshonet("infer", nozzle(), *words, "--res", "61x41").only
    assert report["topology"] == "quad"
    # sources at the inlet turned lines at the wall to 140
    assert report["quality"]["max_angle"]["max"] < 125.0


def test_an_unknown_wall_is_named_before_anything_else(meshonet: Meshonet) -> None:
    done = meshonet("infer", nozzle(), "--res", "61x41", "--first-cell", "wal=1e-4", "-o", "g.h5")
    assert done.code == 2
    assert "--first-cell: there is no wall 'wal'; use axis, " in done.err


def test_parts_of_a_side_are_no_walls_of_a_single_block(meshonet: Meshonet) -> None:
    path = nozzle()
    path.write_text(
        path.read_text().replace("0.20000000000000001 0\n\n", "0.1 0\n\n# pin\n0.1 0\n0.2 0\n\n", 1)
    )
    words = ("infer", path, "--res", "61x41", "--first-cell", "axis=1e-4", "-o", "g.h5")
    done = meshonet(*words)
    assert done.code == 2
    assert "one side of the block, whose first cells are equally high; give all the same" in done.err


def test_a_domain_without_walls_by_their_names_is_refused(meshonet: Meshonet) -> None:
    path = nozzle()
    path.write_text(path.read_text().replace("# wall", "# symmetry"))
    done = meshonet("infer", path, "--res", "61x41", "--first-cell", "1e-4", "-o", "g.h5")
    assert done.code == 2
    assert (
        "no side is a wall by its name: axis, outlet, symmetry, inlet; name the walls with --walls"
        in done.err
    )


def test_holes_that_are_no_walls_by_their_names_have_no_layers(meshonet: Meshonet) -> None:
    holes = [
        [[x - 0.1, -0.1], [x - 0.1, 0.1], [x + 0.1, 0.1], [x + 0.1, -0.1], [x - 0.1, -0.1]]
        for x in (-0.6, 0.6)
    ]
    outer = [[-1.5, -1], [1.5, -1], [1.5, 1], [-1.5, 1], [-1.5, -1]]
    names = '["outer", "plug", "suction inlet"]'
    text = f'{{"type": "Feature", "properties": {{"names": {names}}}, "geometry": {{"type": "Polygon", '
    Path("two.geojson").write_text(text + f'"coordinates": {[outer, *holes]}}}}}')
    words = ("infer", "two.geojson", "--first-cell", "1e-3", "--cells", "2000", "-o", "g.h5")
    assert meshonet(*words).code == 0
    (grid,) = read_grids("g.h5")
    heights: dict[str, list[float]] = {}
    for patch in grid.patches:
        wall, beside = rows_at(grid, patch, 2)
        heights.setdefault(patch.name, []).append(float(np.median(np.linalg.norm(beside - wall, axis=1))))
    assert heights["plug"] == pytest.approx([1e-3] * len(heights["plug"]))
    assert min(heights["suction inlet"]) > 1e-2


def test_y_plus_of_a_duct_names_its_length(meshonet: Meshonet) -> None:
    words = ("--y-plus", "30", "--reynolds", "1e6", "--res", "61x41", "-o", "g.h5", "--json")
    report = meshonet("infer", nozzle(), *words).only
    note = next(note for note in report["notes"] if note.startswith("y+"))
    height = first_cells("g.h5")["wall"]
    assert "y+ 30 at Re 1e+06 on a length of 0.2, the extent of south, needs first cells" in note
    assert f" of height {height:.6g}; y+ at their centres is half of that" in note
    assert "chord" not in note


def test_names_of_sides_stay_when_growth_decides_the_rows(meshonet: Meshonet) -> None:
    words = ("--res", "61", "--growth", "1.2", "--first-cell", FIRST, "-o", "g.h5")
    assert meshonet("infer", nozzle(), *words).code == 0
    (grid,) = read_grids("g.h5")
    assert {p.name for p in grid.patches} == {"axis", "wall", "inlet", "outlet"}


def test_names_of_parts_of_a_side_stay_in_place_beside_layers(meshonet: Meshonet) -> None:
    """A name that begins in the middle of a side does so in the grid, wherever the nodes went."""
    corners = [[0, 0], [2, 0], [2, 0.5], [2, 1], [0, 1], [0, 0]]
    properties = '{"corners": [[0, 1, 2, 3, 4]], "names": [["floor", "step", "outlet", "ceiling", "inlet"]]}'
    geometry = f'{{"type": "Polygon", "coordinates": [{corners}]}}'
    Path("d.geojson").write_text(f'{{"type": "Feature", "properties": {properties}, "geometry": {geometry}}}')
    words = ("--res", "61x41", "--spacing-south", "1e-3", "-o", "g.h5")
    assert meshonet("solve-pde", "d.geojson", *words).code == 0
    (grid,) = read_grids("g.h5")
    (step,) = (p for p in grid.patches if p.name == "step")
    east = grid.nodes[-1, :, 1]
    assert abs(east[step.stop] - 0.5) <= 0.5 * np.diff(east)[step.stop - 1 : step.stop + 1].max()


def test_an_unknown_wall_beside_a_lone_curve_is_told_how_that_is_named(meshonet: Meshonet) -> None:
    turn = [math.pi * k / 40.0 for k in range(80)]
    Path("rim.csv").write_text("# wall\n" + "".join(f"{math.cos(t)} {math.sin(t)}\n" for t in turn))
    done = meshonet("infer", "rim.csv", "--first-cell", "1e-2", "--walls", "wall", "-o", "rim.cgns")
    assert done.code == 2
    assert "use farfield, body; a curve that is alone in its file is the wall body" in done.err
