"""Grids judged as they are made: one mechanism for gates and profiles, in every command that makes grids."""

import json
import re
from pathlib import Path

import h5py
import pytest
from command_line import Meshonet, Process

from meshonet.formats.registry import read_grids
from meshonet.geometry.quality.profiles import PROFILES

FOILS = ("naca:0012", "naca:2412", "missing.dat")
VISCOUS = ("--res", "41x15", "--profile", "viscous", "-o", "{stem}.h5")


@pytest.mark.parametrize("jobs", [(), ("--jobs", "2")])
def test_a_batch_ends_in_a_table_of_verdicts(meshonet: Meshonet, jobs: tuple[str, ...]) -> None:
    done = meshonet("infer", *FOILS, *VISCOUS, *jobs)
    assert done.code == 2
    head, *lines, counts = done.out.splitlines()
    assert head.endswith("verdict  limits exceeded")
    rows = {line.split()[0]: line for line in lines}  # of several processes, what cannot be read comes first
    for name in FOILS[:2]:
        line = rows[name]
        assert "FAIL     wall_growth " in line
        assert ">= 1.25" in line
        assert re.search(r"far_field 15(\.0\d)? < 100", line)  # a warning; chords between nodes
        assert Path(name.replace(":", "") + ".h5").exists()  # it is written all the same
    assert rows["missing.dat"].split()[-1] == "error"
    assert counts == "verdicts: 2 FAIL, 1 error"
    assert done.err.count("gate not met: naca:0012: profile viscous: wall_growth is") == 1
    assert "2 done (2 of them beyond a gate), 1 failed" in done.err


@pytest.mark.parametrize("words", [("infer", "-o", "{stem}.h5"), ("quality",), ("quality", "--summary")])
def test_a_batch_without_any_grid_has_its_table_too(meshonet: Meshonet, words: tuple[str, ...]) -> None:
    done = meshonet(*words, "missing.dat", "absent.dat", "--fail-on", "folded>0")
    assert done.code == 2
    head, *rows, counts = done.out.splitlines()
    assert head.split() == ["grid", "verdict", "limits", "exceeded"]
    assert [row.split() for row in rows] == [["missing.dat", "error"], ["absent.dat", "error"]]
    assert counts == "verdicts: 2 error"


def test_grids_on_standard_output_leave_the_table_on_standard_error(process: Process) -> None:
    done = process("infer", *FOILS[:2], *VISCOUS[:4], "-o", "-")
    assert done.returncode == 1
    assert b"verdicts: 2 FAIL" in done.stderr


def test_json_has_what_is_not_met_and_no_table(meshonet: Meshonet) -> None:
    reports = meshonet("infer", *FOILS[:2], *VISCOUS, "--json").objects
    assert [len(grid["gates_not_met"]) for grid in reports] == [1, 1]
    assert reports[0]["gates_not_met"][0].startswith("profile viscous: wall_growth is ")


def test_what_is_not_judged_has_no_table(meshonet: Meshonet) -> None:
    assert meshonet("infer", *FOILS, "--res", "41x15", "-o", "{stem}.h5").out == ""
    assert meshonet("infer", *FOILS, *VISCOUS, "-q").out == ""


def test_a_profile_says_the_same_when_the_grid_is_made_and_afterwards(meshonet: Meshonet) -> None:
    for profile in PROFILES:
        words = ("--profile", profile, "--json")
        made = meshonet("infer", "naca:4412", "--res", "61x31", "-o", "g.h5", *words)
        read = meshonet("quality", "g.h5", *words)
        assert made.code == read.code
        assert made.only["gates_not_met"] == read.only["gates_not_met"]


def test_gates_name_figures_of_blocks_when_grids_are_made(meshonet: Meshonet) -> None:
    Path("plate.wkt").write_text("POLYGON ((0 0, 3 0, 3 1, 1 1, 1 2, 0 2, 0 0))", encoding="utf-8")
    done = meshonet("infer", "plate.wkt", "--cells", "400", "--fail-on", "growth>=1", "-o", "g.h5")
    assert (done.code, "gate not met: plate.wkt: growth is" in done.err) == (1, True)


def test_a_gate_on_a_figure_that_the_cells_lack_is_an_error(meshonet: Meshonet) -> None:
    done = meshonet("infer", "naca:0012", "--res", "41x15", "--fail-on", "bezier_folded>0", "-o", "g.h5")
    assert done.code == 2
    assert "naca:0012: --fail-on: this grid has no bezier_folded" in done.err.replace("error: ", "")


