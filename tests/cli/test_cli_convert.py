"""`meshonet convert`."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from command_line import Meshonet, Process

from meshonet.formats.registry import TABLE, format_for_output, read_grids, read_shapes
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid


def write(path: str, grids: Sequence[Grid]) -> None:
    """Write `grids` in the format of the path's ending."""
    writer = format_for_output(path).write_grids
    assert writer is not None
    writer(Path(path), grids)


@pytest.fixture
def grid_vts(meshonet: Meshonet, body_h5: Path) -> Path:
    """An O grid, 41 x 15."""
    meshonet("tfi", body_h5, "-o", "grid.vts")
    return Path("grid.vts")


@pytest.mark.parametrize("name", ["grid.p3d", "grid.h5", "grid.vtk", "grid.bin", "other.vts"])
def test_a_grid_stays_the_same_grid(meshonet: Meshonet, grid_vts: Path, name: str) -> None:
    done = meshonet("convert", grid_vts, name)
    assert (done.code, done.out) == (0, "")
    (before,), (after,) = read_grids("grid.vts"), read_grids(name)
    np.testing.assert_array_equal(after.nodes, before.nodes)
    assert after.topology == "o"


def test_coarsen_keeps_every_kth_node(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("tfi", duct_h5, "-o", "fine.vts")
    report = meshonet("convert", "fine.vts", "coarse.vts", "--coarsen", "2", "--json").only
    assert (report["ni"], report["nj"]) == (11, 6)
    (fine,), (coarse,) = read_grids("fine.vts"), read_grids("coarse.vts")
    np.testing.assert_array_equal(coarse.nodes, fine.nodes[::2, ::2])
    assert [part.name for part in coarse.patches] == [part.name for part in fine.patches]


def test_a_coarse_level_beyond_a_limit_of_checkmesh_has_a_note(meshonet: Meshonet) -> None:
    made = ("--topology", "o", "--first-cell", "2e-6", "--res", "129x97")
    meshonet("infer", "naca:0012", *made, "-o", "fine.cgns")
    done = meshonet("convert", "fine.cgns", "coarse.cgns", "--coarsen", "4")
    assert "beyond the limits of OpenFOAM's checkMesh: non_orthogonality " in done.err
    assert " > 70; growth ratios are those of the fine grid to the power 4" in done.err
    assert "checkMesh" not in meshonet("convert", "fine.cgns", "same.vts").err


@pytest.mark.parametrize("command", ["infer naca:0012-sharp {} -o", "convert a.cgns"])
def test_a_case_of_openfoam_beyond_a_limit_of_checkmesh_has_one_note(
    meshonet: Meshonet, command: str
) -> None:
    made = "--topology o --first-cell 1e-5 --res 129x65"
    meshonet("infer", "naca:0012-sharp", *made.split(), "-o", "a.cgns")
    done = meshonet(*command.format(made).split(), "case/case.foam")
    assert done.code == 0
    assert done.err.count("beyond the limits of OpenFOAM's checkMesh: face_skewness ") == 1


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--coarsen", "3"), "fine.vts: 21x11 nodes are 20x10 cells, which 3 does not divide; use a number "
                             "that divides 10, or make the grid with 19x10 nodes, say"),
        (("--coarsen", "1"), "'--coarsen': 1 is not in the range"),
        (("--coarsen", "x"), "'--coarsen': 'x' is not a valid int"),
    ],
)  # fmt: skip
def test_coarsen_tells_what_would_go(
    meshonet: Meshonet, duct_h5: Path, words: tuple[str, str], message: str
) -> None:
    meshonet("tfi", duct_h5, "-o", "fine.vts")
    done = meshonet("convert", "fine.vts", "coarse.vts", *words)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1
    assert not Path("coarse.vts").exists()


def test_coarsen_needs_grids(meshonet: Meshonet, duct_h5: Path) -> None:
    done = meshonet("convert", duct_h5, "coarse.h5", "--coarsen", "2")
    assert done.code == 2
    assert "holds boundaries, not grids" in done.err


def test_the_output_may_be_an_option(meshonet: Meshonet, grid_vts: Path) -> None:
    assert meshonet("convert", grid_vts, "-o", "grid.h5").code == 0
    assert Path("grid.h5").exists()


def test_json_says_what_was_converted(meshonet: Meshonet, grid_vts: Path) -> None:
    report = meshonet("convert", grid_vts, "grid.h5", "--json").only
    assert (report["input"], report["output"], report["ni"], report["nj"]) == ("grid.vts", "grid.h5", 41, 15)
    assert report["parts"] == ["wall", "farfield"]


