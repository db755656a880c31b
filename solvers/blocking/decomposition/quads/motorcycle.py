"""The motorcycle graph of a seamless map: rays from its singular vertices and corners along coordinate lines.

Each ray advances at unit speed until it meets the trace of another ray, a wall or a node. In a seamless map
every ray is a straight line, and intersections are comparisons of numbers. Because each ray ends at its first
intersection, the graph is finite even if coordinate lines are not (Eppstein, Goodrich, Kim, Tamstorf, Comput.
Graph. Forum 27 (2008) 1477-1486; on seamless maps Myles, Pietroni, Zorin, ACM Trans. Graph. 33 (2014) 135).
"""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.errors import SolverError
from meshonet.kernels._native import joined_classes, probe_rays, trace_rays
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap
from meshonet.solvers.blocking.decomposition.quads.ports import Ports, ports_of
from meshonet.solvers.blocking.decomposition.quads.trails import Trails, map_tables, ray_trails, wall_trails

NEAR = 1e-6  # distance relative to an edge within which a ray meets a node, as in domains with right angles
PROBED = 1500  # number of triangles through which a ray is followed to test whether it meets a node

CANCELLED, AT_NODE, AT_RAY, AT_WALL, TOO_LONG = range(5)  # how rays end, as in kernels/motorcycle


Station = tuple[float, int, int, int]
"""Length on a trail, the node there, and the directions at which the trail arrives and leaves, or -1."""


@dataclass(frozen=True, eq=False)
class MotorcycleGraph:
    """Lines that divide a domain into regions. Each has constant u or v in a map of the domain.

    Each starts at a singular point of the map or at a wall. It ends where it first meets a line or a wall.
    """

    map: SeamlessMap
    vertex: Indices  # (n,) vertex of the triangulation at each node, -1 if a ray ended elsewhere
    quarters: Indices  # (n,) number of right angles around each node in the map
    wall: Indices  # (n,) number of the trail of the node's wall, -1 inside
    trails: Trails  # the rays, then the walls
    stations: tuple[tuple[Station, ...], ...]
    """For each trail the nodes on it, in its direction. Trails of walls are closed."""


@dataclass(frozen=True, eq=False)
class _Traced:
    ports: Ports
    ends: Indices  # (r, 3) kind, other, place of ``kernels/motorcycle/trace.h``
    at: Floats  # (r, 2) length of the other, own length
    pieces: Indices
    lines: Floats


def motorcycle_graph(seamless: SeamlessMap) -> MotorcycleGraph:
    """Return the lines from singular points of a map (motorcycle graph), and lines that connect all walls.

    Raises SolverError if a line does not end, or if a wall cannot be connected to the others.
    """
    walls = wall_trails(seamless)
    joined: list[int] = []
    for attempt in range(4 * len(walls.first) - 2):
        traced = _trace(seamless, np.asarray(joined, dtype=np.intp))
        graph = _graph(seamless, traced, walls)
        lone = _not_joined(graph, len(traced.ends))
        if lone < 0:
            return graph
        joined.append(_free_vertex(walls, lone, graph.vertex, 7 * attempt))
    raise SolverError(f"{len(walls.first) - 1} walls of the domain could not be joined by lines of the map")


def _trace(seamless: SeamlessMap, joined: Indices) -> _Traced:
    """Return the traced rays; those that meet nodes, one of each pair, are first, those of `joined` last."""
    ports = ports_of(seamless, joined)
    tables = map_tables(seamless)
    count, most = len(ports.vertex), max(int(ports.quarters.max(initial=1)), 2)
    common = (tables, ports.node, ports.port, count, most, NEAR)
    starts = ports.starts
    met = probe_rays(*common, starts, PROBED)
    chosen: set[tuple[int, int]] = set()
    for ray, key in zip(starts.tolist(), met.tolist(), strict=True):
        if key[0] >= 0 and tuple(key) not in chosen:
            chosen.add((ray[0], ray[1]))
    for ray in starts:
        late = ray[0] >= count - len(joined)
        ray[5] = 2 if late else int((int(ray[0]), int(ray[1])) not in chosen)
    room, rays_traced = 40 * len(seamless.surface.triangles) + 1000, None
    while rays_traced is None:
        rays_traced = trace_rays(*common, starts, 4 * len(seamless.surface.triangles), room)
        room *= 4
    if np.any(rays_traced[0][:, 0] == TOO_LONG):
        raise SolverError("a line of the map does not end")
    return _Traced(ports, *rays_traced)


