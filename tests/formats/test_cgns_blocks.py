"""Grids of many blocks in CGNS: ours to the last bit, those of others with their interfaces."""

import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import h5py
import numpy as np
import pytest
from block_grids import turned
from cgns_joints import joined_nodes
from format_shapes import channel, ring
from many_blocks import MANY, butterfly, by_block, duct, passage, sector, sorted_joints, step

from meshonet.formats.cgns.nodes import child, root
from meshonet.formats.cgns.read import read_grids
from meshonet.formats.cgns.write import write_grids
from meshonet.formats.mesh.unstructured import unstructured
from meshonet.formats.registry import read_grids as read_any
from meshonet.formats.source import open_source
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.extrude import extruded
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.errors import InputError

Make = Callable[[], Grid]
FACTS = ("topology", "parts", "name", "provenance", "block", "connections")


def thick(grid: Grid, heights: tuple[float, ...]) -> Grid:
    """Return a grid repeated in z where there are heights."""
    return extruded(grid, heights) if heights else grid


def back(path: Path) -> list[Grid]:
    return list(read_grids(open_source(str(path))))


def without(path: Path, *names: str) -> None:
    """Remove nodes of these names from all zones: what is left anybody could have written."""
    with h5py.File(path, "r+") as file:
        for zone in file["Base"].values():
            for name in names:
                if name in zone:
                    del zone[name]


@pytest.mark.parametrize("heights", [(), (0.0, 0.25)])
@pytest.mark.parametrize("make", MANY)
def test_a_grid_comes_back_to_the_last_bit(make: Make, heights: tuple[float, ...], tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [thick(each, heights) for each in (channel(), grid, ring(), grid)])
    one, two, three, four = back(tmp_path / "g.cgns")
    assert (one.topology, three.topology) == ("quad", "o")
    for result in (two, four):
        for block, old in zip(result.blocks, grid.blocks, strict=True):
            assert np.array_equal(block.nodes.view(np.uint64), old.nodes.view(np.uint64))
        assert (result.connections, result.name, result.provenance) == (
            grid.connections, grid.name, grid.provenance
        )  # fmt: skip
        assert result.patches == by_block(grid.patches)


@pytest.mark.client("cgnscheck")
@pytest.mark.parametrize("heights", [(), (0.0, 0.25)])
@pytest.mark.parametrize("make", MANY)
def test_cgnscheck_has_neither_errors_nor_warnings(
    make: Make, heights: tuple[float, ...], tmp_path: Path
) -> None:
    write_grids(tmp_path / "g.cgns", [thick(make(), heights)])
    done = subprocess.run(
        ["cgnscheck", "-v", str(tmp_path / "g.cgns")], capture_output=True, text=True, timeout=60
    )
    message = done.stdout + done.stderr
    assert done.returncode == 0
    assert "WARNING" not in message
    assert "ERROR" not in message
    assert message.count("checking donor interface") == 2 * len(make().connections)
    assert message.count("checking periodic property") == 2 * sum(
        c.transform is not None for c in make().connections
    )


@pytest.mark.parametrize("make", MANY)
def test_both_sides_of_an_interface_are_joined_node_by_node(make: Make, tmp_path: Path) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [grid])
    for joint, nodes, theirs in joined_nodes(tmp_path / "g.cgns", grid):
        if "GridConnectivityProperty" not in joint:
            np.testing.assert_array_equal(nodes, theirs)
        elif make is passage:
            shift = joint["GridConnectivityProperty/Periodic/Translation/ data"][()]
            np.testing.assert_allclose(theirs - nodes, np.broadcast_to(shift, nodes.shape), rtol=1e-6)


@pytest.mark.parametrize("heights", [(), (0.0, 0.25)])
@pytest.mark.parametrize("make", MANY)
def test_a_file_of_others_comes_in_with_interfaces_and_names(
    make: Make, heights: tuple[float, ...], tmp_path: Path
) -> None:
    grid = make()
    write_grids(tmp_path / "g.cgns", [thick(grid, heights)])
    without(tmp_path / "g.cgns", *FACTS)
    (result,) = back(tmp_path / "g.cgns")
    assert len(result.connections) == len(grid.connections)
    assert {p.name for p in result.patches} >= {p.name.replace(" ", "_") for p in grid.patches}
    merged, wanted = unstructured(result), unstructured(grid)
    assert len(merged.points) == len(wanted.points)
    assert {n: len(e) for n, e in merged.faces.items()} == {
        n.replace(" ", "_"): len(e) for n, e in wanted.faces.items()
    }
    if make not in (passage, sector):
        assert sorted_joints(result.connections) == sorted_joints(grid.connections)
        without(tmp_path / "g.cgns", "ZoneGridConnectivity")  # found by position then
        (again,) = back(tmp_path / "g.cgns")
        assert (again.connections, again.patches) == (result.connections, result.patches)


