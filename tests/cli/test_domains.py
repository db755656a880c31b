"""Domains of many blocks from the command line: what is read, what is made of it, what is refused."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from block_files import grid_of
from command_line import Meshonet
from domains import circle

from meshonet.geometry.blocks.grid import Grid

STEP = "POLYGON ((0 1, 2 1, 2 0, 6 0, 6 2, 0 2, 0 1))"
BOX = [[0, 0], [4, 0], [4, 2], [0, 2], [0, 0]]
HOLES = [
    [[1, 0.7], [1.5, 0.7], [1.5, 1.2], [1, 1.2], [1, 0.7]],
    [[2.5, 0.7], [3, 0.7], [2.8, 1.2], [2.5, 0.7]],
]


def feature(rings: list[list[list[float]]], **properties: object) -> str:
    polygon = {"type": "Polygon", "coordinates": rings}
    return json.dumps({"type": "Feature", "geometry": polygon, "properties": properties})


def write(name: str, text: str) -> str:
    Path(name).write_text(text)
    return name


def lines(points: np.ndarray) -> str:
    return "".join(f"{x!r},{y!r}\n" for x, y in points.tolist())


def names(grid: Grid) -> set[str]:
    return {patch.name for patch in grid.outer_patches()}


def test_a_polygon_with_holes_becomes_blocks_whose_parts_are_named(meshonet: Meshonet) -> None:
    write("plate.geojson", feature([BOX, *HOLES]))
    report = meshonet("infer", "plate.geojson", "--cells", 1500, "--json", "-o", "plate.h5").only
    grid = grid_of("plate.h5")
    assert report["blocks"] == len(grid.blocks) > 8
    assert abs(report["cells"] - 1500) < 300
    assert report["folded"] == 0
    assert report["interfaces"] == len(grid.connections)
    assert len(report["quality"]["max_angle"]["worst"]) == 3
    assert (report["method"], report["ni"], report["topology"]) == ("blocks", None, "blocks")
    assert names(grid) == {"outer", "body", "body2"}
    area = sum(signed_area(block.nodes) for block in grid.blocks)
    assert area == pytest.approx(8 - 0.25 - 0.125, rel=1e-9)


def signed_area(nodes: np.ndarray) -> float:
    ring = np.concatenate([nodes[:-1, 0], nodes[-1, :-1], nodes[:0:-1, -1], nodes[0, :0:-1]])
    x, y = ring.T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_names_and_corners_of_geojson_are_kept(meshonet: Meshonet) -> None:
    sides = ["floor", "outlet", "roof", "inlet"]
    ring = [[0, 0], [2, 0], [4, 0], [4, 2], [0, 2], [0, 0]]
    text = feature([ring, HOLES[0]], names=[sides, "cylinder"], corners=[[0, 2, 3, 4], [0, 1, 2, 3]])
    write("channel.geojson", text)
    assert meshonet("infer", "channel.geojson", "--cells", 800, "-o", "a.h5").code == 0
    assert names(grid_of("a.h5")) == {*sides, "cylinder"}


@pytest.mark.parametrize(
    ("properties", "message"),
    [
        ({"names": ["a"]}, "property 'names' has 1 entries and the polygon 2 rings; give one entry for each"),
        ({"names": [["a", "b"], "c"]}, "ring 1: 2 names and 4 corners that were found; give one name"),
        ({"names": [7, "c"]}, "ring 1: property 'names' holds no names"),
        ({"corners": [[0, 9], []]}, "ring 1: corner 9 of a ring of 4 points; use 0 to 3"),
        ({"corners": [[0, 1.5], []]}, "ring 1: property 'corners' holds no list of point numbers"),
        ({"corners": 5}, "property 'corners' has no list and the polygon 2 rings"),
    ],
)
def test_properties_that_do_not_fit_are_refused(
    meshonet: Meshonet, properties: dict[str, object], message: str
) -> None:
    write("bad.geojson", feature([BOX, HOLES[0]], **properties))
    done = meshonet("infer", "bad.geojson", "-o", "a.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert f"bad.geojson: {message}" in done.err


HOSTILE = {
    "crossing rings": (feature([BOX, [[3, 1], [5, 1], [5, 1.5], [3, 1]]]), "cross at (4, "),
    "touching rings": (feature([BOX, [[1, 0], [2, 0.5], [1.5, 1], [1, 0]]]), "touch at (1, 0)"),
    "equal rings": (feature([BOX, BOX[::-1]]), "touch at"),
    "a hole outside": (feature([BOX, [[5, 0], [6, 0], [6, 1], [5, 0]]]), "lies outside of loop 0 (outer)"),
    "a hole in a hole": (
        feature([BOX, HOLES[0], [[1.1, 0.8], [1.2, 0.8], [1.2, 0.9], [1.1, 0.8]]]),
        "lies inside of loop 1 (body)",
    ),
    "a ring on a line": (feature([BOX, [[1, 1], [2, 1], [3, 1], [1, 1]]]), "ring 2: "),
    "a bow tie": (feature([[[0, 0], [2, 2], [2, 0], [0, 2.5], [0, 0]]]), "crosses itself at (1."),
}


@pytest.mark.parametrize("case", HOSTILE)
@pytest.mark.parametrize("command", ["infer", "layout"])
def test_loops_that_bound_no_domain_are_one_line(meshonet: Meshonet, case: str, command: str) -> None:
    text, report = HOSTILE[case]
    write("bad.geojson", text)
    done = meshonet(command, "bad.geojson", "-o", "a.json" if command == "layout" else "a.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1), done.err
    assert done.err.startswith("error: bad.geojson: ")
    assert report in done.err
    assert "; " in done.err


@pytest.mark.parametrize("blank", ["\n", ""])
def test_points_of_several_closed_curves_are_a_domain(meshonet: Meshonet, blank: str) -> None:
    rings = [
        np.array(BOX, dtype=float),
        *(np.concatenate([c, c[:1]]) for c in (circle(1, 1, 0.3), circle(3, 1, 0.4))),
    ]
    write("plate.csv", blank.join(map(lines, rings)))
    assert meshonet("solve-pde", "plate.csv", "--cells", 900, "-o", "a.h5").code == 0
    assert names(grid_of("a.h5")) == {"outer", "body", "body2"}


def test_a_mesh_of_several_loops_is_a_domain_with_its_names(meshonet: Meshonet) -> None:
    write("plate.geojson", feature([BOX, *HOLES], names=["box", "square", "wedge"]))
    assert meshonet("infer", "plate.geojson", "--cells", 900, "-o", "plate.su2").code == 0
    assert meshonet("infer", "plate.su2", "--cells", 500, "-o", "again.h5").code == 0
    assert names(grid_of("again.h5")) == {"box", "square", "wedge"}


def test_inputs_are_assembled_in_a_far_field_or_a_box(meshonet: Meshonet) -> None:
    write("tail.csv", lines(circle(1.6, -0.1, 0.08)))
    write("tunnel.csv", lines(np.array([[-2.0, -1], [4, -1], [4, 1], [-2, 1]])))
    bodies = ("naca:0012", "tail.csv", "--assemble", "--cells", 2000)
    assert meshonet("infer", *bodies, "--far-field", 8, "-o", "{stem}.h5").code == 0
    free = grid_of("naca0012.h5")
    assert names(free) == {"farfield", "naca0012", "tail"}
    nodes = np.concatenate([b.nodes.reshape(-1, 2) for b in free.blocks])
    widest = max(np.ptp(nodes @ [np.cos(turn), np.sin(turn)]) for turn in np.linspace(0, np.pi, 360))
    assert widest == pytest.approx(16 * 1.68, rel=1e-3)
    assert meshonet("infer", "tunnel.csv", *bodies, "-o", "boxed.h5").code == 0
    assert names(grid_of("boxed.h5")) == {"tunnel", "naca0012", "tail"}
    done = meshonet("infer", "tunnel.csv", *bodies, "--far-field", 8, "-o", "none.h5")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert "tunnel encloses the others; leave --far-field out" in done.err


def test_one_block_stays_one_and_single_asks_for_it(meshonet: Meshonet) -> None:
    write("box.wkt", "POLYGON ((0 0, 4 0, 4 2, 0 2, 0 0))")
    write("step.wkt", STEP)
    assert meshonet("infer", "box.wkt", "--res", "9x5", "--json", "-o", "a.h5").only["ni"] == 9
    assert meshonet("infer", "step.wkt", "--json", "-o", "a.h5").only["blocks"] == 3
    assert (
        meshonet("infer", "step.wkt", "--blocks", "single", "--json", "-o", "a.h5").only["topology"] == "quad"
    )
    circle = [[math.cos(0.1 * math.pi * k), math.sin(0.1 * math.pi * k)] for k in [*range(20), 0]]
    write("disc.geojson", feature([circle]))
    disc = meshonet("infer", "disc.geojson", "--blocks", "single", "--json", "-o", "a.h5").only
    assert disc["topology"] == "o"
    assert any("surrounds the closed curve" in note for note in disc["notes"])
    write("plate.geojson", feature([BOX, *HOLES]))
    done = meshonet("infer", "plate.geojson", "--blocks", "single", "-o", "none.h5")
    message = "a domain with 2 holes is not one block; let infer or solve-pde find its blocks"
    assert done.err == f"error: plate.geojson: {message}\n"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--cells 0", "--cells: 0 cells; use 1 to"),
        ("--cells 100 --cell-size .1", "--cells and --cell-size both say how many cells there are; give one"),
        ("--cell-size -1", "--cell-size: -1 is not a positive length"),
        ("--cells 100 --topology o", "--cells asks for many blocks and --topology for one; give one of them"),
        ("--cells 100 --blocks single", "--cells asks for many blocks and --blocks for one"),
        ("--walls a", "--walls without a first cell; give --first-cell or --y-plus as well"),
        ("--cells 9 --walls a, --first-cell 1", "--walls: an empty name; give the names of walls"),
        ("--walls slot --first-cell .01", "--walls: there is no wall 'slot'; use outer"),
        ("--pitch 1", "--pitch: '1' is not a vector; use DX,DY"),
        ("--inlet 1", "--inlet without --pitch; give --pitch as well, or drop --inlet"),
        ("--res 9x5", "--res: 9 x 5 nodes for many blocks; give one number"),
        ("--res 9x5 --walls outer --first-cell .01", "--res: 9 x 5 nodes for many blocks; give one number"),
        ("--spacing cosine", "--spacing is of no use to a domain of many blocks; drop --spacing"),
        ("--far-field 9", "a domain with a boundary of its own has no far field; leave --far-field out"),
        ("--layout missing.json", "missing.json: no such file"),
        (
            "--first-cell .01",
            "in a domain without holes; name the walls with --walls (of outer)",
        ),
    ],
)
def test_options_that_do_not_go_together_are_refused(meshonet: Meshonet, words: str, message: str) -> None:
    write("step.wkt", STEP)
    done = meshonet("infer", "step.wkt", *words.split(), "-o", "none.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1), done.err
    assert message in done.err


def test_a_layout_serves_a_family_of_shapes_and_of_resolutions(meshonet: Meshonet) -> None:
    write("step.wkt", STEP)
    write("tall.wkt", "POLYGON ((0 1, 2.5 1, 2.5 0, 6 0, 6 3, 0 3, 0 1))")
    report = meshonet("layout", "step.wkt", "-o", "step.json", "--json").only
    assert (report["blocks"], report["irregular"]) == (3, 0)
    for shape, cells in (("step.wkt", 300), ("tall.wkt", 300), ("tall.wkt", 1200)):
        words = (shape, "--layout", "step.json", "--cells", cells, "-o", "a.h5")
        made = meshonet("infer", *words, "--json").only
        assert (made["blocks"], made["irregular"], made["folded"]) == (3, 0, 0)
        assert abs(made["cells"] - cells) < 0.2 * cells
    assert meshonet("infer", "step.json", "--cells", 300, "-o", "b.h5").code == 0, "a layout is a domain"
    write("box.wkt", "POLYGON ((0 0, 4 0, 4 2, 0 2, 0 0))")
    done = meshonet("infer", "box.wkt", "--layout", "step.json", "-o", "none.h5")
    assert (
        "--layout: loop 0 (outer) has 4 corners, in the layout it has 6; give a layout of the same"
        in done.err
    )


def test_a_layout_cannot_be_read_from_another_file(meshonet: Meshonet) -> None:
    write("step.wkt", STEP)
    done = meshonet("infer", "step.wkt", "--layout", "step.wkt", "-o", "a.h5")
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "step.wkt: is not JSON" in done.err


def test_domains_of_a_batch_go_to_several_processes(meshonet: Meshonet) -> None:
    for k, height in enumerate((2, 2.5, 3)):
        write(f"{k}.wkt", STEP.replace("6 2, 0 2", f"6 {height}, 0 {height}"))
    inputs = ("0.wkt", "1.wkt", "2.wkt")
    assert meshonet("infer", *inputs, "--cells", 300, "--jobs", 2, "-o", "j{stem}.h5").code == 0
    assert meshonet("infer", *inputs, "--cells", 300, "-o", "s{stem}.h5").code == 0
    for k in range(3):
        one, other = (grid_of(f"{way}{k}.h5") for way in "js")
        assert all(np.array_equal(a.nodes, b.nodes) for a, b in zip(one.blocks, other.blocks, strict=True))
    again = meshonet("infer", *inputs, "--cells", 300, "--skip-existing", "-o", "s{stem}.h5")
    assert again.err.count("there already") == 4
