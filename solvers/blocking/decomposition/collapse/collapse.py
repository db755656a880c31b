"""Collapses chords of a quad mesh as long as its score decreases.

A chord is a row of blocks from wall to wall, or a closed row. Contracting all edges across it removes the
row: the nodes on both of its sides are merged. The result is a quad mesh with fewer blocks, and usually no
more irregular nodes.

Borden, Benzley, Shepherd, "Hexahedral sheet extraction", 11th International Meshing Roundtable (2002);
Daniels, Silva, Shepherd, Cohen, "Quadrilateral mesh simplification", ACM Trans. Graph. 27 (2008).
"""

from collections.abc import Collection

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import SolverError
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.ties import ascending, less
from meshonet.solvers.blocking.decomposition.collapse.base_complex import BaseComplex, base_complex
from meshonet.solvers.blocking.decomposition.collapse.contract import contract
from meshonet.solvers.blocking.decomposition.collapse.score import score
from meshonet.solvers.blocking.decomposition.side_counts import check_sides
from meshonet.solvers.energy.quads import optimise
from meshonet.solvers.refinement.size_metric import SizeMetric

FAILURES = 8
"""Number of consecutive attempts without improvement after which the collapse ends."""

PER_CHORD = 14
"""One more chord is collapsed at a time for each this many chords."""
ITERATIONS = 12
"""Iterations of the optimisation before a trial is judged."""

MOST_WORK = 45_000_000
"""Number of quads times iterations after which the collapse ends; this takes some seconds."""
PER_TRIAL, PER_OPTIMUM = 3, 20
"""Cost of a trial before its optimisation, and of an optimisation besides its iterations, in iterations."""


def simplify(mesh: QuadMesh, *, price: float, sizes: SizeMetric | None) -> BaseComplex:
    """Return the blocks of an optimised quad mesh after collapsing chords (rows of blocks), narrowest first.

    `sizes` are prescribed lengths of edges. `price` is how much the mean deviation of angles from 90 degrees
    (in degrees) may grow for each block that is removed.
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
    """Return the number of interior nodes at which other than four quads meet."""
    return int(np.count_nonzero(mesh.irregular & ~mesh.wall_nodes))


def widths(current: BaseComplex) -> Floats:
    """Return the width of each chord (chords,): the mean length of the sides of blocks across it."""
    chord = current.sides[2]
    edges = np.bincount(chord, minlength=current.chords)
    return np.bincount(chord, current.side_lengths().ravel(), current.chords) / edges
