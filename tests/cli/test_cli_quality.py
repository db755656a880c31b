"""`meshonet quality`."""

from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, dataset, duct

from meshonet.formats.registry import read_grids
from meshonet.geometry.quality.measure import per_cell
from meshonet.geometry.quality.metrics import METRICS, QUAD_METRICS
from meshonet.geometry.quality.report import COMPARED

NAMES = [metric.name for metric in (*QUAD_METRICS, *METRICS)]


@pytest.fixture
def grid_vts(meshonet: Meshonet, duct_h5: Path) -> Path:
    """A valid grid, 21 x 11."""
    meshonet("tfi", duct_h5, "-o", "grid.vts")
    return Path("grid.vts")


@pytest.fixture
def folded_vts(meshonet: Meshonet, folding_h5: Path) -> Path:
    """A folded grid."""
    meshonet("tfi", folding_h5, "-o", "folded.vts", "--allow-invalid")
    return Path("folded.vts")


def test_the_table_is_the_result(meshonet: Meshonet, grid_vts: Path) -> None:
    done = meshonet("quality", grid_vts)
    assert (done.code, done.err) == (0, "")
    assert "grid.vts: 21 x 11 nodes, quad grid, 200 cells, none folded" in done.out
    lines = done.out.splitlines()
    table, walls, growth = lines[1:-8], lines[-8:-3], lines[-3:]
    assert {line.split()[0] for line in table[1:]} == set(NAMES)
    assert [line[:9] for line in growth] == ["growth   ", "along xi ", "along eta"]
    assert [line.split(":")[0] for line in walls[1:]] == ["south", "south", "north", "north"]
    assert [len({len(line) for line in rows}) for rows in (table, growth)] == [1, 1]  # columns are aligned


def test_quiet_leaves_gates_that_are_not_met(meshonet: Meshonet, grid_vts: Path) -> None:
    done = meshonet("quality", grid_vts, "--quiet", "--fail-on", "max_angle>91")
    assert (done.code, done.out) == (1, "")
    assert done.err.startswith("gate not met: grid.vts: max_angle.max is")
    summary = meshonet("quality", grid_vts, grid_vts, "--quiet", "--summary")
    assert summary.err == ""
    assert summary.out.splitlines()[-1].startswith("worst of 2")
    assert meshonet("quality", grid_vts, "--quiet", "--json").only["folded"] == 0


def test_plain_quality_has_the_growth_that_gates_judge(meshonet: Meshonet, grid_vts: Path) -> None:
    report = meshonet("quality", grid_vts, "--json").only
    greatest = max(extreme["max"] for extreme in report["growth"].values() if extreme)
    assert meshonet("quality", grid_vts, "--fail-on", f"growth>{greatest * (1 + 1e-9)!r}").code == 0
    assert meshonet("quality", grid_vts, "--fail-on", f"growth>{greatest * (1 - 1e-9)!r}").code == 1


def test_verdicts_are_the_same_words_in_table_and_json(meshonet: Meshonet) -> None:
    meshonet("infer", "naca:0012", "--res", "81", "--first-cell", "1e-4", "-o", "g.h5", "-q")
    checks = meshonet("quality", "g.h5", "--profile", "viscous", "--json").only["profile"]["checks"]
    table = meshonet("quality", "g.h5", "--profile", "viscous").out.splitlines()[-len(checks) :]
    assert {check["verdict"] for check in checks} >= {"pass", "warn"}
    assert [line.split()[-1].lower() for line in table] == [check["verdict"] for check in checks]


