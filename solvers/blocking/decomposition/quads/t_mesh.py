"""The faces of a motorcycle graph: rectangles in the map, whose sides may consist of several arcs.

If the graph only has corners of one and of two right angles, and every face has four of the first kind, each
face is a rectangle of the map with opposite sides of equal length: a T-mesh (Myles, Pietroni, Zorin, ACM
Trans. Graph. 33 (2014) 135; Campen, Bommes, Kobbelt, ACM Trans. Graph. 34 (2015) 192).
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.errors import SolverError
from meshonet.solvers.blocking.decomposition.quads.motorcycle import MotorcycleGraph

Side = tuple[int, ...]
Face = tuple[Side, Side, Side, Side]


@dataclass(frozen=True, eq=False)
class TMesh:
    """Arcs between the nodes of a motorcycle graph (lines from singular points), and the faces between arcs.

    Each arc is two half-edges. Number 2 k is arc k in the direction of its line, 2 k + 1 the same reversed.
    """

    graph: MotorcycleGraph
    nodes: Indices  # (a, 2) nodes at the start and the end of each arc
    trail: Indices  # (a,) index of the line on which each arc lies
    span: Floats
    """(a, 2) length of that line up to both ends; the last arc of a closed line ends beyond its length."""
    faces: tuple[Face, ...]
    """The half-edges of the four sides of each face, counter-clockwise, the face on their left."""

    @property
    def on_wall(self) -> Indices:
        """Index (a,) of the boundary loop on which an arc lies; -1 for arcs inside the domain."""
        return np.asarray(self.graph.trails.loop[self.trail])


def t_mesh(graph: MotorcycleGraph) -> TMesh:
    """Return arcs and faces of a graph of lines. Raises SolverError if a face is not a rectangle."""
    nodes, trail, span, ways = _arcs(graph)
    follow = _successors(graph, ways)
    faces = []
    seen = [False] * (2 * len(nodes))
    for start in follow:
        if not seen[start]:
            faces.append(_face(follow, start, seen))
    whole = np.array(nodes, dtype=np.intp).reshape(-1, 2)
    spans = np.array(span).reshape(-1, 2)
    return TMesh(graph, whole, np.array(trail, dtype=np.intp), spans, tuple(faces))


_Ways = list[list[tuple[int, int]]]


def _arcs(
    graph: MotorcycleGraph,
) -> tuple[list[tuple[int, int]], list[int], list[tuple[float, float]], _Ways]:
    """Return nodes, trail and lengths of each arc, and the half-edges at each node with their directions."""
    nodes: list[tuple[int, int]] = []
    trail: list[int] = []
    span: list[tuple[float, float]] = []
    ways: _Ways = [[] for _ in graph.vertex]
    for number, stations in enumerate(graph.stations):
        if not stations:
            continue
        closed = graph.trails.loop[number] >= 0
        first = stations[0]
        total = graph.trails.total(number) if closed else 0.0
        last = [(first[0] + total, *first[1:])] if closed else []
        run = [*stations, *last]
        for (start, a, _, leave), (stop, b, arrive, _) in pairwise(run):
            arc = len(nodes)
            nodes.append((a, b))
            trail.append(number)
            span.append((start, stop))
            ways[a].append((leave, 2 * arc))
            ways[b].append((arrive, 2 * arc + 1))
    return nodes, trail, span, ways


def _successors(graph: MotorcycleGraph, ways: _Ways) -> dict[int, tuple[int, int]]:
    """Return, for each half-edge with a face on its left, the next around it and their angle in quarters."""
    follow = {}
    for around, quarters, wall in zip(ways, graph.quarters.tolist(), graph.wall.tolist(), strict=True):
        around.sort()
        count = len(around)
        for i in range(count - 1 if wall >= 0 else count):
            (way, out), (after, arriving) = around[i], around[(i + 1) % count]
            angle = after - way if i + 1 < count else after - way + quarters
            follow[arriving ^ 1] = (out, angle)
    return follow


def _face(follow: dict[int, tuple[int, int]], start: int, seen: list[bool]) -> Face:
    """Return the face on the left of a half-edge."""
    sides: list[list[int]] = [[]]
    at = start
    while not seen[at]:
        seen[at] = True
        sides[-1].append(at)
        if at not in follow:
            raise SolverError("a face of the lines of the map is not closed")
        at, angle = follow[at]
        if angle == 1:
            sides.append([])
        elif angle != 2:
            raise SolverError(f"lines of the map meet at {90 * angle} degrees in a face")
    if at != start or len(sides) != 5:
        raise SolverError(f"lines of the map enclose a face of {len(sides) - 1} corners")
    sides[0] = sides.pop() + sides[0]
    south, east, north, west = (tuple(side) for side in sides)
    return south, east, north, west
