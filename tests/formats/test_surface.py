"""Boundaries with their names out of Gmsh meshes, SU2 meshes and DXF drawings, others' and our own."""

from collections.abc import Iterator
from pathlib import Path

import ezdxf
import gmsh
import meshio
import numpy as np
import pytest
from format_shapes import c_grid, channel, memory, ring

from meshonet.formats.mesh.recover_topology import boundary_of
from meshonet.formats.registry import format_named, read_shapes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.spacing.sampling import Sampling

MESHES = ["gmsh", "gmsh-ascii", "gmsh41", "gmsh41-ascii", "su2"]
SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])


def named(boundary: Boundary) -> dict[str, str]:
    """Return the side of each part."""
    return {part.name: part.side for part in boundary.patches}


@pytest.mark.parametrize("make", [channel, ring])
@pytest.mark.parametrize("name", MESHES)
def test_the_boundary_of_a_structured_mesh_comes_back_bit_for_bit(
    name: str, make: type[Grid], tmp_path: Path
) -> None:
    record, path = format_named(name), tmp_path / f"g{format_named(name).suffixes[0]}"
    assert record.write_grids is not None
    record.write_grids(path, [make()])
    (result,) = read_shapes(str(path))
    assert isinstance(result, Boundary)
    wanted = boundary_of(make())
    for side in ("south", "east", "north", "west"):
        assert np.array_equal(getattr(result, side), getattr(wanted, side))
    assert result.topology == wanted.topology
    words = {part.name.replace(" ", "_" if name == "su2" else " "): part for part in wanted.patches}
    parts = {part.name: part for part in result.patches}
    for title, part in words.items():
        assert (parts[title].side, parts[title].start, parts[title].stop) == (
            part.side,
            part.start,
            part.stop,
        )


@pytest.mark.parametrize("name", MESHES)
def test_the_wall_and_the_far_field_of_a_c_mesh_are_a_body_in_a_far_field(name: str, tmp_path: Path) -> None:
    record, path = format_named(name), tmp_path / f"g{format_named(name).suffixes[0]}"
    assert record.write_grids is not None
    record.write_grids(path, [c_grid(9, 33)])
    (result,) = read_shapes(str(path))
    boundary = result.boundary(Sampling(61, 21))
    assert (boundary.topology, boundary.ni, boundary.nj) == ("o", 61, 21)
    assert named(boundary) == {"plate": "south", "far_side" if name == "su2" else "far side": "north"}
    assert np.abs(np.hypot((boundary.south[:, 0] - 0.5) / 0.5, boundary.south[:, 1] / 0.1) - 1).max() < 0.02
    assert boundary.north[:, 0].max() == pytest.approx(3, abs=1e-9)


@pytest.fixture
def model() -> Iterator[None]:
    """Gmsh itself, silent."""
    gmsh.initialize(interruptible=False)
    gmsh.option.setNumber("General.Terminal", 0)
    yield
    gmsh.finalize()


@pytest.mark.parametrize("binary", [0, 1])
@pytest.mark.parametrize("version", [2.2, 4.1])
@pytest.mark.usefixtures("model")
def test_a_triangle_mesh_of_gmsh_gives_its_named_boundary(
    version: float, binary: int, tmp_path: Path
) -> None:
    factory = gmsh.model.occ
    duct, body = factory.addRectangle(-4, -3, 0, 8, 6), factory.addDisk(0, 0, 0, 1, 0.5)
    factory.cut([(2, duct)], [(2, body)])
    factory.synchronize()
    curves = [tag for _, tag in gmsh.model.getEntities(1)]
    spans = {tag: gmsh.model.getBoundingBox(1, tag) for tag in curves}
    wall = [tag for tag, box in spans.items() if box[3] < 1.5 and box[0] > -1.5]
    gmsh.model.addPhysicalGroup(1, wall, name="the wall")
    gmsh.model.addPhysicalGroup(1, [tag for tag in curves if tag not in wall], name="far Ω")
    gmsh.model.addPhysicalGroup(2, [1], name="air")
    gmsh.option.setNumber("Mesh.MeshSizeMax", 0.4)
    gmsh.model.mesh.generate(2)
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(str(tmp_path / "g.msh"))
    (result,) = read_shapes(str(tmp_path / "g.msh"))
    assert result.name == "g"
    boundary = result.boundary(Sampling(65, 17))
    assert named(boundary) == {"the wall": "south", "far Ω": "north"}
    assert boundary.north.min(axis=0) == pytest.approx((-4, -3), abs=0.3)
    assert np.abs(np.hypot(boundary.south[:, 0], 2 * boundary.south[:, 1]) - 1).max() < 0.03


