"""Requests whose work has no end: refused beforehand with what is out of reach, or done in good time."""

import json
import time
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

SQUARE = [(0, 0), (1, 0), (1, 1), (0, 1)]
LONGEST = 25.0
"""Seconds of the processor for any request."""


def polygon(*rings: object) -> None:
    """Write a polygon, its rings closed, as GeoJSON."""
    closed = [[*ring, ring[0]] for ring in rings]
    Path("domain.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": closed}))


def points(*rows: tuple[float, ...]) -> None:
    """Write points as text."""
    Path("points.csv").write_text("\n".join(" ".join(map(repr, row)) for row in rows))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--inlet", "1e300"), "a passage of length 1e+300 takes 7.2e+300 cells, more than 2.5e+04; use a"),
        (("--outlet", "1e7"), "use a shorter --outlet, or more --cells"),
        (("--res", "100000"), "takes 3.33e+09 cells, more than 2e+07"),
    ],
)
def test_a_passage_is_not_longer_than_its_cells(
    meshonet: Meshonet, words: tuple[str, ...], message: str
) -> None:
    points((0.0, 0.0), (1.0, -0.01), (1.0, 0.01))
    done = meshonet("infer", "points.csv", "--pitch", "0,1", *words, "-o", "g.vtm")
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1


def test_a_needle_has_as_many_columns_as_its_layers_need(meshonet: Meshonet) -> None:
    """Columns grow from the base of the needle on; one base is 1e-9 of its length."""
    polygon(SQUARE, [(0.3, 0.5), (0.7, 0.5 - 1e-9), (0.7, 0.5 + 1e-9)])
    begun = time.process_time()
    done = meshonet("infer", "domain.geojson", "--first-cell", "1e-3", "-o", "g.vtm", "--json")
    assert time.process_time() - begun < LONGEST
    assert done.only["folded"] == 0
    assert done.only["cells"] < 40_000


def test_a_needle_in_a_cascade_ends(meshonet: Meshonet) -> None:
    points((0.0, 0.0), (1.0, -1e-9), (1.0, 1e-9))
    begun = time.process_time()
    done = meshonet("infer", "points.csv", "--pitch", "0,0.2", "--cells", "1500", "-o", "g.vtm")
    assert time.process_time() - begun < LONGEST
    assert done.code in (0, 2, 3)
    assert done.err.count("\n") == 1 or done.code == 0


def test_a_path_that_turns_everywhere_is_refused(meshonet: Meshonet) -> None:
    points(*((0.5 * (-1.0) ** k, 1e-3 * k, 0.0) for k in range(5000)))
    done = meshonet("sweep", "circle:0.5", "points.csv", "--cells", "200", "-o", "g.vtm")
    assert done.code == 2
    assert "a path of length 4999 that bends with a radius of " in done.err
    assert "cells, more than 2e+07; smooth the path, or give --planes" in done.err


@pytest.mark.parametrize("more", [(), ("--first-cell", "1e-3")])
def test_cells_larger_than_the_domain_are_its_coarsest(meshonet: Meshonet, more: tuple[str, ...]) -> None:
    polygon(SQUARE, [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)])
    counts = []
    for size in ("1", "1e300"):
        words = ("--cell-size", size, *more, "-o", f"{size}.vtm", "--json")
        counts.append(meshonet("infer", "domain.geojson", *words).only["cells"])
    assert counts[0] == counts[1]


@pytest.mark.parametrize("name", ["large.geojson", "large.wkt"])
def test_outlines_of_many_megabytes_are_not_read(meshonet: Meshonet, name: str) -> None:
    with Path(name).open("wb") as file:
        file.truncate(1 << 34)
    done = meshonet("infer", name, "-o", "g.vtm")
    assert done.code == 2
    assert f"{name}: 16384 MB are too much for a text of points; give a file below 16 MB" in done.err


def test_a_format_of_a_field_is_shown_as_it_is_written(meshonet: Meshonet) -> None:
    done = meshonet("tfi", "naca:0012", "--res", "9", "-o", "a{index:c}.vts")
    assert done.err.endswith("use e.g. {index:04d}\n")


