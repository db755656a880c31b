"""``meshonet deform``: grids follow changed walls."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid

SECTION = ("naca:0012", "--res", "81x33", "--topology", "c", "--te", "wedge", "--first-cell", "1e-4", "-q")


@pytest.fixture(autouse=True)
def start(meshonet: Meshonet) -> None:
    assert meshonet("infer", *SECTION, "-o", "start.h5").code == 0
    square = "0,0\n1,0\n1,1\n0,1\n0,0\n"
    Path("two.csv").write_text(square + "\n" + square.replace("0,", "5,").replace("1,", "6,"))


def only(path: str) -> Grid:
    (grid,) = read_grids(path)
    return grid


def test_the_grid_follows_an_outline_and_says_what_was_done(meshonet: Meshonet) -> None:
    done = meshonet("deform", "start.h5", "--wall", "naca:2412", "-o", "made.h5")
    assert done.code == 0, done.err
    assert "first cells at wall: heights changed by at most" in done.err
    assert "closed by a wedge" in done.err
    made = only("made.h5")
    assert made.provenance["method"] == "deformation"
    assert made.provenance["walls"] == "wall"
    assert np.abs(made.nodes[:, 0, 1] - only("start.h5").nodes[:, 0, 1]).max() > 0.015


def test_json_has_notes_and_figures(meshonet: Meshonet) -> None:
    done = meshonet("deform", "start.h5", "--wall", "wall=naca:2412", "-o", "made.h5", "--json")
    row = done.only
    assert row["folded"] == 0
    assert row["method"] == "deformation"
    assert row["notes"]


def test_turns_and_shifts_are_one_motion(meshonet: Meshonet) -> None:
    words = ("--rotate", "wall=90@0.5,0", "--shift", "wall=0.25,-1")
    assert meshonet("deform", "start.h5", *words, "-o", "made.h5", "-q").code == 0
    before, after = (only(path).nodes[40, 0] for path in ("start.h5", "made.h5"))
    x, y = before
    assert after == pytest.approx([0.5 - y + 0.25, x - 0.5 - 1], abs=1e-12)


def test_another_grid_is_a_wall_node_by_node_and_all_of_the_boundary(meshonet: Meshonet) -> None:
    meshonet("infer", "naca:2412", *SECTION[1:], "-o", "other.h5")
    for words in (("--wall", "wall=other.h5"), ("--wall", "other.h5")):
        assert meshonet("deform", "start.h5", *words, "-o", "made.h5", "-q").code == 0
        assert np.array_equal(only("made.h5").nodes[30:50, 0], only("other.h5").nodes[30:50, 0])
    assert np.array_equal(only("made.h5").nodes[:, -1], only("other.h5").nodes[:, -1])


def test_several_bodies_are_named(meshonet: Meshonet) -> None:
    for name, x in (("front", 0), ("rear", 3)):
        angle = np.linspace(0, 2 * np.pi, 60, endpoint=False)
        np.savetxt(f"{name}.csv", np.stack([x + np.cos(angle), np.sin(angle)], axis=1), delimiter=",")
    words = ("--assemble", "--cells", "600", "--far-field", "5", "--first-cell", "0.02", "-q")
    assert meshonet("infer", "front.csv", "rear.csv", *words, "-o", "two.h5").code == 0
    done = meshonet("deform", "two.h5", "--wall", "front.csv", "-o", "made.h5")
    assert done.code == 2
    assert "the grid has 2 walls: front, rear; name one: --wall NAME=FILE" in done.err
    assert not Path("made.h5").exists()
    done = meshonet("deform", "two.h5", "--shift", "rear=0.1,0.1", "-o", "made.h5")
    assert done.code == 0, done.err
    assert "first cells at rear" in done.err


def test_a_batch_names_its_failures(meshonet: Meshonet) -> None:
    meshonet("infer", "naca:0012", "--res", "41x15", "--te", "exact", "-o", "blunt.h5", "-q")
    done = meshonet("deform", "start.h5", "blunt.h5", "--shift", "wall=0,30", "-o", "{stem}-made.h5")
    assert done.code == 2
    assert "start.h5: --shift: wall is moved to the other side of farfield" in done.err
    done = meshonet("deform", "start.h5", "blunt.h5", "--shift", "wall=0,.1", "-o", "{stem}-made.h5", "-q")
    assert done.code == 0, done.err
    assert {path.name for path in Path().glob("*-made.h5")} == {"start-made.h5", "blunt-made.h5"}


@pytest.mark.parametrize(
    ("words", "says"),
    [
        ((), "nothing is moved; give --wall, --rotate or --shift"),
        (("--wall", "naca:2412", "--wall", "naca:2411"), "is not NAME=FILE"),
        (("--wall", "wall=naca:2412", "--shift", "wall=1,0"), "'wall' is moved twice"),
        (("--rotate", "wall=ten@0,0"), "is not NAME=DEGREES@X,Y"),
        (("--shift", "wall=1"), "is not NAME=DX,DY"),
        (("--shift", "wall=1,2,3", "--rotate", "wall=5@0,0"), "is turned in the plane"),
        (("--shift", "tail=1,2"), "--shift: the grid has no 'tail'"),
        (("--rotate", "tail=5@0,0"), "--rotate: the grid has no 'tail'"),
        (("--rotate", "tail=5@0,0", "--shift", "wall=1,2"), "start.h5: the grid has no 'tail'"),
        (("--wall", "tail=naca:2412"), "--wall: the grid has no 'tail'"),
        (("--wall", "missing.dat"), "missing.dat"),
        (("--wall", "two.csv"), "two.csv: holds several, where the new shape of a wall is asked for; give a"),
    ],
)
def test_bad_words_get_a_line(meshonet: Meshonet, words: tuple[str, ...], says: str) -> None:
    done = meshonet("deform", "start.h5", *words, "-o", "made.h5")
    assert done.code == 2
    assert says in done.err
    assert done.err.count("\n") == 1
    assert not Path("made.h5").exists()
