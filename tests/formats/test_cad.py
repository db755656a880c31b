"""Faces of STEP and B-rep files become patches that match; Open Cascade makes the files (extra ``cad``)."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from meshonet.formats.cad import read
from meshonet.formats.registry import read_shapes
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.cad.model import CadModel
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.geometry.surface.surface import surface_of
from meshonet.solvers.cad.patches import patches_on
from meshonet.solvers.hyperbolic.volume.march import VolumeMarch, march_surface
from meshonet.solvers.solution import Solution

pytest.importorskip("OCP")

from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut, BRepAlgoAPI_Fuse
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex, BRepBuilderAPI_MakeWire
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
from OCP.BRepPrimAPI import (
    BRepPrimAPI_MakeBox,
    BRepPrimAPI_MakeCone,
    BRepPrimAPI_MakeCylinder,
    BRepPrimAPI_MakeSphere,
    BRepPrimAPI_MakeTorus,
    BRepPrimAPI_MakeWedge,
)
from OCP.BRepTools import BRepTools
from OCP.collections import Array1_gp_Pnt
from OCP.GeomAbs import GeomAbs_C2
from OCP.GeomAPI import GeomAPI_PointsToBSpline
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
from OCP.TopAbs import TopAbs_FACE
from OCP.TopExp import TopExp_Explorer


def section(chord: float, y: float, x: float, base: float = 0.0025) -> Any:
    """A NACA 0012 with a blunt base: a spline and a straight line."""
    t = 0.5 * (1.0 + np.cos(np.linspace(0.0, np.pi, 41)))
    half = 0.6 * (0.2969 * np.sqrt(t) - 0.126 * t - 0.3516 * t**2 + 0.2843 * t**3 - 0.1036 * t**4)
    half += base * t
    points = np.stack([np.append(t, t[-2::-1]), np.append(half, -half[-2::-1])], axis=-1)
    table = Array1_gp_Pnt(1, len(points))
    corners = [gp_Pnt(x + chord * float(p), y, chord * float(q)) for p, q in points]
    for k, corner in enumerate(corners, 1):
        table.SetValue(k, corner)
    spline = GeomAPI_PointsToBSpline(table, 3, 8, GeomAbs_C2, 1e-5).Curve()
    wire = BRepBuilderAPI_MakeWire()
    wire.Add(BRepBuilderAPI_MakeEdge(spline).Edge())
    wire.Add(BRepBuilderAPI_MakeEdge(corners[-1], corners[0]).Edge())
    return wire.Wire()


def wing() -> Any:
    """A swept wing lofted through three sections, closed at both ends."""
    loft = BRepOffsetAPI_ThruSections(True, False)
    for chord, y, x in ((0.8, 0.0, 0.0), (0.6, 0.6, 0.35), (0.45, 1.2, 0.69)):
        loft.AddWire(section(chord, y, x))
    loft.Build()
    return loft.Shape()


def drilled() -> Any:
    drill = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(2, 2, -1), gp_Dir(0, 0, 1)), 0.5, 6.0).Shape()
    return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(4.0, 4.0, 4.0).Shape(), drill).Shape()


def stepped() -> Any:
    """Two boxes of different heights: two faces have five edges, two of them on one side."""
    low = BRepPrimAPI_MakeBox(gp_Pnt(1, 0, 0), 1.0, 1.0, 0.5).Shape()
    return BRepAlgoAPI_Fuse(BRepPrimAPI_MakeBox(1.0, 1.0, 1.0).Shape(), low).Shape()


def step_file(shape: Any, path: Path) -> Path:
    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_AsIs)
    writer.Write(str(path))
    return path


def model_in(path: Path) -> CadModel:
    (model,) = read_shapes(str(path))
    assert isinstance(model, CadModel)
    return model


def patched(shape: Any, folder: Path, **sampling: Any) -> Solution:
    return patches_on(model_of(shape, folder), Sampling(**sampling))


def model_of(shape: Any, folder: Path) -> CadModel:
    """What a STEP file of the shape has; the trial in a process of its own, a second long, is left out."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(read, "_is_readable", lambda *_: True)
        return model_in(step_file(shape, folder / "part.step"))