@pytest.mark.parametrize("side", ["south", "north"])
def test_first_cells_off_one_wall_slide_its_nodes(meshonet: Meshonet, duct_csv: Path, side: str) -> None:
    """As those off both do; before, lines leaned by 40 degrees in the layers."""
    words = ("--res", "81x41", f"--spacing-{side}", "1e-3")
    done = meshonet("solve-pde", duct_csv, *words, "-o", "g.vts", "--json")
    assert "wall nodes slid along south and north" in done.only["notes"]
    report = meshonet("quality", "g.vts", "--json").only
    off = {wall["name"]: wall["off_square"]["max"] for wall in report["walls"]}
    assert off[side] < 5.0


def test_planes_beyond_what_grids_can_have_are_refused_at_once(meshonet: Meshonet) -> None:
    Path("path.csv").write_text("0 0 0\n1 0 0\n2 .3 0\n3 1 0\n")
    done = meshonet("sweep", "circle:0.5", "path.csv", "--planes", "100000", "-o", "pipe.h5")
    assert done.code == 2
    assert "--planes: a section in 100000 planes takes" in done.err
    assert not Path("pipe.h5").exists()


@pytest.mark.parametrize(
    ("words", "noted"),
    [
        (("solve-pde", "--method", "winslow"), True), (("tfi",), True), (("solve-pde",), False),
        (("solve-pde", "--method", "winslow", "--slide"), False),
    ],
)  # fmt: skip
def test_a_note_says_where_lines_lean_in_layers(
    meshonet: Meshonet, duct_csv: Path, words: tuple[str, ...], noted: bool
) -> None:
    report = meshonet(
        words[0], duct_csv, *words[1:], "--res", "81x41", "--first-cell", "1e-3", "-o", "g.vts", "--json"
    ).only
    assert noted == any(
        "degrees off the right angle; elliptic methods with --slide" in n for n in report["notes"]
    )


def test_the_walls_of_a_four_sided_grid_are_listed(meshonet: Meshonet, duct_csv: Path) -> None:
    meshonet("tfi", duct_csv, "--res", "21x11", "--first-cell", "1e-2", "-o", "g.vts")
    done = meshonet("quality", "g.vts")
    assert "at the walls" in done.out
    assert "south: first cell        0.01   0.01   0.01" in done.out


@pytest.fixture
def duct_csv() -> Path:
    """A channel as four edges, whose floor has a steep bump."""
    x, y = np.linspace(0, 4, 81), np.linspace(0, 1, 9)
    floor = 0.35 * np.exp(-(((x - 2) / 0.35) ** 2))
    edges = ((x, floor), (4 + 0 * y, y), (x[::-1], 1 + 0 * x), (0 * y, y[::-1]))
    floor[[0, -1]] = 0.0
    text = "\n\n".join(
        "\n".join(f"{float(a)!r} {float(b)!r}" for a, b in zip(*e, strict=True)) for e in edges
    )
    Path("duct.csv").write_text(text)
    return Path("duct.csv")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ("naca:0012", "--refine", "8"),
            "--refine: a grid of 200x100 nodes, its cells halved 8 times, t",
        ),
        (("naca:0012", "--topology", "c", "--te", "exact", "--refine", "8"), "times, takes 1.29e+09 cells"),
        (("domain.geojson", "--refine", "8"), "--refine: 2500 cells halved 8 times are 1.64e+08; use fewer"),
        (("domain.geojson", "--first-cell", "1e-2", "--refine", "8"), "20000 cells halved 8 times"),
        (("domain.geojson", "--res", "100", "--refine", "6"), "9600 cells halved 6 times are 3.93e+07"),
        (
            ("domain.geojson", "--res", "100000"),
            "--res: edges of 1e-05 are more than 20000000 cells; use at",
        ),
        (("domain.geojson", "--cell-size", "1e-3", "--refine", "3"), "960000 cells halved 3 times"),
    ],
)
def test_cells_are_not_halved_beyond_what_grids_can_have(
    meshonet: Meshonet, words: tuple[str, ...], message: str
) -> None:
    polygon(SQUARE, [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)])
    begun = time.process_time()
    done = meshonet("infer", *words, "-o", "g.vts")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert message in done.err
    assert time.process_time() - begun < 2.0
