import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from format_shapes import c_grid, channel, memory, ring
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOCGNSReader import vtkCGNSReader

from meshonet.formats.cgns.read import read_grids
from meshonet.formats.cgns.write import write_grids
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

MAKES = [channel, ring, c_grid]


@pytest.mark.parametrize("thick", [False, True])
@pytest.mark.parametrize("make", MAKES)
def test_vtk_reads_every_zone_bit_for_bit(make: type[Grid], thick: bool, tmp_path: Path) -> None:
    grids = [make(name="first"), make(name="second")]  # type: ignore[call-arg]
    if thick:
        write_grids(tmp_path / "g.cgns", [extruded(grid, (0.0, 0.25)) for grid in grids])
    else:
        write_grids(tmp_path / "g.cgns", grids)
    reader = vtkCGNSReader()
    reader.SetFileName(str(tmp_path / "g.cgns"))
    reader.UpdateInformation()
    reader.EnableAllBases()
    reader.Update()
    base = reader.GetOutput().GetBlock(0)
    names = [base.GetMetaData(k).Get(base.NAME()) for k in range(base.GetNumberOfBlocks())]
    assert names == ["first", "second"]
    zone = base.GetBlock(1).GetBlock(0) if base.GetBlock(1).IsA("vtkMultiBlockDataSet") else base.GetBlock(1)
    points = vtk_to_numpy(zone.GetPoints().GetData())
    planes = 2 if thick else 1
    assert len(points) == planes * grids[1].ni * grids[1].nj
    shaped = points.reshape(planes, grids[1].nj, grids[1].ni, 3)
    for k in range(planes):
        assert np.array_equal(shaped[k, :, :, :2].swapaxes(0, 1), grids[1].nodes)
        assert (shaped[k, ..., 2] == 0.25 * k).all()


@pytest.mark.client("cgnscheck")
@pytest.mark.parametrize("thick", [False, True])
@pytest.mark.parametrize("make", MAKES)
def test_cgnscheck_has_neither_errors_nor_warnings(make: type[Grid], thick: bool, tmp_path: Path) -> None:
    path = tmp_path / "g.cgns"
    grids = [make(), make()]
    if thick:
        write_grids(path, [extruded(grid, (0.0, 0.25)) for grid in grids])
    else:
        write_grids(path, grids)
    done = subprocess.run(["cgnscheck", "-v", str(path)], capture_output=True, text=True, timeout=60)
    message = done.stdout + done.stderr
    assert done.returncode == 0
    assert "WARNING" not in message
    assert "ERROR" not in message
    assert message.rstrip().endswith("checking complete")
    assert message.count("checking donor interface") == (0 if make is channel else 4)