def test_json_has_every_figure(meshonet: Meshonet, grid_vts: Path) -> None:
    report = meshonet("quality", grid_vts, "--json").only
    (grid,) = read_grids("grid.vts")
    assert (report["ni"], report["nj"], report["topology"], report["folded"], report["worst_cells"]) == (
        21,
        11,
        "quad",
        0,
        [],
    )
    for name in NAMES:
        values = per_cell(grid, name)
        figures = report["quality"][name]
        assert figures["max"] == values.max()
        assert figures["p99"] == pytest.approx(np.percentile(values, 99), rel=1e-12)
        i, j = figures["worst"]
        assert values[i, j] in (values.min(), values.max())
        corners = grid.nodes[i : i + 2, j : j + 2]
        assert figures["worst_centre"] == pytest.approx(corners.mean(axis=(0, 1)), abs=1e-15)


def test_folded_cells_are_named(meshonet: Meshonet, folded_vts: Path) -> None:
    done = meshonet("quality", folded_vts)
    assert done.code == 0
    assert "folded at i=" in done.out
    report = meshonet("quality", folded_vts, "--json").only
    assert report["folded"] > 10
    assert len(report["worst_cells"]) == 10
    assert set(report["worst_cells"][0]) == {"i", "j", "x", "y"}


@pytest.mark.parametrize(
    ("gate", "code"),
    [
        ("folded>0", 1),
        ("folded>100000", 0),
        ("max_angle>179", 1),
        ("scaled_jacobian<0", 1),
        ("min_angle<-1", 0),
    ],
)
def test_gates_decide_the_exit_code(meshonet: Meshonet, folded_vts: Path, gate: str, code: int) -> None:
    done = meshonet("quality", folded_vts, "--fail-on", gate)
    assert done.code == code
    assert ("gate not met: folded.vts: " in done.err) == bool(code)


def test_several_gates_are_all_told(meshonet: Meshonet, folded_vts: Path) -> None:
    done = meshonet("quality", folded_vts, "--fail-on", "folded>=1", "--fail-on", "max_angle.mean<=200")
    assert done.code == 1
    assert done.err.count("gate not met") == 2


def test_json_names_the_gates_and_checks_that_are_not_met(
    meshonet: Meshonet, grid_vts: Path, folded_vts: Path
) -> None:
    words = ("quality", grid_vts, folded_vts, "--fail-on", "folded>0", "--profile", "verdict")
    good, bad = meshonet(*words, "--json").objects
    assert good["gates_not_met"] == []
    assert bad["gates_not_met"][0].endswith("which fails --fail-on 'folded>0'")
    assert "profile verdict: folded is" in bad["gates_not_met"][1]


def test_a_judged_batch_ends_in_a_table_of_verdicts_and_limits(
    meshonet: Meshonet, grid_vts: Path, folded_vts: Path
) -> None:
    words = ("quality", grid_vts, folded_vts, "missing.vts", "--fail-on", "folded>0", "--profile", "verdict")
    for more in ((), ("--summary",)):
        done = meshonet(*words, *more)
        assert done.code == 2
        head, good, bad, none, *_, counts = done.out.splitlines()[-9:]
        assert head.endswith("verdict  limits exceeded")
        assert good.split()[-1] == "pass"
        assert "FAIL     folded " in bad
        assert bad.count(" > 0") == 1  # which is a gate, and a check of the profile
        assert "scaled_jacobian" in bad
        assert none.split() == ["missing.vts", "-", "-", "-", "error"]
        assert counts == "verdicts: 1 pass, 1 FAIL, 1 error"
    report = meshonet(*words, "--summary", "--json").objects[-1]["summary"]
    assert report["members"] == 2
    assert [row["verdict"] for row in report["verdicts"]] == ["pass", "fail", "error"]
    assert [text.split()[0] for text in report["verdicts"][1]["beyond"]] == [
        "folded", "scaled_jacobian", "max_angle", "min_angle",
    ]  # fmt: skip
    without = meshonet("quality", grid_vts, folded_vts, "--summary").out
    assert "verdict" not in without


