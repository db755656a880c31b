"""What was changed of shapes reaches whoever makes many grids, and whoever reads one of the files."""

import re
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids
from meshonet.geometry.shapes.airfoil.naca import naca_points

WEDGE = "the outline is changed: its base, 0.00252 chords wide, is closed by a wedge"
LEFT_OUT = "line 3, '0.50  .....', is no pair of numbers and is left out"
FAR = "the far field is 15 chords away, the default: for lift and drag give --far-field 100 or more"
C_GRIDS = ("--topology", "c", "--te", "wedge", "--first-cell", "1e-4", "--res", "120x40")


@pytest.fixture
def torn_dat() -> Path:
    """A diamond with a line that is none."""
    path = Path("torn.dat")
    path.write_text("torn\n1 0\n0.50  .....\n0.5 0.06\n0.25 0.05\n0 0\n0.25 -0.05\n0.5 -0.06\n1 0\n")
    return path


def test_changes_stand_below_the_line_of_a_grid_and_are_counted(meshonet: Meshonet, torn_dat: Path) -> None:
    shapes = ("naca:0012", torn_dat, "naca:0012-sharp")
    done = meshonet("infer", *shapes, *C_GRIDS, "-o", "{index}.vts")
    lines = done.err.splitlines()
    assert done.code == 0
    assert lines[0].startswith("naca:0012 -> ")
    assert lines[1].startswith(f"  {WEDGE}")
    assert (lines[2].startswith("torn.dat -> "), lines[3]) == (True, f"  {LEFT_OUT}")
    assert "up to 0.012 chords away from straight lines between them" in lines[4]
    assert lines[5].startswith("naca:0012-sharp -> ")
    assert lines[7:] == ["2 shapes were changed: see below the line of the grid", FAR]
    assert meshonet("infer", *shapes, *C_GRIDS, "-o", "{index}.vts", "-q").err == ""


@pytest.mark.parametrize("words", [(), ("--jobs", "2")])
def test_changes_are_in_json(meshonet: Meshonet, words: tuple[str, ...]) -> None:
    shapes = ("naca:0012", "naca:0012-sharp")
    reports = meshonet("infer", *shapes, *C_GRIDS, *words, "-o", "{index}.vts", "--json").objects
    assert [len(one["changes"]) for one in reports] == [1, 0]
    assert reports[0]["changes"][0].startswith(WEDGE)
    assert reports[0]["changes"][0] in reports[0]["notes"]


@pytest.mark.parametrize("output", ["g.vts", "g.h5", "g.cgns", "g.vtk"])
def test_files_say_what_was_changed(meshonet: Meshonet, output: str) -> None:
    assert meshonet("infer", "naca:0012", *C_GRIDS, "-o", output).code == 0
    (grid,) = read_grids(output)
    assert str(grid.provenance["changes"]).startswith(WEDGE)
    assert meshonet("infer", "naca:0012-sharp", *C_GRIDS, "-o", output).code == 0
    (grid,) = read_grids(output)
    assert "changes" not in grid.provenance


@pytest.mark.parametrize("command", ["infer", "solve-pde", "tfi"])
def test_the_default_far_field_of_a_viscous_grid_is_noted(meshonet: Meshonet, command: str) -> None:
    words = (command, "naca:0012", "--res", "80x40", "-o", "g.vts")
    assert FAR in meshonet(*words, "--first-cell", "1e-3").err
    assert "far field" not in meshonet(*words, "--first-cell", "1e-3", "--far-field", "15").err
    assert "for lift and drag" not in meshonet(*words).err


def test_bodies_that_are_no_airfoils_have_their_own_unit(meshonet: Meshonet) -> None:
    words = ("--first-cell", "1e-2", "-o", "g.h5")
    assert "is 15 extents of the body away" in meshonet("infer", "circle:0.5", "--res", "60x40", *words).err
    bodies = ("naca:0012", "circle:2", "--assemble", "--cells", "3000")
    assert "for lift and drag" not in meshonet("infer", *bodies, *words).err  # the circle is the far field
    several = meshonet("infer", "naca:0012", "--cells", "3000", *words)
    assert "is 15 extents of the bodies away" in several.err


def test_a_c_grid_says_how_many_nodes_the_body_has(meshonet: Meshonet) -> None:
    words = ("infer", "naca:0012-sharp", *C_GRIDS, "--wake-nodes", "31", "-o", "g.h5")
    assert "120 x 40 nodes, c grid with 60 nodes on the body and 31 on the wake" in meshonet(*words).err
    report = meshonet(*words, "--json").only
    assert (report["body_nodes"], report["wake_nodes"]) == (60, 31)
    (grid,) = read_grids("g.h5")
    (wall,) = (patch for patch in grid.patches if patch.name == "wall")
    assert wall.stop - wall.start + 1 == 60
    assert "body_nodes" not in meshonet("infer", "naca:0012", "--res", "60x30", "-o", "o.h5", "--json").only


def test_a_hole_in_the_points_is_told_in_a_batch(meshonet: Meshonet) -> None:
    points = naca_points("2412-sharp", 61)
    gap = (np.arange(len(points)) > 60) & (points[:, 0] > 0.2) & (points[:, 0] < 0.8)
    Path("hole.dat").write_text("hole\n" + "\n".join(f"{x:.8f} {y:.8f}" for x, y in points[~gap]))
    words = ("infer", "hole.dat", "naca:0012", "--topology", "o", "--res", "80x30", "-o", "{index}.vts")
    lines = meshonet(*words).err.splitlines()
    assert re.match(r"  the wall is a smooth curve .* up to 0[.]00\d+ chords away", lines[1])
    assert lines[2].startswith("naca:0012 -> ")
    reports = meshonet(*words, "--json").objects
    assert [len(one["changes"]) for one in reports] == [1, 0]