def zone(base: h5py.Group, name: str, nodes: Floats, *, space: bool = False) -> h5py.Group:
    """Add a bare zone of plane nodes (ni, nj, 2), with z = 0 in `space`."""
    ni, nj = nodes.shape[:2]
    made = child(base, name, "Zone_t", np.array([[ni, nj], [ni - 1, nj - 1], [0, 0]], np.int32))
    child(made, "ZoneType", "ZoneType_t", "Structured")
    coordinates = child(made, "GridCoordinates", "GridCoordinates_t")
    for k, axis in enumerate("XYZ"[: 3 if space else 2]):
        values = nodes[..., k].T if k < 2 else np.zeros((nj, ni))
        child(coordinates, f"Coordinate{axis}", "DataArray_t", np.ascontiguousarray(values))
    return made


def condition(
    made: h5py.Group,
    name: str,
    kind: str,
    points: Sequence[Sequence[int]],
    more: dict[str, str] | None = None,
) -> None:
    group = made["ZoneBC"] if "ZoneBC" in made else child(made, "ZoneBC", "ZoneBC_t")
    node = child(group, name, "BC_t", kind)
    several = len(points) > 2
    child(
        node,
        "PointList" if several else "PointRange",
        "IndexArray_t" if several else "IndexRange_t",
        np.array(points, np.int32),
    )
    for label, value in (more or {}).items():
        child(node, label.removesuffix("_t"), label, value)


def joint(
    made: h5py.Group, donor: str, own: list[list[int]], other: list[list[int]], transform: list[int] | None
) -> None:
    group = made["ZoneGridConnectivity"] if "ZoneGridConnectivity" in made else child(
        made, "ZoneGridConnectivity", "ZoneGridConnectivity_t"
    )  # fmt: skip
    node = child(group, f"con{len(group)}", "GridConnectivity1to1_t", donor)
    child(node, "PointRange", "IndexRange_t", np.array(own, np.int32))
    child(node, "PointRangeDonor", "IndexRange_t", np.array(other, np.int32))
    if transform:
        child(node, "Transform", '"int[IndexDimension]"', np.array(transform, np.int32))


def pair(shift: float = 0.0) -> tuple[Floats, Floats]:
    """Two blocks beside each other, 5 x 4 and 3 x 4 nodes, the second `shift` away."""
    x, y = np.meshgrid(np.arange(7.0), np.arange(4.0), indexing="ij")
    nodes = np.stack([x, y + 0.1 * x * y], axis=-1)
    return nodes[:5], nodes[4:] + np.array([shift, 0])


@pytest.mark.parametrize("own", [[[5, 1], [5, 4]], [[5, 4], [5, 1]]])
@pytest.mark.parametrize("other", [[[1, 1], [1, 4]], [[1, 4], [1, 1]]])
@pytest.mark.parametrize("transform", [[1, 2], [-1, -2], None])
def test_ranges_may_run_either_way_and_transforms_have_any_sign(
    own: list[list[int]], other: list[list[int]], transform: list[int] | None, tmp_path: Path
) -> None:
    left, right = pair()
    right = right + 2e-5 * np.array([0, 1.0])  # farther than rounding: only the file says that they meet
    with h5py.File(tmp_path / "g.cgns", "w", track_order=True) as file:
        base = child(root(file), "B", "CGNSBase_t", np.array([2, 2], np.int32))
        joint(zone(base, "left", left), "right", own, other, transform)
        condition(zone(base, "right", right), "wall", "BCWall", [[1, 1], [3, 1]])
    (grid,) = back(tmp_path / "g.cgns")
    (result,) = grid.connections
    assert (result.side, result.donor_side, result.orientation) == ("east", "west", (1,))
    assert grid.provenance["zones"] == ["left", "right"]
    assert {p.name for p in grid.patches} == {"wall", "outer"}


