import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from format_shapes import PYTHON, VARIANTS, Pipe, c_grid, channel, ring

from meshonet.formats.mesh.recover_topology import boundary_of
from meshonet.formats.registry import (
    TABLE,
    format_for_output,
    format_named,
    format_of,
    read_grids,
    read_shapes,
)
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError

HEAVY = ("h5py", "meshio", "matplotlib", "shapely", "scipy", "torch", "numba")
EVERY = (*TABLE.values(), *map(format_named, VARIANTS))
BOTH_WAYS = [row.name for row in EVERY if row.write_grids and row.read_grids]
BOUNDARIES = [row.name for row in TABLE.values() if row.write_boundaries and row.read_shapes]


def run_python(code: str) -> str:
    done = subprocess.run([PYTHON, "-c", code], capture_output=True, text=True, timeout=60, check=True)
    return done.stdout.strip()


def test_importing_the_registry_imports_no_heavy_library() -> None:
    loaded = run_python(
        f"import sys, meshonet.formats.registry; print([m for m in {HEAVY} if m in sys.modules])"
    )
    assert loaded == "[]"


def test_writing_a_vts_imports_no_heavy_library(tmp_path: Path) -> None:
    code = (
        "import sys, numpy as np; from pathlib import Path; from meshonet.geometry.blocks.grid import Grid;"
        "from meshonet.formats.registry import format_for_output, read_grids;"
        "g = Grid.from_nodes(np.stack(np.meshgrid([0., 1.], [0., 1.], indexing='ij'), -1));"
        f"p = {str(tmp_path / 'g.vts')!r};"
        "format_for_output(p).write_grids(Path(p), [g]); list(read_grids(p));"
        f"print([m for m in {HEAVY} if m in sys.modules])"
    )
    assert run_python(code) == "[]"


@pytest.mark.parametrize("name", TABLE)
def test_a_record_has_a_name_endings_and_a_description(name: str) -> None:
    record = format_named(name)
    assert record.name == name
    assert record.description
    assert all(suffix.startswith(".") and suffix == suffix.lower() for suffix in record.suffixes)


def test_every_format_can_do_something_and_is_tested() -> None:
    """Formats that no grid is read from have test files with a reader of somebody else's."""
    others = [p.read_text() for p in Path(__file__).parent.glob("test_*.py") if p.name != Path(__file__).name]
    for record in TABLE.values():
        doings = (record.read_shapes, record.read_grids, record.write_grids, record.write_boundaries)
        assert any(doings), record.name
        if record.write_grids and not record.read_grids:
            assert any(re.search(rf"\b{record.name}\b", text) for text in others), record.name


@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.parametrize("name", BOTH_WAYS)
def test_a_grid_comes_back_bit_for_bit_and_the_writer_leaves_it_alone(
    name: str, make: type[Grid], tmp_path: Path
) -> None:
    grid, untouched = make(), make()
    record = format_named(name)
    path = tmp_path / f"grid{record.suffixes[0]}"
    assert record.write_grids is not None
    record.write_grids(path, [grid])
    assert np.array_equal(grid.nodes, untouched.nodes)
    assert grid.patches == untouched.patches
    (back,) = read_grids(str(path), name)
    assert back.nodes.dtype == np.float64
    assert np.array_equal(back.nodes, grid.nodes)
    assert back.topology == grid.topology
    if record.names_patches:
        assert (back.patches, back.name) == (grid.patches, grid.name)
        assert dict(back.provenance) == dict(grid.provenance)
    else:
        assert back.name == "grid"


@pytest.mark.parametrize("name", [n for n in BOTH_WAYS if n != "hdf5" and "volumes" in format_named(n).space])
@pytest.mark.parametrize("heights", [(0.0, 0.1), (0.0, 0.1, 0.2, 0.3)])
def test_a_grid_repeated_in_z_is_read_as_the_plane_grid_it_was(
    name: str, heights: tuple[float, ...], tmp_path: Path
) -> None:
    """Where the file has no room to say so, several layers of cells are a volume, and one is not."""
    grid = channel()
    record = format_named(name)
    path = tmp_path / f"thick{record.suffixes[0]}"
    assert record.write_grids is not None
    record.write_grids(path, [extruded(grid, heights)])
    (back,) = read_grids(str(path), name)
    if record.names_patches or len(heights) == 2:
        assert np.array_equal(back.nodes, grid.nodes)
    else:
        assert np.array_equal(back.nodes, extruded(grid, heights).nodes)


@pytest.mark.parametrize("name", BOTH_WAYS)
def test_several_grids_are_kept_or_refused_with_the_remedy(name: str, tmp_path: Path) -> None:
    record = format_named(name)
    path = tmp_path / f"grid{record.suffixes[0]}"
    assert record.write_grids is not None
    if record.many:
        record.write_grids(path, (ring(name=f"r{k}") for k in range(3)))
        assert [g.nodes.shape for g in read_grids(str(path), name)] == [(13, 5, 2)] * 3
    else:
        with pytest.raises(
            InputError,
            match=r"holds one grid and there are several; write one file each \(output 'name-\{index\}'\)",
        ):
            record.write_grids(path, [ring(), ring()])