def test_a_batch_becomes_one_file_each_or_one_for_all(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "{name}.vts")
    assert meshonet("convert", "flat.vts", "low.vts", "-o", "p3d/{stem}.p3d").code == 0
    names = sorted(path.name for path in Path("p3d").iterdir())
    assert names == ["flat.nmf", "flat.p3d", "low.nmf", "low.p3d"]
    assert meshonet("convert", "flat.vts", "low.vts", "both.h5").code == 0
    assert len(list(read_grids("both.h5"))) == 2


def test_extrude_makes_one_layer_of_cells(meshonet: Meshonet, grid_vts: Path) -> None:
    vtk = pytest.importorskip("vtk")
    assert meshonet("convert", grid_vts, "grid3d.vts", "--extrude", "0.25").code == 0
    reader = vtk.vtkXMLStructuredGridReader()
    reader.SetFileName("grid3d.vts")
    reader.Update()
    assert reader.GetOutput().GetExtent() == (0, 40, 0, 14, 0, 1)
    assert reader.GetOutput().GetBounds()[4:] == (0.0, 0.25)


def test_plot3d_is_written_and_read_in_the_variant_asked_for(meshonet: Meshonet, grid_vts: Path) -> None:
    words = "fortran,big,float32,single"
    assert meshonet("convert", grid_vts, "grid.p3d", "--plot3d", words).code == 0
    data = Path("grid.p3d").read_bytes()
    assert data[:16] == b"\0\0\0\x08\0\0\0\x29\0\0\0\x0f\0\0\0\x08"
    assert len(data) == 16 + 8 + 4 * 2 * 41 * 15
    assert meshonet("convert", "grid.p3d", "back.h5", "--plot3d", words).code == 0
    assert meshonet("quality", "grid.p3d", "--from", f"plot3d:{words}").code == 0
    done = meshonet("convert", "grid.p3d", "back.h5", "--plot3d", "little")
    assert done.code == 2
    assert "grid.p3d: is not little: it fits" in done.err


def test_options_of_plot3d_between_other_formats_are_refused(meshonet: Meshonet, grid_vts: Path) -> None:
    done = meshonet("convert", grid_vts, "back.h5", "--plot3d", "ascii")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert "grid.vts: --plot3d: neither the input (vts) nor the output (hdf5) is Plot3D" in done.err
    assert not Path("back.h5").exists()
    assert meshonet("convert", grid_vts, "grid.dat", "--to", "plot3d:ascii").code == 0
    assert meshonet("convert", "grid.dat", "back.h5", "--plot3d", "ascii").code == 0


def test_coarsening_a_volume_that_does_not_divide_names_no_option_of_planar_grids(
    meshonet: Meshonet,
) -> None:
    Path("line.csv").write_text("0 0 0\n2 0 0\n")
    assert meshonet("sweep", "circle:1", "line.csv", "--planes", "4", "-o", "pipe.h5").code == 0
    done = meshonet("convert", "pipe.h5", "half.h5", "--coarsen", "2")
    assert done.code == 2
    assert "make the grid with a multiple of 2 cells along every direction of its blocks" in done.err


def test_a_surface_is_coarsened_and_is_no_case_of_openfoam(meshonet: Meshonet) -> None:
    x, y = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 3), indexing="ij")
    write("sheet.cgns", [Grid((Block(np.stack([x, y, x * y], axis=-1)),))])
    assert meshonet("convert", "sheet.cgns", "half.cgns", "--coarsen", "2").code == 0
    assert [block.counts for block in next(read_grids("half.cgns")).blocks] == [(3, 2)]
    done = meshonet("convert", "sheet.cgns", "case.foam")
    assert (done.code, done.err.count("\n")) == (2, 1)
    assert "openfoam files hold grids in the plane and volumes, but this grid has surfaces" in done.err


def test_iblank_is_told_of(meshonet: Meshonet, grid_vts: Path) -> None:
    assert meshonet("convert", grid_vts, "grid.p3d", "--plot3d", "iblank").code == 0
    assert "iblank" not in meshonet("convert", "grid.p3d", "grid.h5").err
    text = Path("grid.p3d").read_text()
    Path("grid.p3d").write_text(text[:-4] + "0 2\n")
    done = meshonet("convert", "grid.p3d", "grid.h5")
    assert done.code == 0
    assert "warning: grid.p3d: iblank marks nodes (1 with 0, 1 with 2); they are kept as ord" in done.err