def test_a_warning_of_a_profile_passes_and_is_in_the_table(meshonet: Meshonet) -> None:
    words = ("--res", "81", "--first-cell", "1e-4", "--growth", "1.2", "-o", "g.h5", "-q")
    meshonet("infer", "naca:0012", *words)
    done = meshonet("quality", "g.h5", "g.h5", "--summary", "--profile", "viscous")
    assert (done.code, "warn     equal_wall_cells 1 < 2, far_field 15" in done.out, " < 100" in done.out) == (
        0,
        True,
        True,
    )
    assert done.out.splitlines()[-1] == "verdicts: 2 warn"


def test_a_mesh_that_is_read_as_a_boundary_is_no_grid(meshonet: Meshonet, grid_vts: Path) -> None:
    assert meshonet("convert", grid_vts, "g.msh").code == 0
    done = meshonet("quality", "g.msh")
    assert "gmsh files are read as boundaries, without the grid; write the grid as .cgns or .vtm" in done.err
    assert "meshonet infer" not in done.err  # another grid, which would be measured instead


def test_every_grid_is_measured_and_the_worst_decides(
    meshonet: Meshonet, grid_vts: Path, folded_vts: Path
) -> None:
    done = meshonet("quality", grid_vts, "missing.vts", folded_vts, "--fail-on", "folded>0", "--json")
    assert done.code == 2
    assert [item["input"] for item in done.objects] == ["grid.vts", "missing.vts", "folded.vts"]


def test_a_boundary_is_no_grid(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("quality", duct_h5)
    assert done.code == 2
    assert "holds boundaries, not grids; make grids of them first" in done.err


def test_an_airfoil_is_no_grid(meshonet: Meshonet) -> None:
    message = (
        "naca:0012: is a shape, not a grid; make a grid of it first: meshonet infer naca:0012 -o grid.vts"
    )
    for words in (
        ("quality", "naca:0012"),
        ("convert", "naca:0012", "g.vts"),
        ("plot", "naca:0012", "-o", "g.png"),
    ):
        done = meshonet(*words)
        assert (done.code, done.err) == (2, f"error: {message}\n")


def test_per_cell_metrics_are_cell_data(meshonet: Meshonet, folded_vts: Path) -> None:
    vtk = pytest.importorskip("vtk")
    from vtk.util.numpy_support import vtk_to_numpy

    assert meshonet("quality", folded_vts, "--per-cell", "cells.vts").code == 0
    reader = vtk.vtkXMLStructuredGridReader()
    reader.SetFileName("cells.vts")
    reader.Update()
    data = reader.GetOutput().GetCellData()
    (grid,) = read_grids("folded.vts")
    for name in NAMES:
        values = vtk_to_numpy(data.GetArray(name)).reshape(grid.nj - 1, grid.ni - 1).T
        np.testing.assert_array_equal(values, per_cell(grid, name))
    report = meshonet("quality", folded_vts, "--json").only
    assert vtk_to_numpy(data.GetArray("folded")).sum() == report["folded"]


def test_the_plot_is_a_picture(meshonet: Meshonet, grid_vts: Path) -> None:
    assert meshonet("quality", grid_vts, "--plot", "grid.png").code == 0
    assert Path("grid.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--per-cell", "cells.h5"), "only .vts and .vtm files hold metrics; name it FILE.vts"),
        (("--plot", "grid.vts"), "vts is no picture; use .png, .svg, .pdf or .html"),
        (("--compare", "missing.vts"), "missing.vts: no such file"),
        (("--plot", "grid.gif"), "grid.gif: is no picture; use .png, .svg, .pdf or .html"),
        (("--html", "grid.txt"), "grid.txt: --html: a report is a page; name it FILE.html"),
        (("--fail-on", "y_plus>2"), "--fail-on: y_plus needs --reynolds; use quality --reynolds"),
        (("--fail-on", "near_wall>2"), "--fail-on: near_wall needs --compare; use quality --compare"),
        (("--pair", "name"), "--pair without --compare; give --compare as well, or drop --pair"),
        (("--profile",), "option '--profile' requires an argument; see meshonet quality --help"),
        (("--compare", "grid.vts", "--pair", "luck"), "'luck' is not one of 'auto', 'name', 'order'"),
        (("--profile", "gambit"), "'gambit' is not one of 'openfoam', 'pointwise', 'verdict', 'viscous'"),
        (("--plot", "-", "--json"), "standard output has the table; write to a file"),
    ],
)
def test_mistakes_get_a_line(
    meshonet: Meshonet, grid_vts: Path, words: tuple[str, ...], message: str
) -> None:
    done = meshonet("quality", grid_vts, *words)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1