@pytest.mark.client("hdf2adf")
def test_the_old_container_is_refused_by_name(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.cgns", [ring()])
    subprocess.run(["hdf2adf", "g.cgns", "old.cgns"], cwd=tmp_path, check=True, timeout=60)
    with pytest.raises(InputError, match="ADF container; turn it into HDF5: adf2hdf"):
        list(read_grids(open_source(str(tmp_path / "old.cgns"))))


def joints(path: Path, zone: str) -> list[tuple[list[list[int]], list[list[int]], list[int]]]:
    """Return range, donor range and transform of each one-to-one joint."""
    with h5py.File(path) as file:
        group = file[f"Base/{zone}/ZoneGridConnectivity"]
        return [
            tuple(
                node[f"{name}/ data"][()].tolist() for name in ("PointRange", "PointRangeDonor", "Transform")
            )
            for node in group.values()
        ]


@pytest.mark.parametrize("make", [ring, c_grid])
def test_both_sides_of_a_cut_are_joined_node_by_node(make: type[Grid], tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [grid])
    result = joints(tmp_path / "g.cgns", grid.name)
    assert len(result) == 2
    for own, donor, transform in result:
        steps = max(abs(a - b) for a, b in zip(own[0], own[1], strict=True))
        for k in range(steps + 1):
            here = [a + k * np.sign(b - a) for a, b in zip(own[0], own[1], strict=True)]
            # the standard's rule: the donor's index is begin + T (here - begin)
            move = np.zeros(2, int)
            for axis, target in enumerate(transform):
                move[abs(target) - 1] += np.sign(target) * (here[axis] - own[0][axis])
            there = np.array(donor[0]) + move
            assert np.array_equal(
                grid.nodes[here[0] - 1, here[1] - 1], grid.nodes[there[0] - 1, there[1] - 1]
            )
        assert there.tolist() == donor[1]


def test_conditions_cover_the_boundary_and_families_say_what_they_are(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.cgns", [c_grid(), channel()])
    with h5py.File(tmp_path / "g.cgns") as file:
        base = file["Base"]
        kinds = {
            name: base[f"{name}/FamilyBC/ data"][()].tobytes().decode()
            for name in base
            if base[name].attrs.get("label") == b"Family_t"
        }
        ranges = [node["PointRange/ data"][()].tolist() for node in base["c/ZoneBC"].values()]
    assert kinds == {
        "plate": "BCWall", "far_side": "BCFarfield", "no-slip_wall": "BCWall", "south": "BCGeneral",
        "out_let": "BCGeneral", "north": "BCGeneral", "inlet": "BCInflow",
    }  # fmt: skip
    assert ranges == [[[4, 1], [12, 1]], [[15, 1], [15, 4]], [[1, 4], [15, 4]], [[1, 1], [1, 4]]]


def test_a_zone_and_a_family_of_one_name_do_not_meet(tmp_path: Path) -> None:
    grids = [
        Grid.from_nodes(ring().nodes, "o", name=name) for name in ("wall", "wall", "DataClass", "x" * 50)
    ]
    write_grids(tmp_path / "g.cgns", grids)
    assert [grid.name for grid in read_grids(open_source(str(tmp_path / "g.cgns")))] == [
        g.name for g in grids
    ]
    with h5py.File(tmp_path / "g.cgns") as file:
        zones = [name for name, node in file["Base"].items() if node.attrs.get("label") == b"Zone_t"]
    assert zones == ["wall", "wall-3", "DataClass-2", "x" * 32]


def test_conditions_of_others_become_parts(tmp_path: Path) -> None:
    grid = channel()
    path = tmp_path / "g.cgns"
    write_grids(path, [grid])
    with h5py.File(path, "r+") as file:
        for fact in ("topology", "parts", "name", "provenance"):
            del file[f"Base/channel/{fact}"]
    (back,) = read_grids(open_source(str(path)))
    assert set(back.patches) == {
        Patch("no-slip_wall", "south", 0, 3), Patch("south", "south", 3, 6), Patch("out_let", "east", 0, 4),
        Patch("north", "north", 0, 6), Patch("inlet", "west", 0, 4),
    }  # fmt: skip


@pytest.mark.parametrize(
    ("remove", "message"),
    [
        ("Base", "holds no CGNS zone; give a CGNS file"),
        ("Base/ring/GridCoordinates", "zone 'ring': has no CoordinateX and CoordinateY; write Cartesian"),
        ("Base/ring/ data", "/Base/ring: node has no data of its own"),
    ],
)
def test_what_is_missing_is_named(remove: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "g.cgns"
    write_grids(path, [ring()])
    with h5py.File(path, "r+") as file:
        del file[remove]
    with pytest.raises(InputError, match=message):
        list(read_grids(memory(path.read_bytes())))


@pytest.mark.parametrize(
    ("node", "value", "message"),
    [
        ("Base/ring", np.array([[13, 5], [12, 4]], np.int32), r"size has shape \(2, 2\)"),
        (
            "Base/ring",
            np.array([[14, 5], [13, 4], [0, 0]], np.int32),
            "CoordinateX has .* without rind planes",
        ),
        ("Base/ring", np.full((3, 3), 1 << 30, np.int64), "is not plausible"),
        ("Base/ring/ZoneType", np.frombuffer(b"Unstructured", np.int8), "its zones are unstructured"),
        ("Base/ring/ZoneType", np.zeros((2, 2), np.int8), "node holds int8 with 2 axes"),
    ],
)
def test_what_does_not_fit_is_named(
    node: str, value: np.ndarray[tuple[int, ...], np.dtype[np.generic]], message: str, tmp_path: Path
) -> None:
    path = tmp_path / "g.cgns"
    write_grids(path, [ring()])
    with h5py.File(path, "r+") as file:
        del file[f"{node}/ data"]
        file[f"{node}/ data"] = value
    with pytest.raises(InputError, match=message):
        list(read_grids(memory(path.read_bytes())))


def test_metadata_of_zones_are_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import meshonet.formats.cgns.read as cgns

    grids = [channel(name=f"grid {k}") for k in range(12)]
    write_grids(tmp_path / "g.cgns", grids)
    read: list[str] = []
    text = cgns.text
    monkeypatch.setattr(cgns, "text", lambda node: read.append(node.name) or text(node))
    assert len(list(read_grids(open_source(str(tmp_path / "g.cgns"))))) == 12
    assert len(read) == len(set(read)) > 12  # they take most of the time of a file of many zones