def test_folded_cells_are_told_of(meshonet: Meshonet, grid_vts: Path) -> None:
    assert meshonet("convert", grid_vts, "fine.h5", "-q").err == ""
    (grid,) = read_grids(str(grid_vts))
    nodes = grid.nodes.copy()
    nodes[20, 7] = nodes[20, 9]  # a node beyond its neighbour: some of its four cells are inverted
    write("folded.vts", [Grid.from_nodes(nodes, "o")])
    folded = meshonet("quality", "folded.vts", "--json").only["folded"]
    done = meshonet("convert", "folded.vts", "folded.cgns")
    assert (done.code, folded > 0) == (0, True)
    assert f"warning: folded.vts: the grid has {folded} folded cells; they are written" in done.err


@pytest.mark.parametrize("name", ["both.p3d", "both.bin", "both.cgns", "both.vtm"])
def test_grids_of_different_sizes_are_blocks_of_one_file(
    meshonet: Meshonet, grid_vts: Path, name: str
) -> None:
    meshonet("tfi", "naca:0012", "--res", "31x9", "-o", "other.vts")
    assert meshonet("convert", grid_vts, "other.vts", "-o", name).code == 0
    assert [(grid.ni, grid.nj) for grid in read_grids(name)] == [(41, 15), (31, 9)]
    assert meshonet("convert", name, "again.cgns").code == 0
    assert [(grid.ni, grid.nj) for grid in read_grids("again.cgns")] == [(41, 15), (31, 9)]
    done = meshonet("convert", grid_vts, "other.vts", "-o", "both.h5")
    assert done.code == 2
    assert "31x9 o does not fit a dataset of 41x15 o" in done.err


def test_planes_say_how_many_layers(meshonet: Meshonet, grid_vts: Path) -> None:
    assert meshonet("convert", grid_vts, "grid3d.p3d", "--extrude", "1", "--planes", "5").code == 0
    text = Path("grid3d.p3d").read_text().split()
    assert text[:4] == ["1", "41", "15", "5"]
    assert sorted({float(z) for z in text[4 + 2 * 41 * 15 * 5 :]}) == [0, 0.25, 0.5, 0.75, 1]
    (before,), (after,) = read_grids("grid.vts"), read_grids("grid3d.p3d")
    np.testing.assert_array_equal(after.nodes[:, :, 0, :2], before.nodes)  # a volume: of several layers


def test_normalise_gives_unit_chord(meshonet: Meshonet) -> None:
    meshonet("tfi", "naca:0012", "--res", "41x9", "-o", "grid.vts")
    (grid,) = read_grids("grid.vts")
    moved = grid.with_nodes(3 * grid.nodes @ np.array([[0.8, -0.6], [0.6, 0.8]]) + (5, -2))
    write("moved.vts", [moved])
    assert meshonet("convert", "moved.vts", "back.vts", "--normalise").code == 0
    (back,) = read_grids("back.vts")
    np.testing.assert_allclose(back.nodes, grid.nodes, atol=1e-12)


def test_normalise_gives_a_duct_unit_length(meshonet: Meshonet, duct_h5: Path) -> None:
    meshonet("tfi", duct_h5, "-o", "duct.vts")
    assert meshonet("convert", "duct.vts", "unit.vts", "--normalise").code == 0
    (grid,) = read_grids("unit.vts")
    assert grid.nodes.min(axis=(0, 1)).tolist() == [0, 0]
    assert np.ptp(grid.nodes, axis=(0, 1)).max() == 1


def test_normalise_reaches_airfoils_that_become_boundaries(meshonet: Meshonet) -> None:
    x = 0.5 * (1 + np.cos(np.linspace(0, np.pi, 41)))
    y = 0.3 * np.sqrt(x) * (1 - x)
    points = np.concatenate([np.stack([x, y], 1), np.stack([x, -y], 1)[-2::-1]])
    Path("a.dat").write_text("big\n" + "\n".join(f"{10 * u:.8f} {10 * v:.8f}" for u, v in points))
    assert meshonet("convert", "a.dat", "a.h5", "--normalise").code == 0
    (shape,) = read_shapes("a.h5")
    assert abs(np.ptp(shape.south[:, 0]) - 1) < 1e-3  # type: ignore[union-attr]


def test_boundaries_become_boundaries(meshonet: Meshonet, three_h5: Path) -> None:
    done = meshonet("convert", three_h5, "flat.vts")
    assert done.code == 2
    assert "holds boundaries, not grids" in done.err