def test_compare_measures_the_distance(meshonet: Meshonet, grid_vts: Path) -> None:
    (grid,) = read_grids("grid.vts")
    from meshonet.formats.vtk.vts import write
    from meshonet.geometry.blocks.grid import Grid

    moved = grid.nodes.copy()
    moved[3, 4] += [0.03, 0.04]
    write(Path("moved.vts"), Grid.from_nodes(moved))
    report = meshonet("quality", "moved.vts", "--compare", grid_vts, "--json").only["compare"]
    assert report["max"] == pytest.approx(0.05)
    assert report["at"] == [3, 4]
    assert (report["near_wall"], report["boundary"], report["folded_other"]) == (0, 0, 0)
    assert report["max_angle_ratio"] > 1
    assert (
        "distance to the other grid: max 0.05 at i=3, j=4"
        in meshonet("quality", "moved.vts", "--compare", grid_vts).out
    )


def test_compare_pairs_grids_one_by_one(meshonet: Meshonet, three_h5: Path, grid_vts: Path) -> None:
    meshonet("tfi", three_h5, "-o", "three-grids.h5")
    report = meshonet("quality", "three-grids.h5", "--compare", "three-grids.h5", "--json").objects
    assert [item["compare"]["max"] for item in report] == [0, 0, 0]
    one_with_each = meshonet("quality", "three-grids.h5", "--compare", grid_vts, "--json").objects
    assert [item["compare"]["max"] > 0 for item in one_with_each] == [True, True, True]
    too_few = meshonet("quality", "three-grids.h5", grid_vts, "--compare", "three-grids.h5")
    assert too_few.code == 2
    assert "grid.vts: there is no grid to compare it with; compare with one" in too_few.err


def test_pair_says_which_goes_with_which(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "one.h5")
    meshonet("tfi", three_h5, "-o", "{name}.vts")
    turned = ("quality", "high.vts", "flat.vts", "low.vts", "--compare", "one.h5", "--json")
    assert [report["compare"]["max"] for report in meshonet(*turned).objects] == [0, 0, 0]
    assert [report["compare"]["max"] for report in meshonet(*turned, "--pair", "name").objects] == [0, 0, 0]
    by_order = meshonet(*turned, "--pair", "order").objects
    assert all(report["compare"]["max"] > 0.01 for report in by_order)


def test_summary_is_one_table_over_all(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "t.h5")
    meshonet("solve-pde", three_h5, "-o", "s.h5")
    words = ("quality", "t.h5", "--compare", "s.h5")
    each = [report["compare"] for report in meshonet(*words, "--json").objects]
    done = meshonet(*words, "--summary", "--json")
    report = done.only["summary"]
    assert report["members"] == 3
    for figure in ("relative_l2", "near_wall", "max", "max_angle_ratio"):
        values = [member[figure] for member in each]
        assert report[figure]["median"] == pytest.approx(np.median(values), rel=1e-12)
        assert report[figure]["mean"] == pytest.approx(np.mean(values), rel=1e-12)
        assert (report[figure]["min"], report[figure]["max"]) == (min(values), max(values))
    assert report["relative_l2"]["worst"] == "t.h5[high]"
    assert (report["folded"]["sum"], report["folded_other"]["members"]) == (0, 0)
    table = meshonet(*words, "--summary").out.splitlines()
    assert [line.split("  ")[0] for line in table] == [
        "grid", "t.h5[flat]", "t.h5[low]", "t.h5[high]", "median of 3", "mean of 3", "p90 of 3", "worst of 3",
    ]  # fmt: skip
    assert "rel L2" in table[0]
    alone = meshonet("quality", "t.h5", "--summary").out
    assert "max angle" in alone
    assert "rel L2" not in alone


