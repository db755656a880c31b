"""`meshonet tfi`, and through it what every command that makes grids has in common."""

import gc
import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from command_line import Meshonet, dataset, duct, ellipse

from meshonet.formats.registry import read_grids


def grid_of(path: str | Path) -> np.ndarray:
    (grid,) = read_grids(str(path))
    return grid.nodes


def test_a_boundary_becomes_a_grid_with_its_nodes(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("tfi", duct_h5, "-o", "grid.vts")
    assert (done.code, done.out) == (0, "")
    nodes = grid_of("grid.vts")
    assert nodes.shape == (21, 11, 2)
    np.testing.assert_array_equal(nodes[:, 0], duct()["south"])
    np.testing.assert_array_equal(nodes[-1], duct()["east"])


def test_the_report_says_what_happened(meshonet: Meshonet, duct_h5: Path) -> None:
    report = meshonet("tfi", duct_h5, "-o", "grid.vts").err
    assert "grid.vts: 21 x 11 nodes, quad grid" in report
    assert "folded     0 of 200 cells" in report
    assert "max angle" in report
    assert "read" in report
    assert "write" in report


def test_quiet_says_nothing(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("tfi", duct_h5, "-o", "grid.vts", "--quiet")
    assert (done.code, done.out, done.err) == (0, "", "")


def test_json_has_the_promised_fields(meshonet: Meshonet, body_h5: Path) -> None:
    report = meshonet("tfi", body_h5, "-o", "grid.vts", "--json").only
    assert report["input"] == str(body_h5)
    assert report["output"] == "grid.vts"
    assert (report["ni"], report["nj"], report["topology"], report["method"]) == (41, 15, "o", "tfi")
    assert (report["folded"], report["path"], report["residual"], report["cycles"], report["model"]) == (
        0,
        [],
        None,
        None,
        None,
    )
    assert set(report["seconds"]) >= {"read", "boundary", "grid", "guard", "write", "total"}
    stages = [spent for stage, spent in report["seconds"].items() if stage != "total"]
    assert report["seconds"]["total"] == pytest.approx(sum(stages), abs=1e-5)
    assert report["quality"]["max_angle"]["max"] >= report["quality"]["max_angle"]["mean"] >= 90


@pytest.mark.parametrize(("res", "shape"), [("30", (30, 30)), ("30x12", (30, 12)), ("30X12", (30, 12))])
def test_res_counts_nodes(meshonet: Meshonet, duct_h5: Path, res: str, shape: tuple[int, int]) -> None:
    assert meshonet("tfi", duct_h5, "--res", res, "-o", "grid.vts").code == 0
    assert grid_of("grid.vts").shape[:2] == shape


def test_blending_chooses_the_parameter(meshonet: Meshonet, tmp_path: Path) -> None:
    edges = duct()
    clustered = np.linspace(0, 1, 11) ** 2
    edges["west"][:, 1] = clustered
    source = dataset(tmp_path / "clustered.h5", "quad", edges)
    meshonet("tfi", source, "--blending", "linear", "-o", "linear.vts")
    meshonet("tfi", source, "--blending", "arclength", "-o", "arc.vts")
    assert not np.allclose(grid_of("linear.vts"), grid_of("arc.vts"), atol=1e-3)


def test_a_folded_grid_is_refused(meshonet: Meshonet, folding_h5: Path) -> None:
    done = meshonet("tfi", folding_h5, "-o", "grid.vts")
    assert done.code == 3
    assert not Path("grid.vts").exists()
    assert "wave.h5" in done.err
    assert "cells are folded" in done.err
    assert "--allow-invalid" in done.err
    assert "worst cells: (i=" in done.err
    assert len(done.err.splitlines()) <= 2


def test_a_folded_grid_that_is_allowed_is_said_to_be_folded(meshonet: Meshonet, folding_h5: Path) -> None:
    done = meshonet("tfi", folding_h5, "-o", "grid.vts", "--allow-invalid", "--quiet")
    assert done.code == 0
    assert Path("grid.vts").exists()
    assert "warning" in done.err
    assert "folded cells" in done.err


def test_repair_unfolds_and_says_so(meshonet: Meshonet, folding_h5: Path) -> None:
    report = meshonet("tfi", folding_h5, "-o", "grid.vts", "--repair", "--json").only
    assert (report["method"], report["folded"], report["path"]) == ("tfi", 0, ["repair"])
    done = meshonet("tfi", folding_h5, "-o", "grid.vts", "--repair")
    assert "method     tfi, then repair" in done.err


def test_a_gate_ends_with_one_and_leaves_the_grid(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet(
        "tfi", duct_h5, "-o", "grid.vts", "-q", "--fail-on", "max_angle>91", "--fail-on", "folded>0"
    )
    assert done.code == 1
    assert "gate not met" in done.err
    assert "max_angle.max is" in done.err
    assert done.err.count("gate not met") == 1
    assert Path("grid.vts").exists()
    assert meshonet("tfi", duct_h5, "-o", "grid.vts", "--fail-on", "max_angle>179").code == 0


def test_a_gate_on_a_percentile_is_computed(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("tfi", duct_h5, "-o", "grid.vts", "--json", "--fail-on", "skewness.p99<9")
    assert done.code == 1
    assert "p99" in done.only["quality"]["skewness"]


def test_a_dataset_becomes_a_dataset(meshonet: Meshonet, three_h5: Path) -> None:
    assert meshonet("tfi", three_h5, "-o", "grids.h5").code == 0
    with h5py.File("grids.h5") as file:
        assert file.attrs["format"] == "meshonet-grid"
        assert file["nodes"].shape == (3, 21, 11, 2)
        assert [name.decode() for name in file["names"][:]] == ["flat", "low", "high"]
        np.testing.assert_array_equal(file["nodes"][2, :, 0], duct(bump=0.3)["south"])


def test_a_dataset_becomes_one_file_each(meshonet: Meshonet, three_h5: Path) -> None:
    done = meshonet("tfi", three_h5, "-o", "out/{stem}-{index:02d}-{name}.vts")
    assert done.code == 0
    made = sorted(path.name for path in Path("out").iterdir())
    assert made == ["three-00-flat.vts", "three-01-low.vts", "three-02-high.vts"]
    assert "3 done" in done.err
    np.testing.assert_array_equal(grid_of("out/three-01-low.vts")[:, 0], duct(bump=0.1)["south"])


def test_json_of_a_batch_is_one_object_a_line(meshonet: Meshonet, three_h5: Path) -> None:
    report = meshonet("tfi", three_h5, "-o", "{name}.vts", "--json").objects
    assert [item["output"] for item in report] == ["flat.vts", "low.vts", "high.vts"]
    assert [item["name"] for item in report] == ["flat", "low", "high"]


def test_a_batch_goes_on_past_failures_and_ends_with_the_worst(
    meshonet: Meshonet, duct_h5: Path, folding_h5: Path
) -> None:
    Path("text.h5").write_text("no HDF5")
    done = meshonet("tfi", "missing.h5", folding_h5, "text.h5", duct_h5, "-o", "{stem}.vts")
    assert done.code == 3
    assert [path.name for path in Path().glob("*.vts")] == ["duct.vts"]
    errors = [line for line in done.err.splitlines() if line.startswith("error: ")]
    assert [line.split(": ")[1].split("/")[-1] for line in errors] == ["missing.h5", "wave.h5", "text.h5"]
    assert "1 done, 3 failed" in done.err
    assert meshonet("tfi", "missing.h5", duct_h5, "-o", "{stem}.vts").code == 2


def test_a_failing_member_of_a_batch_is_in_its_json(meshonet: Meshonet, duct_h5: Path) -> None:
    report = meshonet("tfi", "missing.h5", duct_h5, "-o", "{stem}.vts", "--json").objects
    assert (report[0]["input"], report[0]["output"], report[0]["exit_code"]) == ("missing.h5", None, 2)
    assert "no such file" in report[0]["error"]
    assert report[1]["output"] == "duct.vts"


def test_members_of_other_sizes_do_not_fit_a_dataset(
    meshonet: Meshonet, tmp_path: Path, duct_h5: Path
) -> None:
    other = dataset(tmp_path / "other.h5", "quad", duct(ni=31))
    done = meshonet("tfi", duct_h5, other, "-o", "all.h5")
    assert done.code == 2
    assert "31x11 quad does not fit a dataset of 21x11 quad; set --res" in done.err
    assert grid_of("all.h5").shape == (21, 11, 2)
    assert meshonet("tfi", duct_h5, other, "--res", "20", "-o", "all.h5").code == 0


def test_when_every_member_fails_there_is_no_file(meshonet: Meshonet, folding_h5: Path) -> None:
    assert meshonet("tfi", folding_h5, folding_h5, "-o", "all.h5").code == 3
    assert not Path("all.h5").exists()


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("three.h5", "-o", "one.vts"), "and a vts file holds one; name the output 'one-{index}.vts'"),
        (("three.h5", "duct.h5", "-o", "one.vts"), "several inputs and one vts file, which holds one; name"),
        (("three.h5", "duct.h5", "-o", "one.vts"), "one .h5; the walls of one channel belong in one file"),
        (("three.h5", "-o", "{stem}.vts"), "would overwrite three.vts of three.h5[flat]; put {index} into"),
        (("duct.h5", "-o", "{shape}.vts"), "has a field that is not known; use {stem}, {index} or {name}"),
        (("duct.h5", "-o", "{stem.vts"), "has a field that is not known"),
        (("duct.h5", "-o", "grid.abc"), "grid.abc: its ending '.abc' is not known"),
        (("duct.h5", "-o", "nowhere/grid.vts"), "its folder does not exist"),
        (("duct.h5", "-o", "."), "known"),
        (("duct.h5", "-o", "g.vts", "--res", "80y40"), "--res: '80y40' is not a number of nodes; use N"),
        (("duct.h5", "-o", "g.vts", "--res", "1"), "use 2 to 100000"),
        (("duct.h5", "-o", "g.vts", "--corners", "1,2,3"), "--corners: '1,2,3' is not four points"),
        (("duct.h5", "-o", "g.vts", "--fail-on", "beauty>1"), "--fail-on: metric 'beauty' is not known; use"),
        (("duct.h5", "-o", "g.vts", "--fail-on", "max_angle"), "--fail-on: 'max_angle' is not a gate; write"),
        (("duct.h5", "-o", "g.vts", "--fail-on", "max_angle>x"), "is not a gate"),
        (("duct.h5", "-o", "g.vts", "--fail-on", "max_angle.med>1"), "statistic 'med' is not known; use"),
        (("duct.h5", "-o", "g.vts", "--fail-on", "folded.max>1"), "use no statistic with folded"),
        (("duct.h5", "-o", "g.vts", "--to", "word"), "format 'word' is not known; use one of"),
        (("duct.h5", "-o", "-", "--json"), "--json and -o - both want standard output"),
        (("-", "-", "-o", "g.h5"), "standard input is named twice"),
        (("duct.h5",), "missing option '-o' / '--output'; see meshonet tfi --help"),
        (("duct.h5", "-o", "g.vts", "--colour"), "no such option"),
        (("-o", "g.vts"), "missing argument 'BOUNDARY'"),
        (("duct.h5", "-o", "g.vts", "--blending", "cubic"), "cubic"),
        (("duct.h5", "-o", "g.vts", "--far-field", "x"), "far-field"),
    ],
)  # fmt: skip
def test_mistakes_get_a_line(
    meshonet: Meshonet, duct_h5: Path, three_h5: Path, words: tuple[str, ...], message: str
) -> None:
    done = meshonet("tfi", *words)
    assert done.code == 2
    assert message in done.err
    errors = [line for line in done.err.splitlines() if line.startswith("error: ")]
    assert errors
    assert len(errors[0]) < 400
    assert "Traceback" not in done.err
    assert not list(Path().glob("*.meshonet-part"))


def test_debug_shows_the_traceback(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("tfi", duct_h5, "-o", "nowhere/grid.vts", "--debug")
    assert done.code == 2
    assert "Traceback" in done.err
    assert done.err.splitlines()[-1].startswith("error: nowhere/grid.vts")


def test_skip_existing_passes_over_what_is_there(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "{name}.vts")
    Path("low.vts").unlink()
    Path("flat.vts").write_text("mine")
    done = meshonet("tfi", three_h5, "-o", "{name}.vts", "--skip-existing")
    assert done.code == 0
    assert "1 done, 2 there already" in done.err
    assert Path("flat.vts").read_text() == "mine"
    assert Path("low.vts").exists()


def test_an_existing_file_stays_when_the_run_fails(meshonet: Meshonet, folding_h5: Path) -> None:
    Path("grid.vts").write_text("mine")
    assert meshonet("tfi", folding_h5, "-o", "grid.vts").code == 3
    assert Path("grid.vts").read_text() == "mine"


def test_the_same_input_gives_the_same_bytes(meshonet: Meshonet, body_h5: Path) -> None:
    for name in ("one.vts", "other.vts"):
        meshonet("tfi", body_h5, "-o", name, "--res", "30")
    assert Path("one.vts").read_bytes() == Path("other.vts").read_bytes()


def test_the_grid_says_how_it_was_made(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("tfi", "duct.h5", "-o", "grid.h5", "--res", "30")
    (grid,) = read_grids("grid.h5")
    assert grid.provenance["command"] == "meshonet tfi duct.h5 --res 30"
    assert grid.provenance["software"].startswith("meshonet ")
    assert grid.provenance["method"] == "tfi"


def test_from_and_to_override_the_endings(meshonet: Meshonet, duct_h5: Path) -> None:
    duct_h5.rename("duct.bin")
    assert meshonet("tfi", "duct.bin", "--from", "hdf5", "-o", "grid.out", "--to", "vts").code == 0
    assert Path("grid.out").read_bytes().startswith(b"<?xml")


def test_a_grid_file_is_a_boundary_too(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("tfi", duct_h5, "-o", "first.vts")
    assert meshonet("tfi", "first.vts", "-o", "second.vts").code == 0
    np.testing.assert_allclose(grid_of("second.vts"), grid_of("first.vts"), atol=1e-12)


def test_progress_is_not_shown_in_a_pipe(meshonet: Meshonet, three_h5: Path) -> None:
    assert "\r" not in meshonet("tfi", three_h5, "-o", "{name}.vts").err


def test_json_stays_valid_when_names_are_odd(meshonet: Meshonet, tmp_path: Path) -> None:
    source = dataset(tmp_path / "odd.h5", "o", ellipse(), names=('a "b"\n/..\x1b[31m',))
    done = meshonet("tfi", source, "-o", "out/{name}.vts", "--json")
    assert done.code == 0
    (made,) = Path("out").iterdir()
    assert made.parent == Path("out")
    assert "\x1b" not in made.name
    assert json.loads(done.out)["output"] == str(made)


def test_first_cells_are_as_high_as_asked(meshonet: Meshonet, duct_h5: Path) -> None:
    heights = ("--spacing-south", "1e-3", "--spacing-north", "2e-3", "--spacing-west", "4e-3")
    words = ("--spacing-east", "5e-3", "--constant-layers", "2", "--res", "41x41", "-o", "g.h5")
    report = meshonet("tfi", duct_h5, *heights, *words, "--json").only
    assert (report["method"], report["folded"]) == ("tfi", 0)
    (grid,) = read_grids("g.h5")
    first = np.linalg.norm(np.diff(grid.nodes, axis=1), axis=-1)
    np.testing.assert_allclose(first[:, 0], 1e-3, rtol=1e-8)
    np.testing.assert_allclose(first[:, -1], 2e-3, rtol=1e-8)


LAYERS = [("--wall-spacing", "1e-3"), ("--y-plus", "50", "--reynolds", "1e5", "--chord-fraction", "0.4")]


@pytest.mark.parametrize("words", LAYERS)
def test_walls_of_channels_and_bodies_have_layers(
    meshonet: Meshonet, duct_h5: Path, body_h5: Path, words: tuple[str, ...]
) -> None:
    more = ("--growth", "1.3", "-o", "g.h5")
    for source in (duct_h5, body_h5):
        assert meshonet("tfi", source, *words, *more).code == 0
        (grid,) = read_grids("g.h5")
        steps = np.linalg.norm(np.diff(grid.nodes, axis=1), axis=-1)
        np.testing.assert_allclose(steps[:, 0], steps[0, 0], rtol=1e-8)
        assert steps[:, 1:].max() / steps[:, 0].max() > 1
        assert (steps[:, 1:] / steps[:, :-1]).max() < 1.3001


def test_cycles_are_searched_more_often_among_several_members(
    meshonet: Meshonet, duct_h5: Path, three_h5: Path
) -> None:
    """A single grid is done before cycles fill the memory, many grids and figures in cycles are not."""
    usual = gc.get_threshold()
    try:
        gc.set_threshold(100_000)
        meshonet("tfi", duct_h5, "-o", "grid.vts")
        assert gc.get_threshold()[0] == 100_000
        meshonet("tfi", three_h5, "-o", "grids.h5")
        assert gc.get_threshold()[0] < 1000
    finally:
        gc.set_threshold(*usual)
