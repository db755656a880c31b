"""Collapses chords of a quad mesh as long as its score decreases.

A chord is a row of blocks from wall to wall, or a closed row. Contracting all edges across it removes the
row: the nodes on both of its sides are merged. The result is a quad mesh with fewer blocks, and usually no
more irregular nodes.

Borden, Benzley, Shepherd, "Hexahedral sheet extraction", 11th International Meshing Roundtable (2002);
Daniels, Silva, Shepherd, Cohen, "Quadrilateral mesh simplification", ACM Trans. Graph. 27 (2008).
"""

from collections.abc import Collection

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Indices, distinct, shortest_ways
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.ties import ascending, less
from meshonet.kernels._native import joined_classes
from meshonet.solvers.blocking.decomposition.collapse.base_complex import BaseComplex, base_complex
from meshonet.solvers.blocking.decomposition.collapse.score import score
from meshonet.solvers.blocking.decomposition.quads.padding import wrong_count
from meshonet.solvers.blocking.decomposition.quads.quad_mesh import conforms
from meshonet.solvers.blocking.decomposition.side_counts import check_sides
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.refinement.size_metric import SizeMetric

VALENCES = (3, 5)  # smallest and largest number of quads around an interior node
FAILURES = 8  # number of consecutive attempts without improvement after which the collapse ends

PER_CHORD = 14  # one more chord is collapsed at a time for each this many chords
ITERATIONS = 12  # iterations of the optimisation before a trial is judged

MOST_WORK = 45_000_000
"""Number of quads times iterations after which the collapse ends; this takes some seconds."""
PER_TRIAL, PER_OPTIMUM = 3, 20
"""Cost of a trial before its optimisation, and of an optimisation besides its iterations, in iterations."""