def test_a_mesh_without_lines_has_the_rim_of_its_cells(tmp_path: Path) -> None:
    x, y = np.meshgrid(np.linspace(0, 2, 5), np.linspace(0, 1, 4))
    points = np.column_stack([x.ravel(), y.ravel()])
    quads = np.array(
        [[5 * j + i, 5 * j + i + 1, 5 * j + i + 6, 5 * j + i + 5] for j in range(3) for i in range(4)]
    )
    meshio.Mesh(np.column_stack([points, 0 * points[:, 0]]), [("quad", quads)]).write(
        tmp_path / "g.msh", file_format="gmsh22"
    )
    (result,) = read_shapes(str(tmp_path / "g.msh"))
    assert isinstance(result, Boundary)
    assert (result.ni, result.nj) == (5, 4)
    assert named(result) == {side: side for side in ("south", "east", "north", "west")}


def su2(
    markers: dict[str, list[tuple[int, int]]], points: np.ndarray[tuple[int, int], np.dtype[np.float64]]
) -> bytes:
    """Return a mesh of one polygon's markers, without cells, as other programs write it."""
    lines = ["% made by hand", "NDIME=2", "NELEM= 0", f"NPOIN= {len(points)} {len(points)}"]
    lines += [f"\t{x} {y} {k}" for k, (x, y) in enumerate(points)] + [f"NMARK= {len(markers)}"]
    for name, edges in markers.items():
        lines += [f"MARKER_TAG= {name}", f"MARKER_ELEMS={len(edges)}"]
        lines += [f"3 {a} {b}" for a, b in edges]
    return "\r\n".join([*lines, ""]).encode()


def test_four_markers_make_a_domain_whatever_their_order_and_direction() -> None:
    data = su2({"outlet": [(2, 1)], "floor": [(0, 1)], "inlet": [(0, 3)], "roof": [(3, 2)]}, SQUARE)
    read = format_named("su2").read_shapes
    assert read is not None
    (result,) = read(memory(data))
    assert named(result.boundary(Sampling(11, 5))) == {
        "outlet": "south", "roof": "east", "inlet": "north", "floor": "west",
    }  # fmt: skip


def drawing(tmp_path: Path) -> ezdxf.document.Drawing:  # type: ignore[name-defined]
    document = ezdxf.new()
    for layer in ("inlet", "floor", "roof", "outlet"):
        document.layers.add(layer)
    return document


def test_a_drawing_of_lines_arcs_and_polylines_is_a_named_domain(tmp_path: Path) -> None:
    document = drawing(tmp_path)
    space = document.modelspace()
    space.add_line((0, 1), (0, 0), dxfattribs={"layer": "inlet"})
    space.add_arc((1, 0), 0.5, 0, 180, dxfattribs={"layer": "floor"})
    space.add_line((0, 0), (0.5, 1e-9), dxfattribs={"layer": "floor"})
    space.add_line((3, 0), (1.5, 0), dxfattribs={"layer": "floor"})
    space.add_lwpolyline([(3, 0), (3, 0.4), (3, 1)], dxfattribs={"layer": "outlet"})
    space.add_spline([(3, 1), (2, 1.2), (1, 1.1), (0, 1)], dxfattribs={"layer": "roof"})
    space.add_text("a duct")
    space.add_mtext("not to scale")
    space.add_text("section A")
    document.saveas(tmp_path / "duct.dxf")
    (result,) = read_shapes(str(tmp_path / "duct.dxf"))
    boundary = result.boundary(Sampling(81, 81))
    assert {part.name for part in boundary.patches} == {"inlet", "floor", "roof", "outlet"}
    floor = next(part.side for part in boundary.patches if part.name == "floor")
    nodes = getattr(boundary, floor)
    assert nodes[:, 1].max() == pytest.approx(0.5, abs=2e-3)
    assert np.ptp(nodes[:, 0]) == pytest.approx(3, abs=1e-6)
    assert result.notes == ("of the drawing, elements that are no curves are left out: 1 MTEXT, 2 TEXT",)


