"""A conforming quad mesh over the rectangles of a seamless map."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, complex_of, pairs_of
from meshonet.geometry.elementary import modulus, times
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import walk_map
from meshonet.solvers.blocking.decomposition.errors import BlockingError
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap
from meshonet.solvers.blocking.decomposition.quads.arc_counts import arc_counts
from meshonet.solvers.blocking.decomposition.quads.motorcycle import motorcycle_graph
from meshonet.solvers.blocking.decomposition.quads.t_mesh import Face, Side, TMesh, t_mesh
from meshonet.solvers.blocking.decomposition.quads.trails import map_tables
from meshonet.solvers.blocking.sizes.size_metric import SizeMetric

SHORTEST = 0.05
"""An arc counts as at least so many cells long."""


def quad_mesh(seamless: SeamlessMap, cells: int = 900, sizes: SizeMetric | None = None) -> QuadMesh:
    """Return a conforming mesh of about so many quads, whose irregular nodes are those of the map.

    With `sizes` its edges are about as long as these say, whatever `cells`.

    Nodes lie where the inverse of the map puts them, so cells are nowhere folded but where they are too large
    to follow it.

    Raises BlockingError: the map's lines make no T-mesh of rectangles, or so few cells cannot conform.
    """
    mesh = t_mesh(motorcycle_graph(seamless))
    wanted = _plane_lengths(mesh, sizes)
    if sizes is None:
        wanted = wanted / np.sqrt(seamless.triangulation.domain.area / cells)
    counts = arc_counts(mesh, np.maximum(wanted, SHORTEST))
    return _checked(_fine(mesh, counts))


def _plane_lengths(mesh: TMesh, sizes: SizeMetric | None = None) -> Floats:
    """Return the lengths (a,) of arcs in the plane, in edges of `sizes` if given."""
    trails = mesh.graph.trails
    steps = modulus(trails.end - trails.begin)
    if sizes is not None:
        middle, step = 0.5 * (trails.end + trails.begin), trails.end - trails.begin
        steps = steps / sizes.length(pairs_of(middle), pairs_of(step))
    before = np.append(0.0, np.cumsum(steps))

    def upto(length: Floats) -> Floats:
        rounds, rest = _within(mesh, mesh.trail, length)
        piece, part = trails.locate(mesh.trail, rest)
        whole = before[trails.first[mesh.trail + 1]] - before[trails.first[mesh.trail]]
        return np.asarray(before[piece] + part * steps[piece] + rounds * whole)

    return upto(mesh.span[:, 1]) - upto(mesh.span[:, 0])


def _within(mesh: TMesh, trail: Indices, length: Floats) -> tuple[Floats, Floats]:
    """Return how often a closed trail has been gone round at a length, and the length on the last round."""
    trails = mesh.graph.trails
    total = trails.length[trails.first[1:] + np.arange(len(trails.loop))][trail]
    rounds = np.where((trails.loop[trail] >= 0) & (length >= total), 1.0, 0.0)
    return rounds, length - rounds * total


@dataclass(frozen=True, eq=False)
class _Nodes:
    """The nodes on arcs: which, and where on their trails."""

    points: Complexes
    """(n,) in the plane."""
    loop: Indices
    arc: Floats
    on: tuple[list[int], ...]
    """By arc its nodes, both ends included."""
    lengths: tuple[Floats, ...]
    """By arc the lengths of its trail at these."""


def _on_arcs(mesh: TMesh, counts: Indices) -> _Nodes:
    """Place the nodes of arcs at equal steps of the map; those of the graph come first."""
    graph, trails = mesh.graph, mesh.graph.trails
    total = len(graph.vertex) + int((counts - 1).sum())
    points, arc = np.zeros(total, dtype=complex), np.zeros(total)
    loop = np.full(total, -1, dtype=np.intp)
    on, lengths = [], []
    new = len(graph.vertex)
    for (a, b), (start, stop), count in zip(
        mesh.nodes.tolist(), mesh.span.tolist(), counts.tolist(), strict=True
    ):
        on.append([a, *range(new, new + count - 1), b])
        lengths.append(np.linspace(start, stop, count + 1))
        new += count - 1
    number = np.concatenate(on)
    trail = np.repeat(mesh.trail, counts + 1)
    _, rest = _within(mesh, trail, np.concatenate(lengths))
    piece, part = trails.locate(trail, rest)
    points[number] = trails.begin[piece] * (1.0 - part) + trails.end[piece] * part
    wall = np.flatnonzero(trails.loop[trail] >= 0)
    number, piece, part = number[wall], piece[wall], part[wall]
    loop[number] = trails.loop[trail[wall]]
    arc[number] = trails.arc[piece, 0] + part * trails.arc[piece, 1]
    for k, curve in enumerate(graph.map.triangulation.domain.loops):
        here = np.flatnonzero(loop == k)
        arc[here] = np.mod(arc[here], curve.length)
        points[here] = complex_of(curve.at(arc[here]))
    return _Nodes(points, loop, arc, tuple(on), tuple(lengths))


def _fine(mesh: TMesh, counts: Indices) -> QuadMesh:
    """Return the mesh of all faces."""
    nodes = _on_arcs(mesh, counts)
    seamless = mesh.graph.map
    walks = _Walks(mesh, nodes, len(nodes.points))
    quads = [walks.lattice(face) for face in mesh.faces]
    points = np.concatenate([nodes.points, walks.run(seamless)])
    inner = Places.inside(walks.next - len(nodes.points))
    fixed = np.zeros(len(nodes.points), dtype=np.intp)
    corners = np.zeros(len(seamless.surface.on_wall), dtype=np.intp)
    corners[: len(seamless.corner_cells)] = seamless.corner_cells
    vertex = mesh.graph.vertex
    fixed[: len(vertex)] = np.where(vertex >= 0, corners[vertex], 0)
    places = Places(
        np.append(nodes.loop, inner.loop),
        np.append(nodes.arc, inner.arc),
        np.append(fixed, inner.cells),
        np.append(np.full(len(fixed), -1, dtype=np.intp), inner.partner),
    )
    return QuadMesh(seamless.triangulation.domain, pairs_of(points), np.concatenate(quads), places)


class _Walks:
    """Lattices of faces, and the walks through the map that find their inner nodes."""

    def __init__(self, mesh: TMesh, nodes: _Nodes, first: int) -> None:
        self.mesh, self.nodes, self.next = mesh, nodes, first
        self._trail: list[Indices] = []
        self._length: list[Floats] = []
        self._turn: list[Indices] = []
        self._targets: list[Complexes] = []

    def lattice(self, face: Face) -> Indices:
        """Return the quads (m, 4) of a face; its inner nodes are numbered, and walks to them are kept."""
        south, u_south = self._side(face[0])
        east, v_east = self._side(face[1])
        north, u_north = self._side(face[2])
        west, v_west = self._side(face[3])
        ni, nj = len(south), len(west)
        grid = np.empty((ni, nj), dtype=np.intp)
        grid[:, 0], grid[:, -1] = south, north[::-1]
        grid[0], grid[-1] = west[::-1], east
        width, height = (u_south[-1] + u_north[-1]) / 2, (v_east[-1] + v_west[-1]) / 2
        s, n = u_south / u_south[-1], 1.0 - u_north[::-1] / u_north[-1]
        w, e = 1.0 - v_west[::-1] / v_west[-1], v_east / v_east[-1]
        if ni > 2 and nj > 2:
            inner = (ni - 2) * (nj - 2)
            grid[1:-1, 1:-1] = np.arange(self.next, self.next + inner).reshape(nj - 2, ni - 2).T
            self.next += inner
            # lines between opposite nodes cross once in a rectangle
            a, b = s[None, 1:-1], (n - s)[None, 1:-1]
            c, d = w[1:-1, None], (e - w)[1:-1, None]
            u = (a + b * c) / (1.0 - b * d)
            v = c + d * u
            self._targets.append(u * width + 1j * (v - c) * height)
            self._start(face[3], nj)
        return np.stack([grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]], axis=-1).reshape(-1, 4)

    def _runs(self, side: Side) -> Iterator[tuple[int, list[int], Floats, int]]:
        """Yield half-edge, nodes and their lengths on its trail along a side, and how many came before."""
        for number, half in enumerate(side):
            way = -1 if half % 2 else 1
            yield half, self.nodes.on[half // 2][::way], self.nodes.lengths[half // 2][::way], min(number, 1)

    def _side(self, side: Side) -> tuple[list[int], Floats]:
        """Return the nodes along a side, and how far along it they are in the map."""
        nodes: list[int] = []
        along: list[Floats] = []
        before = 0.0
        for _, on, length, skip in self._runs(side):
            step = np.abs(length - length[0])
            nodes += on[skip:]
            along.append(before + step[skip:])
            before += float(step[-1])
        return nodes, np.concatenate(along)

    def _start(self, west: Side, count: int) -> None:
        """Start a walk at each inner node of the west side, from the south on."""
        runs, inner = list(self._runs(west)), slice(count - 2, 0, -1)
        many = [len(length) - skip for _, _, length, skip in runs]
        half = np.repeat([half for half, *_ in runs], many)[inner]
        self._trail.append(self.mesh.trail[half // 2])
        self._length.append(np.concatenate([length[skip:] for _, _, length, skip in runs])[inner])
        self._turn.append(1 + 2 * (half % 2))

    def run(self, seamless: SeamlessMap) -> Complexes:
        """Return the inner nodes in the plane."""
        if not self._targets:
            return np.zeros(0, dtype=complex)
        trails = self.mesh.graph.trails
        trail = np.concatenate(self._trail)
        _, rest = _within(self.mesh, trail, np.concatenate(self._length))
        piece, part = trails.locate(trail, rest)
        corners = seamless.corner_coords[trails.face[piece]]
        step = trails.length[piece + trail + 1] - trails.length[piece + trail]
        direction = np.array([1, 1j, -1, -1j])
        origin = trails.origin[piece] + part * step * direction[trails.axis[piece]]
        east = direction[(trails.axis[piece] + np.concatenate(self._turn)) % 4]
        sizes = np.repeat(
            [block.shape[1] for block in self._targets], [len(block) for block in self._targets]
        )
        flat = np.concatenate([block.ravel() for block in self._targets])
        targets = np.repeat(origin, sizes) + times(flat, np.repeat(east, sizes))
        reached = walk_map(
            map_tables(seamless),
            np.ascontiguousarray(seamless.triangulation.triangles, dtype=np.intp),
            np.ascontiguousarray(seamless.triangulation.points),
            np.ascontiguousarray(trails.face[piece]),
            np.ascontiguousarray(origin).view(np.float64).reshape(-1, 2),
            np.append(0, np.cumsum(sizes)).astype(np.intp),
            targets.view(np.float64).reshape(-1, 2),
            10 * len(corners) + len(seamless.surface.vertices),
        )
        return complex_of(reached)


def _checked(mesh: QuadMesh) -> QuadMesh:
    """Return the mesh if it conforms and has the domain's topology, with walls where places say so."""
    shared = np.bincount(mesh.edge_of.ravel(), minlength=len(mesh.edges))
    ordered = np.sort(mesh.quads, axis=1)
    whole = not np.any(ordered[:, 1:] == ordered[:, :-1]) and int(shared.max()) <= 2
    euler = len(mesh.nodes) - len(mesh.edges) + len(mesh.quads)
    wall = np.array_equal(mesh.wall_nodes, mesh.places.loop >= 0)
    twice = np.bincount(mesh.edges[mesh.on_wall].ravel(), minlength=len(mesh.nodes)) <= 2
    if not (whole and wall and bool(twice.all()) and euler == 2 - len(mesh.domain.loops)):
        raise BlockingError("the quads do not conform: too few cells for the narrow parts of the domain")
    return mesh