def simplify(mesh: QuadMesh, *, price: float, sizes: SizeMetric | None) -> BaseComplex:
    """Return the blocks of an optimised quad mesh from which needless rows of blocks are removed.

    For each removed block, the mean deviation of angles from 90 degrees may grow by `price` degrees. `sizes`
    are target edge lengths.
    """

    def wanted(mesh: QuadMesh) -> Floats | None:
        return sizes.edges(mesh) if sizes else None

    current, left, count = base_complex(mesh), float(MOST_WORK), 1
    best, failed = score(current, price, wanted(mesh)), set[int]()
    while len(failed) < FAILURES and left > 0.0:
        trial, first, tried = _without(current, failed, count)
        left -= PER_TRIAL * tried * len(current.mesh.quads)
        if trial is None:
            break
        left -= (PER_OPTIMUM + ITERATIONS) * len(trial.mesh.quads)
        optimum = optimise(trial.mesh, iterations=ITERATIONS, targets=wanted(trial.mesh))
        trial = trial.moved(optimum.mesh)
        value = score(trial, price, wanted(trial.mesh)) if optimum.valid else np.inf
        if less(value, best):
            current, best, failed = trial, value, set()
            count = min(2 * count, 1 + trial.chords // PER_CHORD)
        else:
            failed |= {first} if count == 1 else set()
            count = 1
    return current


def _without(current: BaseComplex, kept: Collection[int], count: int) -> tuple[BaseComplex | None, int, int]:
    """Return the blocks without the narrowest chords not in `kept`, or None; the first chord; all tries."""
    trial, first, tried = None, -1, 0
    for _ in range(count):
        for chord in ascending(widths(trial or current)).tolist():
            if trial is None and chord in kept:
                continue
            tried += 1
            collapsed = _collapsed(trial or current, chord)
            if collapsed is not None:
                trial, first = collapsed, chord if trial is None else first
                break
        else:
            break
    return trial, first, tried


def _collapsed(current: BaseComplex, chord: int) -> BaseComplex | None:
    """Return the blocks without a chord; None if periodic sides would not match or no block vanishes."""
    mesh = current.mesh
    trial = contract(mesh, current.chord == chord)
    if trial is None:
        return None
    try:
        blocks = base_complex(trial)
        check_sides(blocks.layout)
    except SolverError:
        return None
    fewer = irregular_inside(trial) < irregular_inside(mesh)
    return blocks if fewer or len(blocks.blocks) < len(current.blocks) else None


def irregular_inside(mesh: QuadMesh) -> int:
    """Return the number of interior nodes at which more or fewer than four quads meet."""
    return int(np.count_nonzero(mesh.irregular & ~mesh.wall_nodes))


def widths(current: BaseComplex) -> Floats:
    """Return widths (chords,) of chords (rows of blocks): the mean lengths of the sides between blocks."""
    chord = current.sides[2]
    edges = np.bincount(chord, minlength=current.chords)
    return np.bincount(chord, current.side_lengths().ravel(), current.chords) / edges


def contract(mesh: QuadMesh, rungs: Bools) -> QuadMesh | None:
    """Return the mesh with both ends of each edge in the mask `rungs` (e,) merged; None if that is invalid.

    Merged nodes move to the corner of the domain among them, or else to the mean arc length of wall nodes
    among them, or else to their mean position. Two corners cannot be merged, nor two wall nodes without a
    wall edge in `rungs` between them. The result must satisfy `is_conforming`, and have no more wall nodes
    with a wrong number of quads (`wrong_count`) than before.
    """
    label, count = joined_classes(np.ascontiguousarray(mesh.edges[rungs]), len(mesh.nodes))
    kept = ~rungs[mesh.edge_of].any(axis=1)
    if not kept.any() or not _may_join(mesh, label, count, rungs):
        return None
    places = Places.inside(count)
    wall, corners = np.flatnonzero(mesh.places.loop >= 0), np.flatnonzero(mesh.places.cells > 0)
    places.loop[label[wall]] = mesh.places.loop[wall]
    places.cells[label[corners]] = mesh.places.cells[corners]
    trial = QuadMesh(mesh.domain, np.zeros((count, 2)), label[mesh.quads[kept]], places)
    more = np.count_nonzero(wrong_count(trial)) > np.count_nonzero(wrong_count(mesh))
    return _placed(trial, mesh, label) if not more and is_conforming(trial) else None


def _may_join(mesh: QuadMesh, label: Indices, count: int, rungs: Bools) -> bool:
    """Return whether each class has at most one corner, and wall nodes only if the wall joins them."""
    corners, wall = np.flatnonzero(mesh.places.cells > 0), np.flatnonzero(mesh.places.loop >= 0)
    if len(distinct(label[corners])) < len(corners):
        return False
    of_wall = np.bincount(label[wall], minlength=count)
    walls = rungs & mesh.on_wall & (mesh.places.loop[mesh.edges] >= 0).all(axis=1)
    links = np.bincount(label[mesh.edges[walls, 0]], minlength=count)
    return not ((of_wall > 1) & (links != of_wall - 1)).any()


def _placed(trial: QuadMesh, mesh: QuadMesh, label: Indices) -> QuadMesh:
    """Return `trial` with its nodes, classes of those of `mesh`, in their places."""
    places, count = mesh.places, len(trial.nodes)
    corners, wall = np.flatnonzero(places.cells > 0), np.flatnonzero(places.loop >= 0)
    of, loop, cells = label[wall], trial.places.loop, trial.places.cells
    members = np.bincount(of, minlength=count)
    first, arc = np.zeros(count), np.zeros(count)
    first[of[::-1]] = places.arc[wall[::-1]]
    length = mesh.domain.lengths[places.loop[wall]]
    off = shortest_ways(places.arc[wall] - first[of], length)
    mean = first + np.bincount(of, off, minlength=count) / np.maximum(members, 1)
    arc[of] = np.mod(mean[of], length)
    size = np.bincount(label, minlength=count)
    nodes = np.stack([np.bincount(label, axis, minlength=count) / size for axis in mesh.nodes.T], axis=1)
    nodes[of] = mesh.nodes[wall]
    merged = np.flatnonzero(members > 1)
    nodes[merged] = mesh.domain.at(loop[merged], arc[merged])
    arc[label[corners]], nodes[label[corners]] = places.arc[corners], mesh.nodes[corners]
    return trial.with_places(nodes, Places(loop, arc, cells, trial.places.partner))


def is_conforming(mesh: QuadMesh, many: int = 0) -> bool:
    """Return whether a mesh fits its domain (`conforms`), with 3 to max(5, `many`) quads at inner nodes."""
    inside = mesh.valence[~mesh.wall_nodes]
    few, many = VALENCES[0], max(VALENCES[1], many)
    return conforms(mesh) and bool(((inside >= few) & (inside <= many)).all())
