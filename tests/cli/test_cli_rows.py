"""``meshonet stack`` of rows of blades: files with names, and options that rows do not have."""

import re
from pathlib import Path

import blade_row
import pytest
from command_line import Meshonet

from meshonet.formats.registry import read_grids

SMALL = ("--cells", "20000", "--first-cell", "0.002", "-q")


@pytest.fixture
def row(tmp_path: Path) -> Path:
    return blade_row.write_row(tmp_path, "tip_gap = 0.05")


@pytest.mark.parametrize("ending", ["cgns", "vtm", "xyz"])
def test_a_row_becomes_a_file_with_its_names_and_periodic_sides(
    meshonet: Meshonet, row: Path, ending: str
) -> None:
    words = ("--cells", "20000", "--first-cell", "0.01", "--growth", "1.5", "-q")  # 77,402 cells
    done = meshonet("stack", str(row), *words, "-o", f"row.{ending}")
    assert done.code == 0, done.err
    (grid,) = read_grids(f"row.{ending}")
    named = {patch.name for patch in grid.patches}
    assert {"blade", "tip", "hub", "shroud", "inlet", "outlet"} <= named
    assert grid.quality().folded == 0
    if ending == "cgns":
        assert any(each.transform and each.transform.turn for each in grid.connections)


@pytest.mark.parametrize(
    ("option", "words"),
    [
        (("--around", "65"), "a row has no --around"),
        (("--tip", "flat"), "a row has no --tip"),
        (("--surface",), "a row has no --surface"),
        (("--layers", "20"), "a row has no --layers"),
    ],
)
def test_options_of_wings_are_refused(meshonet: Meshonet, row: Path, option, words: str) -> None:
    done = meshonet("stack", str(row), *option, "-o", "row.cgns")
    assert done.code == 2
    assert words in done.err
    assert not Path("row.cgns").exists()


def test_the_report_says_what_edges_are_and_how_cells_grow(meshonet: Meshonet, row: Path) -> None:
    done = meshonet("stack", str(row), *SMALL[:-1], "--growth", "1.2", "-o", "row.vtm")
    assert done.code == 0
    assert "leading edge round; trailing edge round" in done.err
    assert re.search(r"\d+ cells in a passage instead of 20000", done.err)


def test_a_hub_that_ends_within_the_blade_is_named(meshonet: Meshonet, tmp_path: Path) -> None:
    row = blade_row.write_row(tmp_path, hub=blade_row.HUB[:14])
    done = meshonet("stack", str(row), *SMALL, "-o", "row.cgns")
    assert done.code == 2
    where = "row.toml: profile 1 (lines 2 to 161 of profile.curve): "
    assert where + "hub and casing end before the blade's point" in done.err


def test_the_report_has_the_dimensions_of_the_row_and_doubts_a_gap_in_another_unit(
    meshonet: Meshonet, tmp_path: Path
) -> None:
    row = str(blade_row.write_row(tmp_path, 'unit = "cm"\ntip_gap = 0.2'))
    coarse = ("--cells", "20000", "--first-cell", "0.02", "--growth", "1.8", "-o", "row.vtm")
    text = meshonet("stack", row, *coarse).err
    assert "row        23 blades, 15.65 degrees apart; chord 0.99" in text
    assert "edges      (x, r) in cm: leading (0.0" in text
    assert "tip_gap is 21.6 % of the span, usual are 0.02 to 10 %: is it in cm?" in text
    done = meshonet("stack", row, *coarse, "--json")
    data = done.only["row"]
    assert (data["blades"], data["unit"], data["tip_gap"]) == (23, "cm", pytest.approx(0.2))
    assert data["leading_edge"]["hub"][0] < data["trailing_edge"]["hub"][0]
