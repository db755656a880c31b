"""Volumes and surfaces in CGNS: ours to the last bit, others' with their interfaces and names."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from cgns_joints import joined_nodes
from volume_grids import VOLUMES, box, pipe, shifted, turned_sector
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOCGNSReader import vtkCGNSReader

from meshonet.formats.cgns.nodes import child
from meshonet.formats.cgns.read import read_grids
from meshonet.formats.cgns.write import write_grids
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.block import PLACES, Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError

Make = Callable[[], Grid]


def surface() -> Grid:
    """The wall of the pipe as patches that know nothing of each other."""
    grid = pipe()
    faces = [grid.face(patch.block, patch.side) for patch in grid.patches if patch.name == "wall"]
    return Grid(tuple(map(Block, faces)), (Patch("rim", "west", 0, 3, block=1),), (), "skin")


def back(path: Path) -> list[Grid]:
    return list(read_grids(open_source(str(path))))


def checked(path: Path) -> str:
    """What cgnscheck says of a file, without errors and warnings."""
    done = subprocess.run(["cgnscheck", "-v", str(path)], capture_output=True, text=True, timeout=60)
    message = done.stdout + done.stderr
    assert done.returncode == 0
    assert "WARNING" not in message, message
    assert "ERROR" not in message, message
    return message


@pytest.mark.parametrize("make", [*VOLUMES, surface])
def test_a_grid_comes_back_to_the_last_bit(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [grid])
    (result,) = back(tmp_path / "g.cgns")
    for block, old in zip(result.blocks, grid.blocks, strict=True):
        assert np.array_equal(block.nodes.view(np.uint64), old.nodes.view(np.uint64))
    assert (result.connections, result.name, result.provenance) == (
        grid.connections,
        grid.name,
        grid.provenance,
    )
    assert sorted(result.patches, key=repr) == sorted(grid.patches, key=repr)


@pytest.mark.client("cgnscheck")
@pytest.mark.parametrize("make", VOLUMES)
def test_cgnscheck_has_neither_errors_nor_warnings(make: Make, tmp_path: Path) -> None:
    write_grids(tmp_path / "g.cgns", [make()])
    message = checked(tmp_path / "g.cgns")
    joints = make().connections
    assert message.count("checking donor interface") == 2 * len(joints)
    assert message.count("checking periodic property") == 2 * sum(c.transform is not None for c in joints)


@pytest.mark.client("cgnscheck")
def test_cgnscheck_takes_a_surface_and_volumes_in_bases_of_their_own(tmp_path: Path) -> None:
    write_grids(tmp_path / "g.cgns", [surface(), pipe()])
    assert "Base2" in checked(tmp_path / "g.cgns")
    with h5py.File(tmp_path / "g.cgns") as file:
        assert [file[base]["\x20data"][()].tolist() for base in ("Base", "Base2")] == [[2, 3], [3, 3]]
    one, two = back(tmp_path / "g.cgns")
    assert [len(grid.blocks[0].counts) for grid in (one, two)] == [2, 3]


@pytest.mark.parametrize("make", VOLUMES)
def test_vtk_reads_every_zone(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [grid])
    reader = vtkCGNSReader()
    reader.SetFileName(str(tmp_path / "g.cgns"))
    reader.UpdateInformation()
    reader.EnableAllBases()
    reader.Update()
    base = reader.GetOutput().GetBlock(0)
    assert base.GetNumberOfBlocks() == len(grid.blocks)
    for k, block in enumerate(grid.blocks):
        zone = base.GetBlock(k)
        zone = zone.GetBlock(0) if zone.IsA("vtkMultiBlockDataSet") else zone
        points = vtk_to_numpy(zone.GetPoints().GetData())
        assert np.array_equal(points.reshape(*block.counts[::-1], 3).transpose(2, 1, 0, 3), block.nodes)


@pytest.mark.parametrize("make", VOLUMES)
def test_both_sides_of_an_interface_are_joined_node_by_node(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [grid])
    for joint, nodes, theirs in joined_nodes(tmp_path / "g.cgns", grid):
        if "GridConnectivityProperty" in joint:
            periodic = joint["GridConnectivityProperty/Periodic"]
            centre, angles, shift = (
                periodic[f"{name}/ data"][()] for name in ("RotationCenter", "RotationAngle", "Translation")
            )
            moved = (nodes - centre) @ _turn(*angles).T + centre + shift
            np.testing.assert_allclose(moved, theirs, atol=1e-6)  # of float32
        else:
            np.testing.assert_array_equal(nodes, theirs)


def _turn(a: float, b: float, c: float) -> np.ndarray:
    """About x by a, then y by b, then z by c."""
    x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    return z @ y @ x


@pytest.mark.parametrize("make", VOLUMES)
def test_conditions_cover_the_boundary_once(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [grid])
    with h5py.File(tmp_path / "g.cgns") as file:
        zones = [node for node in file["Base"].values() if node.attrs.get("label") == b"Zone_t"]
        for k, zone in enumerate(zones):
            seen = {side: np.zeros([n - 1 for n in grid.face(k, side).shape[:2]], int) for side in PLACES}
            groups = zone.get("ZoneBC", {}), zone.get("ZoneGridConnectivity", {})
            for node in [node for group in groups for node in group.values()]:
                low, high = node["PointRange/ data"][()]
                low, high = np.minimum(low, high) - 1, np.maximum(low, high) - 1
                (axis,) = np.flatnonzero(low == high)
                side = list(PLACES)[2 * axis + (low[axis] > 0)]
                part = [slice(low[other], high[other]) for other in range(3) if other != axis]
                seen[side][tuple(part)] += 1
            assert all((cells == 1).all() for cells in seen.values())


FACTS = (
    "topology", "parts", "kinds", "name", "provenance", "block", "connections", "across", "coordinates",
)  # fmt: skip


def without(path: Path, *names: str) -> None:
    """Remove nodes of these names from all zones: what is left anybody could have written."""
    with h5py.File(path, "r+") as file:
        for zone in file["Base"].values():
            for name in set(names) & set(zone):
                del zone[name]


@pytest.mark.parametrize("make", VOLUMES)
def test_a_file_of_others_comes_in_with_interfaces_and_names(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [grid])
    without(tmp_path / "g.cgns", *FACTS)
    (result,) = back(tmp_path / "g.cgns")
    periodic = make in (shifted, turned_sector)
    assert len(result.connections) == len(grid.connections)
    if not periodic:
        assert set(result.connections) == set(grid.connections)
    for mine, other in zip(result.blocks, grid.blocks, strict=True):
        np.testing.assert_allclose(mine.nodes, other.nodes, atol=1e-12 if periodic else 0)
    outer = [(p.name.replace(" ", "_"), p.side, p.start, p.stop, p.across) for p in grid.outer_patches()]
    assert [(p.name, p.side, p.start, p.stop, p.across) for p in result.outer_patches()] == outer


def edited(path: Path, grid: Grid, change: Callable[[h5py.Group], None]) -> Path:
    """A file of others, after a change to its first zone."""
    write_grids(path, [grid])
    without(path, *FACTS)
    with h5py.File(path, "r+") as file:
        change(next(node for node in file["Base"].values() if node.attrs.get("label") == b"Zone_t"))
    return path


def replaced(node: h5py.Group, values: np.ndarray) -> None:
    del node["\x20data"]
    node["\x20data"] = values


def points(zone: h5py.Group) -> None:
    """Say the plate and the inlet by lists of nodes and of faces, which have no names of families."""
    group = zone["ZoneBC"]
    for name in list(group):
        del group[name]
    i, j = np.meshgrid(np.arange(2, 6), np.arange(1, 4), indexing="ij")
    plate = child(group, "BC1", "BC_t", "BCWall")
    listed = np.stack([i.ravel(), j.ravel(), np.ones(12)], axis=-1).astype(np.int32)
    child(plate, "PointList", "IndexArray_t", np.random.default_rng(0).permutation(listed))
    inlet = child(group, "BC2", "BC_t", "BCInflow")
    child(inlet, "PointRange", "IndexRange_t", np.array([[1, 1, 1], [1, 3, 5]], np.int32))
    child(inlet, "GridLocation", "GridLocation_t", "IFaceCenter")


def test_conditions_by_points_and_faces_without_families(tmp_path: Path) -> None:
    (grid,) = back(edited(tmp_path / "g.cgns", box(), points))
    assert set(grid.patches) == {
        Patch("BC1", "bottom", 1, 4, (0, 2), kind="wall"), Patch("BC2", "west", 0, 3, (0, 5), kind="inlet"),
    }  # fmt: skip


def corner(zone: h5py.Group) -> None:
    """Say a condition of the shape of an L by a list of nodes."""
    group = zone["ZoneBC"]
    for name in list(group):
        del group[name]
    marked = [(i, j) for i in range(1, 6) for j in range(1, 5) if i <= 2 or j <= 2]
    node = child(group, "L", "BC_t", "BCWall")
    child(node, "PointList", "IndexArray_t", np.array([[i, j, 6] for i, j in marked], np.int32))


def test_a_list_of_nodes_that_is_no_rectangle_is_several(tmp_path: Path) -> None:
    (grid,) = back(edited(tmp_path / "g.cgns", box(), corner))
    cells = np.zeros((4, 3), int)
    for patch in grid.patches:
        assert (patch.name, patch.side) == ("L", "top")
        assert patch.across is not None
        cells[patch.start : patch.stop, slice(*patch.across)] += 1
    assert cells.tolist() == [[1, 1, 1], [1, 0, 0], [1, 0, 0], [1, 0, 0]]


def test_a_left_handed_zone_is_turned_with_what_it_says(tmp_path: Path) -> None:
    def mirror(zone: h5py.Group) -> None:
        for name in "XYZ":
            node = zone[f"GridCoordinates/Coordinate{name}"]
            replaced(node, node["\x20data"][()][..., ::-1])
        for condition in zone["ZoneBC"].values():
            span = condition["PointRange/ data"][()]
            span[:, 0] = 6 - span[:, 0]
            condition["PointRange/ data"][...] = span

    (grid,) = back(edited(tmp_path / "g.cgns", box(), mirror))
    np.testing.assert_array_equal(grid.nodes, box().nodes)
    assert {p.name: (p.side, p.start, p.stop) for p in grid.patches}["plate"] == ("bottom", 1, 4)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda z: z.pop("GridCoordinates"), "zone 'pipe-1': has no CoordinateX and CoordinateY; write Cart"),
        (
            lambda z: [
                z["GridCoordinates"].move(f"Coordinate{a}", f"Coordinate{b}") for a, b in ("XR", "YT")
            ],
            "zone 'pipe-1': has no CoordinateX and CoordinateY, only CoordinateR, CoordinateT, CoordinateZ; ",
        ),
        (
            lambda z: replaced(joint(z)["PointRange"], np.array([[1, 1, 1], [1, 9, 9]], np.int32)),
            "zone 'pipe-1': interface '.*' leaves its zone; correct its PointRange",
        ),
        (
            lambda z: replaced(joint(z)["PointRangeDonor"], np.array([[1, 1, 1], [1, 9, 9]], np.int32)),
            "zone 'pipe-1': interface '.*' leaves its donor; correct its PointRangeDonor",
        ),
        (
            lambda z: replaced(joint(z)["Transform"], np.array([1, 1, 3], np.int32)),
            r"interface '.*' has transform \[1, 1, 3\]; give each index once",
        ),
        (
            lambda z: replaced(joint(z)["PointRangeDonor"], np.array([[1, 1, 1], [2, 5, 1]], np.int32)),
            "blocks . and . has faces across it; join faces whose directions lie on each other",
        ),
        (
            lambda z: replaced(z, np.full((3, 3), 1 << 30, np.int64)),
            "zone 'pipe-1': its size .* is not plaus",
        ),
    ],
)
def test_what_does_not_fit_is_refused_with_its_place(
    change: Callable[[h5py.Group], None], message: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=message):
        back(edited(tmp_path / "g.cgns", pipe(), change))


def joint(zone: h5py.Group) -> h5py.Group:
    """The first interface of a zone."""
    return next(iter(zone["ZoneGridConnectivity"].values()))