def test_an_error_that_all_inputs_end_in_is_told_three_times_and_counted(meshonet: Meshonet) -> None:
    foils = [f"naca:24{number:02}" for number in range(10, 20)]
    words = ("infer", *foils, "--topology", "quad", "-o", "{stem}.h5")
    done = meshonet(*words)
    assert done.code == 2
    errors = [line for line in done.err.splitlines() if line.startswith("error: ")]
    assert len(errors) == 4
    assert errors[0].startswith("error: naca:2410: topology quad is not made from an airfoil")
    assert errors[3] == "error: 7 more inputs: topology quad is not made from an airfoil"
    assert "10 failed" in done.err
    assert len(meshonet(*words, "--json").objects) == 10  # a program gets each of them
    missing = meshonet("infer", *(f"{number}.dat" for number in range(5)), "-o", "{stem}.h5")
    assert missing.err.count("no such file") == 5


def test_the_report_of_one_grid_has_the_outcome_of_every_check(meshonet: Meshonet) -> None:
    words = ("naca:0012", "--res", "81", "--first-cell", "1e-4", "--growth", "1.2", "--profile", "viscous")
    done = meshonet("infer", *words, "-o", "one.h5")
    assert done.code == 0
    judge = ("quality", "one.h5", "--profile", "viscous")
    table = meshonet(*judge).out.splitlines()
    start = next(k for k, line in enumerate(table) if line.startswith("profile viscous"))
    assert done.err.splitlines()[start - len(table) :] == [f"  {line}" for line in table[start:]]
    assert table[-2].split()[0::5] == ["far_field", "warn"]  # which is no failure
    report = meshonet("infer", *words, "-o", "one.h5", "--json").only
    assert report["profile"] == meshonet(*judge, "--json").only["profile"]


def test_grids_of_a_dataset_say_their_verdicts(meshonet: Meshonet) -> None:
    words = ("naca:2412", "naca:0012-sharp", "--res", "60x30", "--topology", "o")
    assert meshonet("infer", *words, "--fail-on", "max_angle>150", "-o", "all.h5").code == 1
    blunt, sharp = read_grids("all.h5")
    assert blunt.provenance["verdict"] == "pass"
    assert sharp.provenance["verdict"] == "fail"
    assert sharp.provenance["limits_exceeded"].startswith("max_angle.max 17")
    assert meshonet("infer", *words, "-o", "none.h5").code == 0
    assert all("verdict" not in grid.provenance for grid in read_grids("none.h5"))


@pytest.mark.parametrize(
    "words", [("-o", "all.h5"), ("-o", "all.h5", "--part-size", "1"), ("-o", "{index}.h5")]
)
@pytest.mark.parametrize("jobs", [(), ("--jobs", "2")])
def test_grids_that_fail_are_left_out_if_asked_for_and_named(
    meshonet: Meshonet, words: tuple[str, ...], jobs: tuple[str, ...]
) -> None:
    gate = ("--res", "41x15", "--fail-on", "max_angle>150", "--leave-out-failed")
    foils = ("naca:0012-sharp", "naca:2412", "naca:0012")
    done = meshonet("infer", *foils, *gate, *words, *jobs)
    assert done.code == 1
    assert "naca:0012-sharp: left out, as it fails\ngate not met: naca:0012-sharp: max_angle" in done.err
    assert "\n2 done, 1 left out in " in done.err
    assert "verdicts: 2 pass, 1 FAIL" in done.out
    written = ["all.h5"] if "all.h5" in words else ["1.h5", "2.h5"]
    assert sorted(path.name for path in Path().glob("*.h5")) == written
    assert [grid.name for path in written for grid in read_grids(path)] == ["NACA 2412", "NACA 0012"]
    objects = meshonet("infer", *foils, *gate, "-o", "{index}.vts", "--json").objects
    assert [one["output"] for one in objects] == [None, "1.vts", "2.vts"]


def test_nothing_is_left_out_where_there_is_no_gate(meshonet: Meshonet) -> None:
    done = meshonet("tfi", "naca:0012", "--leave-out-failed", "-o", "g.h5")
    assert done.code == 2
    assert done.err.startswith("error: --leave-out-failed: there is nothing that a grid could fail; give ")


