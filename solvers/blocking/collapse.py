"""Chords of blocks taken out of a quad mesh, as long as its score falls.

A chord is a row of blocks from wall to wall, or a ring of them. Contracting all edges across it removes the row:
the nodes on both sides of it become one. What is left is a quad mesh with fewer blocks, often with the same
irregular nodes or fewer, now closer to each other.

Borden, Benzley, Shepherd, "Hexahedral sheet extraction", 11th International Meshing Roundtable (2002);
Daniels, Silva, Shepherd, Cohen, "Quadrilateral mesh simplification", ACM Trans. Graph. 27 (2008).
"""

from __future__ import annotations

import numpy as np
from meshonet.solvers.energy.quads import optimise
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.kernels._native import joined_classes
from meshonet.solvers.blocking.base_complex import BaseComplex, base_complex
from meshonet.solvers.blocking.errors import BlockingError
from meshonet.solvers.blocking.padding import wrong_count
from meshonet.solvers.blocking.score import PRICE, score

FAILURES = 8
"""Trials without gain, one after another, after which the mesh stays as it is."""

ITERATIONS = 40
"""Iterations of the functional before a trial is judged."""

VALENCES = (3, 5)
"""Fewest and most quads around a node inside."""


def simplify(mesh: QuadMesh, *, price: float = PRICE, iterations: int = ITERATIONS) -> BaseComplex:
    """Return the blocks of an optimised quad mesh after collapsing chords, the narrowest first.

    `price` is what a block costs, in degrees of mean deviation from 90.
    """
    current = base_complex(mesh)
    best = score(mesh, len(current.blocks), price)
    while True:
        better = _first_gain(current, best, price, iterations)
        if better is None:
            return current
        current, best = better


def _first_gain(
    current: BaseComplex, best: float, price: float, iterations: int
) -> tuple[BaseComplex, float] | None:
    """Return the first collapse, and its score, that lowers `best`; None after `FAILURES`."""
    failures = 0
    for chord in np.argsort(widths(current), kind="stable").tolist():
        trial = _collapsed(current, chord)
        if trial is None:
            continue
        optimum = optimise(trial.mesh, iterations=iterations)
        if optimum.valid:
            value = score(optimum.mesh, len(trial.blocks), price)
            if value < best:
                return base_complex(optimum.mesh), value
        failures += 1
        if failures >= FAILURES:
            return None
    return None


def _collapsed(current: BaseComplex, chord: int) -> BaseComplex | None:
    """Return the mesh without a chord, None where that is not allowed or simplifies nothing."""
    mesh = current.mesh
    trial = contract(mesh, current.chord == chord)
    if trial is None or np.count_nonzero(wrong_count(trial)) > np.count_nonzero(wrong_count(mesh)):
        return None
    try:
        blocks = base_complex(trial)
    except BlockingError:
        return None
    fewer = _irregular_inside(trial) < _irregular_inside(mesh)
    return blocks if fewer or len(blocks.blocks) < len(current.blocks) else None


def _irregular_inside(mesh: QuadMesh) -> int:
    return int(np.count_nonzero(mesh.irregular & ~mesh.wall_nodes))


def widths(current: BaseComplex) -> Floats:
    """Return how wide each chord (chords,) is: the mean length of edges across it, all rows added up."""
    mesh = current.mesh
    step = mesh.nodes[mesh.edges[:, 1]] - mesh.nodes[mesh.edges[:, 0]]
    edges = np.bincount(current.chord, minlength=current.chords)
    mean = np.bincount(current.chord, np.hypot(*step.T), minlength=current.chords) / edges
    rows = np.zeros(current.chords)
    seen = np.zeros(current.chords, dtype=bool)
    for block in current.blocks:
        for line in (block[:, 0], block[0]):
            chord = current.chord[_edge_between(mesh, line[0], line[1])]
            if not seen[chord]:
                seen[chord], rows[chord] = True, len(line) - 1
    return np.asarray(mean * rows)