@pytest.mark.parametrize("name", [row.name for row in EVERY if row.write_grids])
def test_no_grid_at_all_is_refused(name: str, tmp_path: Path) -> None:
    record = format_named(name)
    assert record.write_grids is not None
    with pytest.raises(InputError, match="there is no grid to write"):
        record.write_grids(tmp_path / "none", [])


@pytest.mark.parametrize("make", [channel, ring, c_grid])
@pytest.mark.parametrize("name", BOUNDARIES)
def test_a_boundary_comes_back_bit_for_bit(name: str, make: type[Grid], tmp_path: Path) -> None:
    source = tmp_path / "grid.h5"
    hdf5 = format_named("hdf5")
    assert hdf5.write_grids is not None
    hdf5.write_grids(source, [make()])
    (boundary,) = read_shapes(str(source))
    assert isinstance(boundary, Boundary)
    record = format_named(name)
    path = tmp_path / f"boundary{record.suffixes[0]}"
    assert record.write_boundaries is not None
    record.write_boundaries(path, [boundary])
    (back,) = read_shapes(str(path), name)
    assert isinstance(back, Boundary)
    for side in ("south", "east", "north", "west"):
        assert np.array_equal(getattr(back, side), getattr(boundary, side))
    assert (back.topology, back.patches, back.name) == (boundary.topology, boundary.patches, boundary.name)


@pytest.mark.parametrize("name", BOTH_WAYS)
def test_the_outer_edges_of_a_grid_file_are_a_boundary(name: str, tmp_path: Path) -> None:
    record = format_named(name)
    path = tmp_path / f"grid{record.suffixes[0]}"
    assert record.write_grids is not None
    record.write_grids(path, [ring()])
    (boundary,) = read_shapes(str(path), name)
    assert isinstance(boundary, Boundary)
    assert boundary.topology == "o"
    assert np.array_equal(boundary.south, ring().nodes[:, 0])
    assert np.array_equal(boundary.west, boundary.east)


@pytest.mark.parametrize("name", BOTH_WAYS)
def test_the_content_tells_when_the_ending_does_not(name: str, tmp_path: Path) -> None:
    record = format_named(name)
    path = tmp_path / "grid.unknown"
    assert record.write_grids is not None
    record.write_grids(path, [ring(60, 40)])
    assert format_of(open_source(str(path))).name == name.partition(":")[0]
    (back,) = read_grids(str(path))
    assert np.array_equal(back.nodes, ring(60, 40).nodes)