@pytest.mark.parametrize("parts", [(), ("--part-size", "1")])
def test_a_dataset_lists_what_is_left_out_and_what_failed(meshonet: Meshonet, parts: tuple[str, ...]) -> None:
    gate = ("--res", "41x15", "--fail-on", "max_angle>150", "--leave-out-failed")
    meshonet("infer", "naca:0012-sharp", "naca:2412", "missing.dat", *gate, "-o", "all.h5", *parts)
    with h5py.File("all.h5") as file:
        rows = [json.loads(text) for text in file["failed"].asstr()]
    assert sorted(row[0] for row in rows) == ["missing.dat", "naca:0012-sharp"]
    reasons = {row[0]: row[2] for row in rows}
    assert reasons["naca:0012-sharp"].startswith("left out, as it fails: max_angle.max 1")
    assert "no such file" in reasons["missing.dat"]
    again = ("infer", "naca:0012-sharp", "naca:2412", "missing.dat", *gate, "-o", "all.h5", *parts)
    assert not parts or "there already" in meshonet(*again, "--skip-existing").err


@pytest.mark.parametrize("parts", [(), ("--part-size", "1")])
def test_attributes_of_a_dataset_hold_for_all_its_grids(meshonet: Meshonet, parts: tuple[str, ...]) -> None:
    foils = ("naca:2412", "naca:0012-sharp", "naca:0010", "naca:2410")
    words = ("--res", "60x30", "--topology", "c", "--fail-on", "max_angle>140")
    meshonet("infer", *foils, *words, "-o", "all.h5", *parts)
    grids = list(read_grids("all.h5"))
    assert len({grid.provenance["method"] for grid in grids}) == 1
    assert len({grid.provenance.get("changes") for grid in grids}) > 1
    with h5py.File("all.h5") as file:
        assert file.attrs["method"] == grids[0].provenance["method"]
        assert "command" in file.attrs
        for name, fact in file.attrs.items():
            if name not in ("format", "version", "topology", "inputs"):
                assert {grid.provenance.get(name) for grid in grids} == {fact}


@pytest.mark.parametrize(
    "words",
    [
        ("deform", "--rotate", "wall=5@0.25,0"),
        ("convert", "--coarsen", "2"),
        ("convert", "--normalise"),
        ("convert", "--extrude", "1"),
        ("convert", "--revolve", "90", "--axis", "0,-40,1,0"),
    ],
    ids=lambda words: " ".join(words[:2]),
)
@pytest.mark.parametrize("ending", [".h5", ".cgns", ".vts"])
def test_a_verdict_is_that_of_the_grid_and_not_of_the_one_it_is_made_from(
    meshonet: Meshonet, words: tuple[str, ...], ending: str
) -> None:
    made = ("infer", "naca:0012-sharp", "--res", "61x33", "--topology", "c", "--fail-on", "max_angle>170")
    assert meshonet(*made, "-o", f"a{ending}").code == 0
    assert meshonet("convert", f"a{ending}", "same.h5").code == 0
    command, *options = words
    assert meshonet(command, f"a{ending}", *options, "-o", "b.h5").code == 0
    for path, judged in (("same.h5", True), ("b.h5", False)):
        facts = next(read_grids(path)).provenance
        assert ("verdict" in facts, "limits_exceeded" in facts) == (judged, judged)


def test_the_remedy_for_bases_of_a_dataset_is_named_and_works(meshonet: Meshonet) -> None:
    """A base makes a grid of two blocks, with nodes as many as it needs; a sharp edge one of one block."""
    words = ("--topology", "c", "--res", "201x41", "--first-cell", "1e-4", "-o", "all.h5")
    sharp, thin, thick = foils = ("naca:0012-sharp", "naca:0008", "naca:0030")
    for pair in ((thin, thick), (thin, sharp), (sharp, thin)):
        err = meshonet("infer", *pair, *words).err
        assert "close bases of airfoils with --te wedge, or give all of them one with --base T, --b" in err
        assert "--topology" not in err
    assert len(list(read_grids("all.h5"))) == 1
    for more in (("--te", "wedge"), ("--base", "0.01", "--base-nodes", "41", "--wake-nodes", "61")):
        assert meshonet("infer", *foils, *words, *more).code == 0
        assert len(list(read_grids("all.h5"))) == len(foils)