def test_circles_one_in_the_other_are_a_body_in_a_far_field(tmp_path: Path) -> None:
    document = drawing(tmp_path)
    document.modelspace().add_circle((1, 1), 0.5, dxfattribs={"layer": "body"})
    document.modelspace().add_circle((1, 1), 20, dxfattribs={"layer": "far"})
    document.saveas(tmp_path / "c.dxf")
    (result,) = read_shapes(str(tmp_path / "c.dxf"))
    boundary = result.boundary(Sampling(41, 11))
    assert named(boundary) == {"body": "south", "far": "north"}
    assert np.abs(np.hypot(*(boundary.north - 1).T) - 20).max() < 1e-2


def test_closed_curves_beside_each_other_are_a_shape_each(tmp_path: Path) -> None:
    x = 0.5 * (1 + np.cos(np.linspace(0, np.pi, 31)))
    y = 0.3 * np.sqrt(x) * (1 - x)
    section = np.concatenate([np.stack([x, y], 1), np.stack([x, -y], 1)[-2::-1]])
    document = drawing(tmp_path)
    document.modelspace().add_lwpolyline(section[:-1].tolist(), close=True)
    document.modelspace().add_lwpolyline((SQUARE + 5).tolist(), close=True)
    document.saveas(tmp_path / "two.dxf")
    one, other = read_shapes(str(tmp_path / "two.dxf"))
    assert isinstance(one, Airfoil)
    assert (one.name, other.name) == ("two-1", "two-2")
    assert other.boundary(Sampling(5, 5)).topology == "quad"


def test_a_body_takes_no_other_topology() -> None:
    angle = np.linspace(0, 2 * np.pi, 41)[:-1]
    circle = np.stack([np.cos(angle), np.sin(angle)], 1)
    points = np.concatenate([circle, 5 * circle])
    edges = [(k, (k + 1) % 40) for k in range(40)]
    data = su2({"in": edges, "out": [(40 + a, 40 + b) for a, b in edges]}, points)
    read = format_named("su2").read_shapes
    assert read is not None
    (result,) = read(memory(data))
    assert named(result.boundary(Sampling(21, 5))) == {"in": "south", "out": "north"}
    with pytest.raises(InputError, match="a body in a far field makes an O grid; use topology o"):
        result.boundary(Sampling(21, 5, topology="quad"))


def test_ezdxf_that_is_missing_is_told_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    monkeypatch.setitem(sys.modules, "ezdxf", None)
    read = format_named("dxf").read_shapes
    assert read is not None
    with pytest.raises(
        InputError, match=r"needs the package ezdxf; install it: pip install 'meshonet\[dxf\]'"
    ):
        list(read(memory(b"0\nSECTION\n")))