def test_standard_input_is_recognised_by_its_content(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    for name in set(BOTH_WAYS) - {"vtm"}:  # which names files beside it
        path = tmp_path / name
        writer = format_named(name).write_grids
        assert writer is not None
        writer(path, [ring()])
        monkeypatch.setattr(sys, "stdin", Pipe(path.read_bytes()))
        (back,) = read_grids("-")
        assert np.array_equal(back.nodes, ring().nodes)


def test_a_dat_file_is_told_apart_by_its_content(tmp_path: Path) -> None:
    path = tmp_path / "grid.dat"
    writer = format_for_output(str(path)).write_grids
    assert writer is not None
    for grid in (ring(), ring(200, 100)):
        writer(path, [grid])
        assert format_of(open_source(str(path))).name == "plot3d"
        words = path.read_text().split()
        pairs = [" ".join(words[k : k + 2]) for k in range(3, len(words), 2)]
        path.write_text("\n".join(["1", f"{grid.ni} {grid.nj}", *pairs]) + "\n")
        assert format_of(open_source(str(path))).name == "plot3d"
    angle = np.linspace(0, 2 * np.pi, 200)
    for title in ("A SECTION\n", "", "2032 section\n"):
        rows = "".join(f"{0.5 + 0.5 * np.cos(a):.6f} {0.06 * np.sin(a):.6f}\n" for a in angle)
        path.write_text(title + rows)
        assert format_of(open_source(str(path))).name == "airfoil"
        path.write_text(title + rows * 20)
        assert format_of(open_source(str(path))).name == "airfoil"
    path.write_text("hello\n")
    assert format_of(open_source(str(path))).name == "airfoil"


def test_a_designation_is_an_airfoil_unless_a_file_is_called_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (shape,) = read_shapes("naca:2412")
    assert "2412" in shape.name
    monkeypatch.chdir(tmp_path)
    writer = format_named("hdf5").write_grids
    assert writer is not None
    writer(tmp_path / "naca:2412", [ring()])
    (shape,) = read_shapes("naca:2412")
    assert isinstance(shape, Boundary)


def test_a_format_may_be_named_by_its_ending_or_its_family() -> None:
    assert format_named("h5").name == "hdf5"
    assert format_named(".p3d").name == "plot3d"
    assert format_named("bin").name == "plot3d:binary"
    assert format_named("VTS").name == "vts"


@pytest.mark.parametrize(
    ("old", "name"),
    [
        ("vtk-ascii", "vtk:ascii"), ("gmsh-ascii", "gmsh:ascii"), ("gmsh41", "gmsh:4.1"),
        ("gmsh41-ascii", "gmsh:ascii,4.1"), ("plot3d-ascii", "plot3d:ascii"),
        ("plot3d-fortran", "plot3d:fortran"), ("ufmt", "plot3d:fortran"),
        ("plot3d-binary:big", "plot3d:binary,big"), ("plot3d:binary:ascii,big", "plot3d:ascii,big"),
        ("stl", "meshio:stl"), ("abaqus", "meshio:abaqus"), ("inp", "meshio:abaqus"),
    ],
)  # fmt: skip
def test_old_names_and_endings_are_names_with_options(old: str, name: str) -> None:
    assert format_named(old).name == name


def test_old_names_of_plot3d_read_any_layout_and_options_only_theirs(tmp_path: Path) -> None:
    path = tmp_path / "g.p3d"
    writer = format_named("plot3d").write_grids
    assert writer is not None
    writer(path, [ring()])
    assert np.array_equal(next(read_grids(str(path), "plot3d-binary")).nodes, ring().nodes)
    with pytest.raises(InputError, match="is not binary: it fits 2d ascii"):
        next(read_grids(str(path), "plot3d:binary"))


@pytest.mark.parametrize(
    ("ending", "name"), [(".bin", "plot3d:binary"), (".xyz", "plot3d"), (".stl", "meshio:stl")]
)
def test_the_ending_of_an_output_chooses_options(ending: str, name: str) -> None:
    assert format_for_output(f"a{ending}").name == name


def test_standard_output_is_hdf5_unless_said_otherwise() -> None:
    assert format_for_output("-").name == "hdf5"
    assert format_for_output("-", "vts").name == "vts"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("no.vts", "no.vts: no such file; check the path"),
        ("", "is a folder; name a file in it"),
        ("empty.vts", "empty.vts: is empty; give"),
        ("case.foam", "case.foam: openfoam files can only be written; give a grid"),
        ("a.q", r"a.q: its ending '.q' is not .*from_format; known endings: "),
        ("plain", "plain: its content is not of a known format; name it with from_format"),
        ("loop.vts", "loop.vts: cannot be opened .*symbolic"),
        ("a\0b", "null byte.*; check the path"),
        ("x.png", "x.png: png files can only be written; give a grid"),
        ("x.geo", "x.geo: geo files can only be written; give a grid"),
        (
            "plain#a",
            "plain#a: no such file, and of .*plain there is only #train, #test, #7 or #5:9; leave #a",
        ),
        ("x.png#0", "samples of png files have no numbers; leave out what is behind #"),
        ("\x1b[31m.vts", r"\\x1b\[31m.vts: no such file"),
    ],
)
def test_what_cannot_be_read_is_named_with_its_remedy(name: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "empty.vts").touch()
    (tmp_path / "case.foam").touch()
    for file in ("a.q", "plain", "x.png", "x.geo"):
        (tmp_path / file).write_text("hello\n")
    (tmp_path / "loop.vts").symlink_to(tmp_path / "loop.vts")
    with pytest.raises(InputError, match=message):
        list(read_grids(str(tmp_path / name)))
    with pytest.raises(InputError, match=message):
        list(read_shapes(str(tmp_path / name)))


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("a.q", r"a.q: its ending '.q' is not known; .*to_format; known endings: .*\.vts"),
        ("", "output: the output has no name; name a file, or - for standard output"),
        ("grid", "grid: its name has no ending to tell the format by; .*to_format"),
        ("a.vts", "a.vts: vts cannot hold boundaries; write one of hdf5"),
    ],
)
def test_what_cannot_be_written_is_named_with_its_remedy(path: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        format_for_output(path, kind="boundaries")


def test_an_unknown_format_name_lists_the_known_ones() -> None:
    with pytest.raises(
        InputError, match=r"format 'cgsn' is not known; did you mean 'cgns'\? use one of hdf5, "
    ):
        format_named("cgsn")


def test_a_file_of_boundaries_is_no_file_of_grids(tmp_path: Path) -> None:
    writer = format_named("hdf5").write_boundaries
    assert writer is not None
    writer(tmp_path / "b.h5", [boundary_of(ring())])
    with pytest.raises(InputError, match=r"b.h5: holds boundaries, not grids; make grids .* meshonet"):
        list(read_grids(str(tmp_path / "b.h5")))