def enclosed(grid: Grid) -> float:
    """The volume inside quadrilaterals that face outwards."""
    total = 0.0
    for block in grid.blocks:
        a, b, c, d = block.nodes[:-1, :-1], block.nodes[1:, :-1], block.nodes[1:, 1:], block.nodes[:-1, 1:]
        total += float((0.5 * np.cross(c - a, d - b) * 0.25 * (a + b + c + d)).sum()) / 3.0
    return total


def off_cylinder(p: Floats) -> Floats:
    return np.maximum(np.hypot(p[:, 0], p[:, 1]) - 1.0, np.abs(p[:, 2] - 1.0) - 1.0)


def off_cone(p: Floats) -> Floats:
    return np.maximum((np.hypot(p[:, 0], p[:, 1]) - 1.0 + 0.5 * p[:, 2]) * 2.0 / 5.0**0.5, -p[:, 2])


SHAPES: dict[str, tuple[Callable[[], Any], float, int, Callable[[Floats], Floats]]] = {
    "box": (
        lambda: BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape(), 6.0, 6,
        lambda p: (np.abs(p - [0.5, 1.0, 1.5]) - [0.5, 1.0, 1.5]).max(axis=1),
    ),
    "cylinder": (lambda: BRepPrimAPI_MakeCylinder(1.0, 2.0).Shape(), 2.0 * np.pi, 11, off_cylinder),
    "sphere": (
        lambda: BRepPrimAPI_MakeSphere(1.0).Shape(), 4.0 / 3.0 * np.pi, 1,
        lambda p: np.linalg.norm(p, axis=1) - 1.0,
    ),
    "torus": (
        lambda: BRepPrimAPI_MakeTorus(2.0, 0.5).Shape(), np.pi**2, 1,
        lambda p: np.hypot(np.hypot(p[:, 0], p[:, 1]) - 2.0, p[:, 2]) - 0.5,
    ),
    "cone": (lambda: BRepPrimAPI_MakeCone(1.0, 0.0, 2.0).Shape(), 2.0 / 3.0 * np.pi, 6, off_cone),
    "stepped": (
        stepped, 1.5, 11,
        lambda p: np.abs(p[:, :, None] - [[0, 1, 2], [0, 1, 1], [0, 0.5, 1]]).min(axis=(1, 2)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", SHAPES)
def test_patches_lie_on_the_faces_match_and_face_outwards(name: str, tmp_path: Path) -> None:
    make, volume, count, off = SHAPES[name]
    grid = patched(make(), tmp_path).grid
    assert len(grid.blocks) == count
    nodes = np.concatenate([block.nodes.reshape(-1, 3) for block in grid.blocks])
    assert np.abs(off(nodes)).max() < 1e-8 * np.ptp(nodes, axis=0).max()
    assert enclosed(grid) == pytest.approx(volume, rel=0.01)
    surface = surface_of(grid)
    assert not len(surface.open_edges)
    assert not any("turned round" in note for note in surface.notes)


def test_the_volume_converges_with_the_square_of_the_cells(tmp_path: Path) -> None:
    shape = BRepPrimAPI_MakeTorus(2.0, 0.5).Shape()
    model = model_of(shape, tmp_path)
    volumes = [enclosed(patches_on(model, Sampling(ni=n, spacing="uniform")).grid) for n in (20, 80)]
    coarse, fine = np.pi**2 - np.array(volumes)
    assert 0.5 * np.log2(coarse / fine) == pytest.approx(2.0, abs=0.1)


def test_nodes_of_shared_edges_are_bitwise_the_same(tmp_path: Path) -> None:
    grid = patched(wing(), tmp_path).grid
    rims = [
        np.concatenate([b.nodes[0], b.nodes[-1], b.nodes[1:-1, 0], b.nodes[1:-1, -1]]) for b in grid.blocks
    ]
    points = np.concatenate(rims)
    exact = np.unique(points, axis=0)
    rounded = np.unique(np.round(points, 9), axis=0)
    assert len(exact) == len(rounded) < 0.6 * len(points)


def test_a_lofted_wing_is_on_its_surface_and_is_marched(tmp_path: Path) -> None:
    shape = wing()
    grid = patched(shape, tmp_path).grid
    faces = TopExp_Explorer(shape, TopAbs_FACE)
    upper = faces.Current()  # an independent judge: the distance from the loft itself
    nodes = grid.blocks[0].nodes[1:-1:9, 1:-1:9].reshape(-1, 3)
    for p in nodes.tolist():
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*p)).Vertex()
        assert BRepExtrema_DistShapeShape(vertex, upper).Value() < 1e-8 * 1.2
    solution = march_surface(surface_of(grid), VolumeMarch(first_cell=1e-4, layers=30, far_field=5.0))
    assert len(solution.grid.blocks) == 4
    heights = np.concatenate(
        [np.diff(b.nodes[:, :, :2], axis=2).reshape(-1, 3) for b in solution.grid.blocks]
    )
    assert np.linalg.norm(heights, axis=1) == pytest.approx(1e-4, rel=1e-9)


def test_separate_faces_are_sewn(tmp_path: Path) -> None:
    from OCP.BRep import BRep_Builder
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
    from OCP.TopoDS import TopoDS_Compound

    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    faces = TopExp_Explorer(BRepPrimAPI_MakeBox(1.0, 1.0, 1.0).Shape(), TopAbs_FACE)
    while faces.More():
        builder.Add(compound, BRepBuilderAPI_Copy(faces.Current()).Shape())
        faces.Next()
    solution = patched(compound, tmp_path)
    assert solution.notes == ("24 edges of separate faces were joined; 0 edges are open",)
    assert not len(surface_of(solution.grid).open_edges)


def test_holes_and_triangles_are_refused_with_number_and_place(tmp_path: Path) -> None:
    with pytest.raises(
        InputError, match=r"face \d near x=2, y=2, z=\d has a hole; face \d .* has a hole; split"
    ):
        patched(drilled(), tmp_path)
    with pytest.raises(InputError, match=r"face \d near x=.* has three sides"):
        patched(BRepPrimAPI_MakeWedge(1.0, 1.0, 1.0, 0.0).Shape(), tmp_path)


def test_cells_follow_number_and_spacing(tmp_path: Path) -> None:
    box, loft = (model_of(each, tmp_path) for each in (BRepPrimAPI_MakeBox(1.0, 2.0, 4.0).Shape(), wing()))

    def made(model: CadModel, **sampling: Any) -> tuple[Block, ...]:
        return patches_on(model, Sampling(**sampling)).grid.blocks

    counts = {n: sorted(made(box, ni=n)[0].counts) for n in (20, 40)}
    assert counts == {20: [11, 21], 40: [21, 41]}
    ends = {}
    for spacing in ("uniform", "cosine", "curvature"):
        line = made(box, ni=40, spacing=spacing)[0].nodes[0]
        steps = np.linalg.norm(np.diff(line, axis=0), axis=1)
        ends[spacing] = steps.max() / steps[0]
    assert ends["uniform"] == pytest.approx(1.0)
    assert ends["cosine"] > 10.0
    assert ends["curvature"] == pytest.approx(1.0)
    noses = {
        spacing: max(max(block.counts) for block in made(loft, spacing=spacing))
        for spacing in ("uniform", "curvature")
    }
    assert noses["curvature"] > 1.3 * noses["uniform"]


def test_lengths_are_those_of_the_file(tmp_path: Path) -> None:
    path = step_file(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape(), tmp_path / "box.step")
    text = path.read_text()
    for unit, name in (("SI_UNIT($,.METRE.)", "metre"), ("SI_UNIT(.CENTI.,.METRE.)", "centimetre")):
        other = tmp_path / f"{name}.stp"
        other.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", unit))
        assert model_in(other).size == pytest.approx(3.0, rel=1e-12)


def test_damaged_files_and_a_missing_package_are_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21; nothing")
    with pytest.raises(InputError, match="no STEP file that can be read"):
        model_in(path)
    monkeypatch.setitem(sys.modules, "OCP.Message", None)
    with pytest.raises(InputError, match=r"pip install 'meshonet\[cad\]'"):
        model_in(path)


def test_a_cut_file_of_which_open_cascade_never_returns_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(read, "SECONDS", 2.0)
    path = tmp_path / "box.brep"
    BRepTools.Write_s(BRepPrimAPI_MakeBox(1.0, 2.0, 3.0).Shape(), str(path))
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 2 // 5])
    with pytest.raises(InputError, match="no B-rep file"):
        list(read_shapes(str(path)))