def _graph(seamless: SeamlessMap, traced: _Traced, walls: Trails) -> MotorcycleGraph:
    """Return the graph: nodes where rays ended are numbered after those where they start."""
    ports, kinds = traced.ports, traced.ends[:, 0]
    rays = len(kinds)
    old = len(ports.vertex)
    ended = np.flatnonzero((kinds == AT_RAY) | (kinds == AT_WALL))
    number = np.full(rays, -1, dtype=np.intp)
    number[ended] = old + np.arange(len(ended))
    at_wall = ended[kinds[ended] == AT_WALL]
    vertex = np.append(ports.vertex, np.full(len(ended), -1, dtype=np.intp))
    quarters = np.append(ports.quarters, np.where(kinds[ended] == AT_WALL, 2, 4))
    wall = np.full(len(vertex), -1, dtype=np.intp)
    stations: list[list[Station]] = [[] for _ in range(rays + len(walls.first) - 1)]
    for node in np.flatnonzero(ports.on_wall).tolist():
        trail, length = walls.at_vertex(int(vertex[node]))
        wall[node] = rays + trail
        stations[rays + trail].append((length, node, int(quarters[node]), 0))
    sides = traced.ends[at_wall, 1:]
    for node, place, part in zip(
        number[at_wall].tolist(), sides.tolist(), traced.at[at_wall, 0], strict=True
    ):
        trail, length = walls.at_edge(place[0], place[1], float(part))
        wall[node] = rays + trail
        stations[rays + trail].append((length, node, 2, 0))
    _along_rays(stations, traced, number)
    trails = ray_trails(seamless, traced.pieces, traced.lines, rays).joined(walls)
    ordered = tuple(tuple(sorted(some)) for some in stations)
    return MotorcycleGraph(seamless, vertex, quarters, wall, trails, ordered)


def _along_rays(stations: list[list[Station]], traced: _Traced, number: Indices) -> None:
    """Add the nodes on each ray: its start, its end, and the ends of other rays on it."""
    for ray, (end, at) in enumerate(zip(traced.ends.tolist(), traced.at.tolist(), strict=True)):
        kind, crossed, place = end
        if kind == CANCELLED:
            continue
        node, port = traced.ports.starts[ray, :2].tolist()
        stations[ray].append((0.0, node, -1, port))
        if kind == AT_NODE:
            stations[ray].append((at[1], crossed, place, -1))
        elif kind == AT_WALL:
            stations[ray].append((at[1], int(number[ray]), 1, -1))
        else:
            stations[ray].append((at[1], int(number[ray]), place, -1))
            stations[crossed].append((at[0], int(number[ray]), 2, 0))


def _not_joined(graph: MotorcycleGraph, rays: int) -> int:
    """Return the first wall without a node or a connection to the first wall; -1 if there is none."""
    walls = len(graph.stations) - rays
    pairs = [
        (walls + station[1], trail - rays if trail >= rays else walls + stations[0][1])
        for trail, stations in enumerate(graph.stations)
        for station in stations
    ]
    label, _ = joined_classes(np.array(pairs, dtype=np.intp).reshape(-1, 2), len(graph.vertex) + walls)
    apart = np.flatnonzero(label[:walls] != label[0]).tolist()
    bare = [wall for wall in range(walls) if not graph.stations[rays + wall]]
    return (apart or bare or [-1])[0] if walls > 1 or bare else -1


def _free_vertex(walls: Trails, wall: int, taken: Indices, attempt: int) -> int:
    """Return a vertex of a wall without a node."""
    pieces = slice(int(walls.first[wall]), int(walls.first[wall + 1]))
    vertices = walls.vertex[pieces]
    free = vertices[~np.isin(vertices, taken)]
    if not len(free):
        raise SolverError(f"wall {wall} has no free vertex to join it to the others from")
    return int(free[attempt % len(free)])