MSH = b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n%s\n$EndNodes\n$Elements\n%s\n$EndElements\n"
POINTS = b"3\n1 0 0 0\n2 1 0 0\n3 0 1 0"
BROKEN = [
    (
        "gmsh",
        b"$MeshFormat\n1 0 8\n$EndMeshFormat\n",
        "is a Gmsh mesh of version '1'; save it as version 4.1",
    ),
    ("gmsh", b"$MeshFormat\n4.1 1 4\n\1\0\0\0\n$EndMeshFormat\n", "neither text nor binary with words of 8"),
    ("gmsh", b"hello", r"has no section \$MeshFormat; the file is cut short, or is no Gmsh mesh"),
    ("gmsh", MSH[:50], r"\$Nodes has no end; the file is cut short"),
    ("gmsh", MSH % (b"4\n1 0 0 0", b"0"), "should have 16 more numbers and is too short; the file is cut"),
    ("gmsh", MSH % (b"3\n1 0 0 x", b"0"), "has a word that is no number"),
    ("gmsh", MSH % (b"2\n1 0 0 0\n1 1 0 0", b"0"), "has two nodes of the same number"),
    ("gmsh", MSH % (POINTS, b"1\n1 1 0 1 9"), "names a node that there is none of"),
    ("gmsh", MSH % (POINTS, b"1\n1 99 0 1 2"), "has elements of kind 99; give lines"),
    ("gmsh", MSH % (POINTS, b"1\n1 1 0 1 2 3"), "has elements with another count of nodes"),
    ("gmsh", MSH % (POINTS, b"5\n1 1 0 1 2"), "should have 5 elements and is too short"),
    ("gmsh", MSH % (POINTS, b"1\n1 4 0 1 2 3 1"), "has cells of three dimensions; give a mesh of two"),
    ("gmsh", MSH % (POINTS, b"3\n1 1 0 1 2\n2 1 0 2 3\n3 1 0 2 1"), "edges? (ends|meet) at"),
    ("gmsh", MSH % (POINTS.replace(b"0 1 0", b"0 1 5"), b"1\n1 2 0 1 2 3"), "do not lie in a plane"),
    ("gmsh", MSH % (POINTS, b"0"), "has 0 boundary edges; give a mesh with 3"),
    ("su2", b"NDIME= 3\n", "line 1: is a mesh of 3 dimensions; give one of 2"),
    ("su2", b"NDIME= 2\nNZONE= 2\n", "line 2: has 2 zones"),
    ("su2", b"NDIME= 2\nNPOIN= x\n", "line 2: 'x' is no count"),
    ("su2", b"NDIME= 2\nNPOIN= 9\n0 0\n", "should have 9 more lines and has 2; the file is cut"),
    ("su2", b"NDIME= 2\nNPOIN= 2\n0 0\n1 a\n", "a word that is no number"),
    ("su2", b"NDIME= 2\nNPOIN= 1\n0\n", "points have 1 numbers"),
    (
        "su2",
        b"NDIME= 2\nNELEM= 1\n\n",
        "line 2: an empty line among the next 1, which should be cells; .*again",
    ),
    ("su2", b"NDIME= 2\nNELEM= 1\n12 1 2 3\n", "has cells of kind 12; a plane mesh has lines"),
    ("su2", b"NDIME= 2\nNELEM= 1\n9 1 2 3\n", "cells have 4 numbers; write kind, 4 points"),
    ("su2", b"NDIME= 2\nhello\n", "line 2: 'hello' is no KEYWORD= VALUE"),
    ("su2", b"NDIME= 2\n", "has no points"),
    ("su2", su2({"a": [(0, 1), (1, 2), (2, 7)]}, SQUARE), "names point 7 of 4"),
    ("su2", su2({"a": [(0, 1), (1, 2), (2, 3), (3, 0)]}, SQUARE * 1e200), "far too large"),
    ("dxf", b"AutoCAD Binary DXF\r\n", "is a binary DXF; save it as text"),
    ("dxf", b"hello\n", "is no DXF drawing that can be read .*; save it again"),
]


@pytest.mark.parametrize(("name", "data", "message"), BROKEN)
def test_what_is_wrong_is_named_with_its_remedy(name: str, data: bytes, message: str) -> None:
    read = format_named(name).read_shapes
    assert read is not None
    with pytest.raises(InputError, match=message):
        list(read(memory(data)))