def _edge_between(mesh: QuadMesh, a: int, b: int) -> int:
    keys = mesh.edges[:, 0] * len(mesh.nodes) + mesh.edges[:, 1]
    return int(np.searchsorted(keys, min(a, b) * len(mesh.nodes) + max(a, b)))


def contract(mesh: QuadMesh, rungs: NDArray[np.bool_]) -> QuadMesh | None:
    """Return the mesh with the nodes of each edge in `rungs` (e,) made one; None where it would be invalid.

    That is where two corners would become one, wall nodes that no wall edges in `rungs` join, or where what
    is left is no conforming mesh of the same domain with 3 to 5 quads around each node inside.
    """
    pairs = np.ascontiguousarray(mesh.edges[rungs])
    label, count = joined_classes(pairs, len(mesh.nodes))
    merged = _merged_places(mesh, label, count, pairs[mesh.on_wall[rungs]])
    kept = ~rungs[mesh.edge_of].any(axis=1)
    if merged is None or not kept.any():
        return None
    places, nodes = merged
    trial = QuadMesh(mesh.domain, nodes, label[mesh.quads[kept]], places)
    return trial if is_conforming(trial) else None


def _merged_places(
    mesh: QuadMesh, label: Indices, count: int, wall_rungs: Indices
) -> tuple[Places, Floats] | None:
    """Return places and nodes (count, 2) of classes of nodes: the corner's, on the wall in the middle, the mean."""
    places, size = mesh.places, np.bincount(label, minlength=count)
    corners, wall = np.flatnonzero(places.cells > 0), np.flatnonzero(places.loop >= 0)
    of_wall = np.bincount(label[wall], minlength=count)
    links = np.bincount(label[wall_rungs[:, 0]], minlength=count)
    if (np.bincount(label[corners], minlength=count) > 1).any() or (
        (of_wall > 1) & (links != of_wall - 1)
    ).any():
        return None
    loop, arc, cells = np.full(count, -1), np.zeros(count), np.zeros(count, dtype=np.intp)
    loop[label[wall]] = places.loop[wall]
    first = np.zeros(count)
    first[label[wall[::-1]]] = places.arc[wall[::-1]]
    length = np.array([one.length for one in mesh.domain.loops])[places.loop[wall]]
    off = np.mod(places.arc[wall] - first[label[wall]] + 0.5 * length, length) - 0.5 * length
    arc = first + np.bincount(label[wall], off, minlength=count) / np.maximum(of_wall, 1)
    nodes = np.stack([np.bincount(label, axis, minlength=count) / size for axis in mesh.nodes.T], axis=1)
    nodes[label[wall]] = mesh.nodes[wall]
    for number, one in enumerate(mesh.domain.loops):
        moved = np.flatnonzero((loop == number) & (of_wall > 1))
        arc[loop == number] %= one.length
        nodes[moved] = one.at(arc[moved])
    loop[label[corners]], arc[label[corners]] = places.loop[corners], places.arc[corners]
    cells[label[corners]], nodes[label[corners]] = places.cells[corners], mesh.nodes[corners]
    return Places(loop, arc, cells, np.full(count, -1)), nodes


def is_conforming(mesh: QuadMesh) -> bool:
    """Return whether the quads are a mesh of the domain: manifold, its holes kept, wall nodes where they should be.

    Nodes inside have as many quads as `VALENCES` allow.
    """
    quads, n = mesh.quads, len(mesh.nodes)
    if not mesh.manifold or n - len(mesh.edges) + len(quads) != 2 - len(mesh.domain.loops):
        return False
    repeated = [(quads == np.roll(quads, k, axis=1)).any() for k in (1, 2)]
    wall = mesh.wall_nodes
    if any(repeated) or not np.array_equal(wall, mesh.places.loop >= 0):
        return False
    around = np.bincount(mesh.edges[mesh.on_wall].ravel(), minlength=n)
    inside = mesh.valence[~wall]
    fits = not inside.size or (inside.min() >= VALENCES[0] and inside.max() <= VALENCES[1])
    return bool((around[wall] == 2).all() and fits)