def test_a_pipe_needs_no_file(meshonet: Meshonet, process: Process, grid_vts: Path, tmp_path: Path) -> None:
    read = (tmp_path / grid_vts).read_bytes()
    done = process("convert", "-", "-", "--from", "vts", "--to", "plot3d-ascii", input=read)
    assert done.returncode == 0
    assert done.stdout.split()[:2] in ([b"1", b"41"], [b"41", b"15"])


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("grid.vts",), "convert: there is no file to write; name it: meshonet convert grid.vts OUT"),
        (("grid.vts", "grid.abc"), "its ending '.abc' is not known; choose the format with --to"),
        (("grid.vts", "grid.p3d", "--extrude", "0"), "--extrude: height 0 is not positive"),
        (("grid.vts", "grid.p3d", "--extrude", "inf"), "--extrude: height inf is not positive"),
        (
            ("grid.vts", "grid.p3d", "--planes", "3"),
            "--planes: there is no height; give --extrude or --revolve as well",
        ),
        (("grid.vts", "grid.p3d", "--extrude", "1", "--planes", "1"), "'--planes': 1 is not in the range"),
        (("grid.vts", "grid.geo", "--extrude", "1"), "geo holds flat grids only; write one of"),
        (("missing.vts", "grid.p3d"), "missing.vts: no such file"),
    ],
)
def test_mistakes_get_a_line(
    meshonet: Meshonet, grid_vts: Path, words: tuple[str, ...], message: str
) -> None:
    done = meshonet("convert", *words)
    assert done.code == 2
    assert message in done.err
    assert done.err.count("\n") == 1


def test_skip_existing_passes_over_what_is_there(meshonet: Meshonet, grid_vts: Path) -> None:
    Path("grid.p3d").write_text("mine")
    done = meshonet("convert", grid_vts, "-o", "{stem}.p3d", "--skip-existing")
    assert done.code == 0
    assert "there already" in done.err
    assert Path("grid.p3d").read_text() == "mine"


def test_shapes_stay_shapes(meshonet: Meshonet) -> None:
    Path("duct.csv").write_text("0,0\n2,0\n2,1\n0,1\n")
    done = meshonet("convert", "duct.csv", "duct.h5")
    assert done.code == 0
    (shape,) = read_shapes("duct.h5")
    assert shape.name


def test_an_openfoam_case_fills_the_folder_of_its_file(meshonet: Meshonet, grid_vts: Path) -> None:
    assert meshonet("convert", grid_vts, "case/case.foam", "--extrude", "0.1").code == 0
    assert Path("case/case.foam").exists()
    assert Path("case/constant/polyMesh/owner").exists()
    done = meshonet("convert", grid_vts, "-", "--to", "openfoam")
    assert done.code == 2
    assert "a folder is to be written; name a file" in done.err


def test_two_cases_do_not_go_into_one_folder(meshonet: Meshonet, three_h5: Path) -> None:
    meshonet("tfi", three_h5, "-o", "{name}.vts")
    done = meshonet("convert", "flat.vts", "low.vts", "-o", "cases/{stem}.foam")
    assert done.code == 2
    assert "would overwrite cases of flat.vts" in done.err
    assert meshonet("convert", "flat.vts", "low.vts", "-o", "each/{stem}/case.foam").code == 0
    assert Path("each/low/constant/polyMesh/points").exists()


def test_the_formats_are_listed(meshonet: Meshonet) -> None:
    done = meshonet("convert", "--list-formats")
    assert (done.code, done.err) == (0, "")
    assert [line.split()[0] for line in done.out.splitlines()] == ["format", *TABLE]
    report = meshonet("convert", "--list-formats", "--json").objects
    assert [row["format"] for row in report] == list(TABLE)


def test_nothing_to_write_is_refused(meshonet: Meshonet) -> None:
    done = meshonet("convert")
    assert done.code == 2
    assert "there is no file to write; name it: meshonet convert IN OUT" in done.err


def test_swap_has_xi_run_where_eta_ran(meshonet: Meshonet, duct_h5: Path, grid_vts: Path) -> None:
    meshonet("tfi", duct_h5, "-o", "duct.vts")
    (before,) = read_grids("duct.vts")
    assert meshonet("convert", "duct.vts", "turned.vts", "--swap").code == 0
    (after,) = read_grids("turned.vts")
    assert (after.ni, after.nj) == (before.nj, before.ni)
    assert meshonet("convert", grid_vts, "no.vts", "--swap").code == 2


def test_coarsening_blocks_that_do_not_divide_names_the_option_that_lets_them(meshonet: Meshonet) -> None:
    words = ("--topology", "c", "--base", "0.05", "--base-nodes", "40", "--first-cell", "1e-3")
    assert meshonet("infer", "naca:0012", *words, "--res", "301x65", "-o", "c.vtm").code == 0
    done = meshonet("convert", "c.vtm", "half.vtm", "--coarsen", "2")
    assert done.code == 2
    assert "block 1: " in done.err
    assert "make the grid with --refine K" in done.err