def test_gates_look_at_comparisons(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "t.h5")
    meshonet("solve-pde", three_h5, "-o", "s.h5")
    words = ("quality", "t.h5", "--compare", "s.h5", "--summary", "--fail-on")
    done = meshonet(*words, "relative_l2>0.01")
    assert done.code == 1
    assert "gate not met: t.h5[high]: relative_l2 is 0." in done.err
    assert "t.h5[flat]" not in done.err
    assert meshonet(*words, "boundary>1e-12").code == 0
    without = meshonet("quality", "t.h5", "--fail-on", "relative_l2>0.01")
    assert (without.code, "relative_l2 needs --compare" in without.err) == (2, True)
    report = meshonet(*words[:-2], "--json", "--fail-on", "max>9").objects[0]["compare"]
    assert set(COMPARED) <= set(report)


def test_a_summary_leaves_out_what_failed_and_keeps_gates(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "t.h5")
    done = meshonet("quality", "t.h5", "missing.vts", "--summary", "--fail-on", "max_angle>100")
    assert done.code == 2
    assert "worst of 3" in done.out
    assert "gate not met: t.h5[high]" in done.err
    nothing = meshonet("quality", "missing.vts", "--summary")
    assert (nothing.code, nothing.out) == (2, "")


def test_compare_refuses_other_sizes(meshonet: Meshonet, tmp_path: Path, grid_vts: Path) -> None:
    meshonet("tfi", dataset(tmp_path / "other.h5", "quad", duct(ni=31)), "-o", "other.vts")
    done = meshonet("quality", grid_vts, "--compare", "other.vts")
    assert done.code == 2
    assert "21x11 nodes are not comparable with 31x11" in done.err


def test_a_batch_becomes_one_page(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "grids.h5", "-q")
    done = meshonet("quality", "grids.h5", "--html", "q.html", "--fail-on", "max_angle>20", "--summary")
    assert done.code == 1
    page = Path("q.html").read_text()
    assert page.count("<article") == 3
    assert page.count("not max_angle&gt;20") == 3


@pytest.mark.parametrize(
    ("name", "message"),
    [("q.png", "q.png: --html: a report is a page; name it FILE.html"), ("none/q.html", "none")],
)
def test_a_page_that_cannot_be_written_is_refused(
    meshonet: Meshonet, three_h5: Path, name: str, message: str
) -> None:
    meshonet("tfi", three_h5, "-o", "grids.h5", "-q")
    done = meshonet("quality", "grids.h5", "--html", name)
    assert done.code == 2
    assert message in done.err
    assert not Path(name).exists()


def test_the_shift_of_periodic_sides_has_its_direction(meshonet: Meshonet) -> None:
    meshonet("infer", "naca:0012", "--pitch", "0,0.9", "--cells", "1500", "-o", "passage.cgns")
    assert "periodic sides: shifted by 0.9 along (0, 1, 0), nodes" in meshonet("quality", "passage.cgns").out


def test_many_blocks_have_one_line_with_the_largest_growth(meshonet: Meshonet) -> None:
    Path("step.wkt").write_text("POLYGON ((0 1, 2 1, 2 0, 6 0, 6 2, 0 2, 0 1))")
    assert meshonet("infer", "step.wkt", "--cells", "400", "-o", "g.vtm", "-q").code == 0
    done = meshonet("quality", "g.vtm")
    growth = meshonet("quality", "g.vtm", "--fail-on", "growth>1", "--json").only
    (line,) = [line for line in done.out.splitlines() if line.startswith("largest growth: ")]
    gate = growth["gates_not_met"][0]
    assert gate.split(" is ")[1].split(",")[0][:4] == line.split(": ")[1][:4]
    assert " at block=" in line
