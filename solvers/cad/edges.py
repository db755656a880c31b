"""Nodes along the edges of a CAD file; cell sizes can follow the curvature."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.cad.model import CadEdge, CadFace, CadModel, Curve, EdgeUse
from meshonet.geometry.elementary import product, sin
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.polygon.corners import angle_between
from meshonet.geometry.spacing.gradual_sizes import limited_sizes

TURN_DEG = 12.0  # largest angle by which a curve turns along a cell, with spacing by curvature
_FINEST = 0.02  # smallest ratio of cells where the curvature is large to cells elsewhere
_SHORT = 4.0  # number of cells along a short edge; cells of the neighbouring edges are adapted to these
_GRADE = 0.2  # largest change of the cell size along an edge per distance
_SAMPLES = 257
CORNER_DEG = 30.0  # smallest turn, in degrees, of a loop at a vertex that is a corner of the face


@dataclass(frozen=True, eq=False)
class EdgeNodes:
    """Nodes of an edge: parameters (n,) from 0 to 1 and positions (n, 3); the ends are the vertices."""

    parts: Floats
    points: Floats

    def along(self, use: EdgeUse) -> tuple[Floats, Floats]:
        """Return coordinates (n, 2) on the face and positions (n, 3) of the nodes, in the order of `use`."""
        places = use.trace(self.parts)
        return (places, self.points) if use.forward else (places[::-1], self.points[::-1])


@dataclass(frozen=True, eq=False)
class EdgeLaw:
    """Node distribution of an edge: ``cells[k]`` cells lie between its start and parameter ``parts[k]``."""

    parts: Floats
    cells: Floats

    @property
    def total(self) -> float:
        """Number of cells of the distribution; in general, it is not an integer."""
        return float(self.cells[-1])

    def nodes(self, model: CadModel, edge: CadEdge, count: int) -> EdgeNodes:
        """Return the nodes of an edge that is divided into `count` cells."""
        part = np.arange(count + 1) / count
        if edge.points is None:
            return EdgeNodes(part, np.repeat(model.vertices[edge.ends[0]][None], count + 1, axis=0))
        places = np.interp(part * self.total, self.cells, self.parts)
        points = edge.points(places)
        points[[0, -1]] = model.vertices[list(edge.ends)]
        return EdgeNodes(places, points)


def edge_laws(model: CadModel, size: float, spacing: str) -> list[EdgeLaw]:
    """Return the distribution of nodes along each edge, for cells of at most `size`.

    `spacing` is ``uniform``, ``cosine`` or ``curvature``, also called ``auto``. With ``curvature``, cells are
    smaller where edges bend, and next to short edges. An edge that is a single point (a pole) gets the
    distribution of the line half-way to the opposite edge of its face.

    Raises InputError if `spacing` is none of these.
    """
    curves = [edge.points for edge in model.edges]
    for face in model.faces:
        for k, use in enumerate(face.uses):
            if curves[use.edge] is None:
                curves[use.edge] = _middle(face, k)
    sizes = np.full(len(model.vertices), size)
    for edge in model.edges:
        if edge.points is not None:
            short = max(length_of(edge.points) / _SHORT, _FINEST * size)
            for vertex in edge.ends:
                sizes[vertex] = min(sizes[vertex], short)
    return [
        _law(curve, size, sizes[list(edge.ends)], spacing)
        for curve, edge in zip(curves, model.edges, strict=True)
        if curve is not None
    ]


def length_of(curve: Curve) -> float:
    """Return the length of a curve, as the sum of short chords."""
    return float(norms(np.diff(curve(np.linspace(0.0, 1.0, _SAMPLES)), axis=0)).sum())


def _middle(face: CadFace, k: int) -> Curve:
    """Return the line of a face half-way between its edge number `k`, a pole, and the farthest edge."""
    pole, part = face.uses[k].trace, np.linspace(0.0, 1.0, 33)
    first, last = pole(np.array([0.0, 1.0]))
    others = np.concatenate([use.trace(part) for at, use in enumerate(face.uses) if at != k]) - first
    along = np.abs(last - first) > 0.0  # the coordinate that varies at the pole, the other one leads away
    away = np.where(along, 0.0, others)
    shift = 0.5 * away[np.abs(away).sum(axis=1).argmax()]
    return lambda at: face.points(pole(at) + shift)


def _law(curve: Curve, size: float, ends: Floats, spacing: str) -> EdgeLaw:
    part = np.linspace(0.0, 1.0, _SAMPLES)
    points = curve(part)
    steps = norms(np.diff(points, axis=0))
    arcs = np.append(0.0, np.cumsum(steps))
    if spacing == "uniform":
        return EdgeLaw(part, arcs / size)
    if spacing == "cosine":
        # s = sin(pi q / 2)^2 has its largest step, pi / 2 times the mean, in the middle
        wave = np.linspace(0.0, 1.0, _SAMPLES)
        cells = np.interp(arcs / arcs[-1], sin(0.5 * np.pi * wave) ** 2, wave)
        return EdgeLaw(part, cells * 0.5 * np.pi * arcs[-1] / size)
    if spacing not in ("auto", "curvature"):
        problem = f"{{spacing}} {spacing} is of no use to CAD files"
        raise InputError(problem, "use curvature, uniform or cosine", parameter="spacing")
    wanted = np.maximum(np.minimum(_by_turning(points, arcs), size), _FINEST * size)
    wanted[[0, -1]] = np.minimum(wanted[[0, -1]], ends)
    sizes = limited_sizes(wanted, arcs, _GRADE)
    pieces = steps * 0.5 * (1.0 / sizes[1:] + 1.0 / sizes[:-1])
    return EdgeLaw(part, np.append(0.0, np.cumsum(pieces)))


def _by_turning(points: Floats, arcs: Floats) -> Floats:
    """Return the length (s,) of cells along which a curve turns by `TURN_DEG`."""
    chords = np.diff(points, axis=0)
    turn = np.degrees(angle_between(chords[:-1], chords[1:]))
    length = 0.5 * (arcs[2:] - arcs[:-2])
    inner = TURN_DEG * length / np.maximum(turn, 1e-9)
    return np.concatenate([inner[:1], inner, inner[-1:]])


def corner_turns(model: CadModel, uses: tuple[EdgeUse, ...]) -> Floats:
    """Return turning angles (k,) in degrees where a loop's edges start; 180 next to edges of length 0."""
    ends = np.array([0.0, 1e-4, 1.0 - 1e-4, 1.0])
    starts, stops, poles = [], [], []
    for use in uses:
        points = model.edges[use.edge].points
        poles.append(points is None)
        at = np.zeros((4, 3)) if points is None else points(ends)
        at = at if use.forward else at[::-1]
        starts.append(at[1] - at[0])
        stops.append(at[3] - at[2])
    turns = np.degrees(angle_between(np.roll(np.array(stops), 1, axis=0), np.array(starts)))
    beside = np.array(poles) | np.roll(np.array(poles), 1)
    return np.where(beside, 180.0, turns)


def place_on(points: Floats) -> str:
    """Return the mean position of points (n, 3) as text."""
    return place_of(product(np.full(len(points), 1.0 / len(points)), points))
