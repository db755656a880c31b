"""Vertices, edges and faces of a shape of Open Cascade as a `CadModel`."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from OCP.BRep import BRep_Tool
from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Curve2d, BRepAdaptor_Surface
from OCP.BRepTools import BRepTools, BRepTools_WireExplorer
from OCP.TopAbs import TopAbs_EDGE, TopAbs_FACE, TopAbs_FORWARD, TopAbs_REVERSED, TopAbs_WIRE
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS

from meshonet.geometry.arrays import Floats
from meshonet.geometry.cad.model import CadEdge, CadFace, CadModel, EdgeUse
from meshonet.geometry.errors import InputError


class _Numbers:
    """Numbers of shapes in the order in which they first appear, whatever their orientation."""

    def __init__(self) -> None:
        self.shapes: list[Any] = []
        self._places: dict[int, list[int]] = {}

    def __call__(self, shape: Any) -> int:
        places = self._places.setdefault(hash(shape), [])
        for place in places:
            if self.shapes[place].IsSame(shape):
                return place
        places.append(len(self.shapes))
        self.shapes.append(shape)
        return len(self.shapes) - 1


def model_of(shape: Any, name: str, notes: tuple[str, ...]) -> CadModel:
    """Return the faces of an Open Cascade shape. Raises InputError: no faces, or an edge without a vertex."""
    vertices, edges = _Numbers(), _Numbers()
    faces = tuple(_face(TopoDS.Face(face), edges) for face in _parts(shape, TopAbs_FACE))
    if not faces:
        raise InputError("has no faces", "export surfaces or solids, not only curves or meshes")
    records = tuple(_edge(edge, vertices) for edge in edges.shapes)
    places = np.array([BRep_Tool.Pnt_s(vertex).Coord() for vertex in vertices.shapes]).reshape(-1, 3)
    return CadModel(places, records, faces, name, notes)


def open_edges(shape: Any) -> int:
    """Return the number of edges of an Open Cascade shape that belong to only one face."""
    numbers, uses = _Numbers(), []
    for face in _parts(shape, TopAbs_FACE):
        for edge in _parts(face, TopAbs_EDGE):
            if not BRep_Tool.Degenerated_s(TopoDS.Edge(edge)):
                uses.append(numbers(edge))
    return int((np.bincount(np.array(uses, dtype=np.intp)) == 1).sum()) if uses else 0


def _parts(shape: Any, kind: Any) -> Iterator[Any]:
    explorer = TopExp_Explorer(shape, kind)
    while explorer.More():
        yield explorer.Current()
        explorer.Next()


def _face(shape: Any, edges: _Numbers) -> CadFace:
    face = TopoDS.Face(shape.Oriented(TopAbs_FORWARD))
    wire = BRepTools.OuterWire_s(face)
    walk = BRepTools_WireExplorer(wire, face)
    uses = []
    while walk.More():
        edge = TopoDS.Edge(walk.Current())
        trace = BRepAdaptor_Curve2d(edge, face)
        uses.append(EdgeUse(edges(edge), edge.Orientation() != TopAbs_REVERSED, _evaluator(trace)))
        walk.Next()
    surface = BRepAdaptor_Surface(face, False)

    def points(places: Floats) -> Floats:
        return np.array([surface.Value(u, v).Coord() for u, v in places.tolist()]).reshape(-1, 3)

    holes = sum(1 for _ in _parts(face, TopAbs_WIRE)) - 1
    return CadFace(tuple(uses), points, shape.Orientation() == TopAbs_REVERSED, holes)


def _edge(shape: Any, vertices: _Numbers) -> CadEdge:
    edge = TopoDS.Edge(shape.Oriented(TopAbs_FORWARD))
    ends = TopExp.FirstVertex_s(edge, False), TopExp.LastVertex_s(edge, False)
    if any(vertex.IsNull() for vertex in ends):
        raise InputError("has an edge without vertices", "export it again, with vertices on closed curves")
    first, last = (vertices(vertex) for vertex in ends)
    if BRep_Tool.Degenerated_s(edge):
        return CadEdge((first, last), None)
    return CadEdge((first, last), _evaluator(BRepAdaptor_Curve(edge)))


def _evaluator(curve: Any) -> Callable[[Floats], Floats]:
    """Return a function from parameters (n,) from 0 to 1 to points (n, 2 or 3) of a curve."""
    first, last = curve.FirstParameter(), curve.LastParameter()

    def points(part: Floats) -> Floats:
        return np.array([curve.Value(t).Coord() for t in (first + part * (last - first)).tolist()])

    return points