def test_left_handed_and_turned_zones_are_joined(tmp_path: Path) -> None:
    left, right = pair()
    with h5py.File(tmp_path / "g.cgns", "w", track_order=True) as file:
        base = child(root(file), "B", "CGNSBase_t", np.array([2, 3], np.int32))
        first = zone(base, "left", left[:, ::-1], space=True)  # left-handed, in space with z = 0
        second = zone(base, "right", turned(right, 1), space=True)
        joint(first, "right", [[5, 1], [5, 4]], [[1, 3], [4, 3]], [2, 1])
        joint(second, "left", [[1, 3], [4, 3]], [[5, 1], [5, 4]], [2, 1])
        condition(first, "bc", "BCWallViscous", [[1, 4], [5, 4]], {"FamilyName_t": "B/low"})
        condition(second, "out", "BCOutflowSubsonic", [[1, 1], [4, 1]])
    (grid,) = back(tmp_path / "g.cgns")
    assert len(grid.connections) == 1
    mesh = unstructured(grid)
    assert len(mesh.points) == 28
    assert mesh.points[mesh.faces["low"]][..., 1].max() == 0
    assert mesh.points[mesh.faces["out"]][..., 0].min() == 6
    kinds = {patch.name: patch.kind for patch in grid.patches}
    assert (kinds["low"], kinds["out"]) == ("wall", "outlet")


def test_conditions_by_family_by_faces_and_by_points(tmp_path: Path) -> None:
    left, right = pair()
    with h5py.File(tmp_path / "g.cgns", "w", track_order=True) as file:
        base = child(root(file), "B", "CGNSBase_t", np.array([2, 2], np.int32))
        first, second = zone(base, "left", left), zone(base, "right", right)
        child(child(base, "skin", "Family_t"), "FamilyBC", "FamilyBC_t", "BCWallViscous")
        condition(first, "bc1", "FamilySpecified", [[1, 1], [5, 1]], {"FamilyName_t": "skin"})
        condition(first, "bc2", "BCInflow", [[1, 3], [1, 1]], {"GridLocation_t": "IFaceCenter"})
        condition(second, "bc3", "BCSymmetryPlane", [[1, 4], [2, 4], [3, 4]])
        condition(second, "none", "Null", [[1, 1], [1, 4]])
    (grid,) = back(tmp_path / "g.cgns")
    assert len(grid.connections) == 1  # a condition that says nothing does not hide an interface
    result = {p.name: (p.block, p.side, p.start, p.stop, p.kind) for p in grid.patches}
    assert result["skin"] == (0, "south", 0, 4, "wall")
    assert result["bc2"] == (0, "west", 0, 3, "inlet")
    assert result["bc3"] == (1, "north", 0, 2, "symmetry")


def test_walls_on_both_sides_of_a_plate_stay_apart(tmp_path: Path) -> None:
    left, right = pair()
    with h5py.File(tmp_path / "g.cgns", "w", track_order=True) as file:
        base = child(root(file), "B", "CGNSBase_t", np.array([2, 2], np.int32))
        first, second = zone(base, "left", left), zone(base, "right", right)
        condition(first, "plate", "BCWall", [[5, 1], [5, 3]])
        condition(second, "plate", "BCWall", [[1, 1], [1, 3]])
    (grid,) = back(tmp_path / "g.cgns")
    assert [c.range for c in grid.connections] == [((2, 3),)]
    assert len(unstructured(grid).points) == 28 + 2


def test_zones_in_several_bases_that_touch_are_one_grid_and_others_are_not(tmp_path: Path) -> None:
    left, right = pair()
    with h5py.File(tmp_path / "g.cgns", "w", track_order=True) as file:
        top = root(file)
        for name, nodes in (("A", left), ("B", right), ("C", left + np.array([0, 50]))):
            base = child(top, name, "CGNSBase_t", np.array([2, 2], np.int32))
            made = zone(base, "zone", nodes)
            if name == "A":
                joint(made, "B/zone", [[5, 1], [5, 4]], [[1, 1], [1, 4]], [1, 2])
    one, other = back(tmp_path / "g.cgns")
    assert (len(one.blocks), len(other.blocks), other.topology) == (2, 1, "quad")
    assert len(one.connections) == 1


@pytest.mark.parametrize("sign", [1, -1])
def test_periodic_interfaces_are_found_whatever_sign_the_file_has(sign: int, tmp_path: Path) -> None:
    for make, motion in ((passage, Motion((0.1, 0.7))), (sector, sector().connections[1].transform)):
        write_grids(tmp_path / "g.cgns", [make()])
        without(tmp_path / "g.cgns", *FACTS)
        with h5py.File(tmp_path / "g.cgns", "r+") as file:
            for made in (node for node in file["Base"].values() if "ZoneGridConnectivity" in node):
                for node in made["ZoneGridConnectivity"].values():
                    if "GridConnectivityProperty" in node:
                        node["GridConnectivityProperty/Periodic/Translation/ data"][...] *= sign
                        node["GridConnectivityProperty/Periodic/RotationAngle/ data"][...] *= sign
        (grid,) = back(tmp_path / "g.cgns")
        periodic = [c for c in grid.connections if c.transform]
        assert len(periodic) == 3
        assert all(c.transform == periodic[0].transform for c in periodic)
        assert motion is not None
        assert periodic[0].transform is not None
        assert periodic[0].transform.alike(motion, 1e-12)
        assert {"periodic_low", "periodic_high"} <= {p.name for p in grid.patches}


