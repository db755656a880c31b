"""A conforming quad mesh on the rectangles of a seamless map."""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices, complex_of, pairs_of
from meshonet.geometry.elementary import modulus
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.solvers.algebraic.tfi import between
from meshonet.solvers.blocking.decomposition.field.seamless_map import SeamlessMap
from meshonet.solvers.blocking.decomposition.quads.motorcycle import motorcycle_graph
from meshonet.solvers.blocking.decomposition.quads.t_mesh import Face, Side, TMesh, t_mesh
from meshonet.solvers.refinement.size_metric import SizeMetric
from meshonet.solvers.whole_numbers import difference, whole_numbers

SHORTEST = 0.05  # smallest target number of cells of an arc
LOOP = 4  # smallest number of cells along a closed wall


def quad_mesh(seamless: SeamlessMap, cells: int = 900, sizes: SizeMetric | None = None) -> QuadMesh:
    """Return a conforming mesh of about `cells` quads, whose edges follow coordinate lines of the map.

    If `sizes` (target edge lengths) are given, `cells` is ignored. Cells may be folded.

    Raises SolverError if the lines of the map do not bound rectangles, or if `cells` are too few.
    """
    mesh = t_mesh(motorcycle_graph(seamless))
    wanted = _plane_lengths(mesh, sizes)
    if sizes is None:
        wanted = wanted / np.sqrt(seamless.surface.domain.area / cells)
    counts = _arc_counts(mesh, np.maximum(wanted, SHORTEST))
    quads = _fine(mesh, counts)
    if not conforms(quads):
        raise SolverError("the quads do not conform: too few cells for the narrow parts of the domain")
    return quads


def _plane_lengths(mesh: TMesh, sizes: SizeMetric | None = None) -> Floats:
    """Return the lengths (a,) of arcs in the plane, in the domain's unit or in edges of `sizes`."""
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


def _arc_counts(mesh: TMesh, wanted: Floats) -> Indices:
    """Return numbers of cells (a,) along arcs, at least 1 and near `wanted` (a,), equal on opposite sides.

    Campen, Bommes, Kobbelt, ACM Trans. Graph. 34 (2015) 192; Lyon, Campen, Bommes, Kobbelt, Comput. Graph.
    Forum 38 (2019) 21-32.
    """
    sides = [[[half // 2 for half in side] for side in face] for face in mesh.faces]
    rows = [difference(face[k], face[k + 2]) for face in sides for k in (0, 1)]
    for trail in sorted(set(mesh.trail[mesh.on_wall >= 0].tolist())):
        rows.append((dict.fromkeys(np.flatnonzero(mesh.trail == trail).tolist(), 1.0), LOOP, np.inf))
    return whole_numbers(wanted, np.ones(len(wanted)), [row for row in rows if row[0]])


def _within(mesh: TMesh, trail: Indices, length: Floats) -> tuple[Floats, Floats]:
    """Return the whole rounds of a closed trail at a length, and the length beyond them."""
    trails = mesh.graph.trails
    total = trails.length[trails.first[1:] + np.arange(len(trails.loop))][trail]
    rounds = np.where((trails.loop[trail] >= 0) & (length >= total), 1.0, 0.0)
    return rounds, length - rounds * total


@dataclass(frozen=True, eq=False)
class _Nodes:
    """The nodes on arcs of a T-mesh."""

    points: Complexes  # (n,) in the plane
    loop: Indices
    arc: Floats
    on: tuple[list[int], ...]  # the nodes of each arc, both ends included


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
    domain = graph.map.surface.domain
    along = trails.arc[piece, 0] + part * trails.arc[piece, 1]
    arc[number] = np.mod(along, domain.lengths[loop[number]])
    points[number] = complex_of(domain.at(loop[number], arc[number]))
    return _Nodes(points, loop, arc, tuple(on))


def _fine(mesh: TMesh, counts: Indices) -> QuadMesh:
    """Return the mesh of all faces, with inner nodes interpolated between the sides."""
    nodes, vertex, seamless = _on_arcs(mesh, counts), mesh.graph.vertex, mesh.graph.map
    lattices, points, count = [], [pairs_of(nodes.points)], len(nodes.points)
    for face in mesh.faces:
        lattice, inner = _lattice(nodes, face, count)
        lattices.append(lattice)
        points.append(inner)
        count += len(inner)
    places = Places.inside(count)
    places.loop[: len(nodes.loop)], places.arc[: len(nodes.arc)] = nodes.loop, nodes.arc
    corner = np.flatnonzero((vertex >= 0) & (vertex < len(seamless.corner_cells)))
    places.cells[corner] = seamless.corner_cells[vertex[corner]]
    return QuadMesh(seamless.surface.domain, np.concatenate(points), lattice_quads(lattices), places)


def _lattice(nodes: _Nodes, face: Face, first: int) -> tuple[Indices, Floats]:
    """Return the lattice (ni, nj) of a face, and its inner nodes (k, 2), numbered from `first` on."""
    south, east, north, west = (np.array(_along(nodes, side), dtype=np.intp) for side in face)
    grid = np.empty((len(south), len(west)), dtype=np.intp)
    grid[:, 0], grid[:, -1], grid[0], grid[-1] = south, north[::-1], west[::-1], east
    inner = grid[1:-1, 1:-1]
    inner[...] = first + np.arange(inner.size).reshape(inner.shape)
    if not inner.size:
        return grid, np.empty((0, 2))
    lines = [pairs_of(nodes.points[line]) for line in (grid[:, 0], grid[:, -1], grid[0], grid[-1])]
    return grid, between((lines[0], lines[1], lines[2], lines[3]))[1:-1, 1:-1].reshape(-1, 2)


def _along(nodes: _Nodes, side: Side) -> list[int]:
    """Return the nodes along a side of a face, both ends included."""
    runs = [nodes.on[half // 2][:: -1 if half % 2 else 1] for half in side]
    return [runs[0][0], *(node for run in runs for node in run[1:])]


def conforms(mesh: QuadMesh) -> bool:
    """Return whether the mesh is manifold, has its domain's holes, and has boundary nodes only on walls."""
    quads, wall = mesh.quads, mesh.wall_nodes
    euler = len(wall) - len(mesh.edges) + len(quads)
    repeated = any((quads == np.roll(quads, k, axis=1)).any() for k in (1, 2))
    if repeated or not mesh.manifold or euler != 2 - len(mesh.domain.loops):
        return False
    around = np.bincount(mesh.edges[mesh.on_wall].ravel(), minlength=len(wall))
    return np.array_equal(wall, mesh.places.loop >= 0) and bool((around[wall] == 2).all())