def test_interfaces_that_join_nothing_are_refused_with_their_place(tmp_path: Path) -> None:
    left, right = pair()
    for other, message in (
        ([[1, 1], [1, 3]], "joins 3 cells to 2; join equal"),
        ([[3, 1], [3, 4]], "no shift or"),
    ):
        with h5py.File(tmp_path / "g.cgns", "w", track_order=True) as file:
            base = child(root(file), "B", "CGNSBase_t", np.array([2, 2], np.int32))
            joint(zone(base, "left", left), "right", [[5, 1], [5, 4]], other, None)
            zone(base, "right", right * (1, 1.5))
        with pytest.raises(InputError, match=message):
            back(tmp_path / "g.cgns")


def test_a_single_zone_of_others_keeps_its_names_when_it_is_turned(tmp_path: Path) -> None:
    nodes = np.swapaxes(ring().nodes, 0, 1)  # left-handed, j around
    with h5py.File(tmp_path / "g.cgns", "w", track_order=True) as file:
        base = child(root(file), "B", "CGNSBase_t", np.array([2, 2], np.int32))
        made = zone(base, "z", nodes)
        condition(made, "skin", "BCWall", [[1, 1], [1, 13]])
        condition(made, "far", "BCFarfield", [[5, 1], [5, 13]])
    (grid,) = back(tmp_path / "g.cgns")
    assert grid.topology == "o"
    assert {(p.name, p.side, p.kind) for p in grid.patches} == {
        ("skin", "south", "wall"), ("far", "north", "farfield"),
    }  # fmt: skip


@pytest.mark.usefixtures("silent_gmsh")
@pytest.mark.parametrize("ending", ["cgns", "p3d"])
def test_what_gmsh_writes_of_transfinite_surfaces_is_one_grid(ending: str, tmp_path: Path) -> None:
    import gmsh

    geo, lines = gmsh.model.geo, dict[str, int]()
    points = {
        name: geo.addPoint(x, y, 0)
        for name, (x, y) in {
            "a": (0, 0), "b": (1, 0), "c": (2, 0), "d": (2, 1),
            "e": (1, 1), "f": (0, 1), "g": (1, 2), "h": (0, 2),
        }.items()
    }  # fmt: skip
    for corners in ("abef", "bcde", "fegh"):
        loop = []
        for first, second in zip(corners, corners[1:] + corners[0], strict=True):
            if second + first not in lines:
                lines[first + second] = geo.addLine(points[first], points[second])
            loop.append(lines.get(first + second) or -lines[second + first])
        surface = geo.addPlaneSurface([geo.addCurveLoop(loop)])
        geo.mesh.setTransfiniteSurface(surface)
        geo.mesh.setRecombine(2, surface)
    for name, line in lines.items():
        geo.mesh.setTransfiniteCurve(line, 6 if name in ("ab", "ef", "gh") else 5)
    geo.synchronize()
    gmsh.model.addPhysicalGroup(1, [lines["ab"], lines["bc"]], name="wall")
    gmsh.model.addPhysicalGroup(1, [lines["gh"]], name="outlet")
    gmsh.model.addPhysicalGroup(2, [1, 2, 3], name="fluid")
    gmsh.model.mesh.generate(2)
    gmsh.option.setNumber("Mesh.CgnsExportStructured", 1)
    gmsh.write(str(tmp_path / f"g.{ending}"))
    (grid,) = read_any(str(tmp_path / f"g.{ending}"))
    mesh = unstructured(grid)
    assert (len(grid.blocks), len(grid.connections), len(mesh.points), len(mesh.cells)) == (3, 2, 74, 56)
    sizes = {name: len(edges) for name, edges in mesh.faces.items()}
    assert sizes == ({"wall": 9, "outlet": 5, "outer": 20} if ending == "cgns" else {"outer": 34})


@pytest.mark.parametrize("make", [butterfly, duct, step])
def test_zones_keep_their_names(make: Make, tmp_path: Path) -> None:
    write_grids(tmp_path / "g.cgns", [make()])
    without(tmp_path / "g.cgns", *FACTS)
    (result,) = back(tmp_path / "g.cgns")
    write_grids(tmp_path / "again.cgns", [result])
    with h5py.File(tmp_path / "again.cgns") as file:
        assert set(result.provenance["zones"]) <= set(file["Base"])
