"""Chords of blocks taken out of a quad mesh, as long as its score falls.

A chord is a row of blocks from wall to wall, or a ring of them. Contracting all edges across it removes the
row: the nodes on both sides of it become one. What is left is a quad mesh with fewer blocks and often as many
irregular nodes or fewer.

Borden, Benzley, Shepherd, "Hexahedral sheet extraction", 11th International Meshing Roundtable (2002);
Daniels, Silva, Shepherd, Cohen, "Quadrilateral mesh simplification", ACM Trans. Graph. 27 (2008).
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.ties import ascending, less
from meshonet.solvers.blocking.decomposition.collapse.base_complex import BaseComplex, base_complex
from meshonet.solvers.blocking.decomposition.collapse.contract import contract
from meshonet.solvers.blocking.decomposition.collapse.score import PRICE, score
from meshonet.solvers.blocking.decomposition.errors import BlockingError
from meshonet.solvers.blocking.sizes.size_metric import SizeMetric
from meshonet.solvers.energy.quads import optimise

FAILURES = 8
"""Trials without gain, one after another, after which the mesh stays as it is."""

ITERATIONS = (6, 12, 22)
"""Iterations of the functional before a trial is judged, and further ones before it is judged again."""

MOST_WORK = 45_000_000
"""Quads times iterations, from where on the mesh stays as it is: some seconds."""
PER_TRIAL, PER_OPTIMUM = 3, 20
"""What a trial costs before it is optimised, and an optimum beside its iterations, in iterations."""


def simplify(mesh: QuadMesh, *, price: float = PRICE, sizes: SizeMetric | None = None) -> BaseComplex:
    """Return the blocks of an optimised quad mesh after collapsing chords, the narrowest first.

    `price` is the mean deviation from 90 degrees that a block less may cost; `sizes`, if any, prescribe the
    lengths of edges.
    """

    def wanted(mesh: QuadMesh) -> Floats | None:
        return sizes.edges(mesh) if sizes else None

    def narrowest_last(blocks: BaseComplex) -> list[int]:
        return ascending(widths(blocks))[::-1].tolist()

    current, left, failures = base_complex(mesh), float(MOST_WORK), 0
    best, chords = score(current, price, wanted(mesh)), narrowest_last(current)
    while chords and failures < FAILURES and left > 0.0:
        left -= PER_TRIAL * len(current.mesh.quads)
        trial = _collapsed(current, chords.pop())
        if trial is None:
            continue
        for iterations in ITERATIONS:
            left -= (PER_OPTIMUM + iterations) * len(trial.mesh.quads)
            optimum = optimise(trial.mesh, iterations=iterations, targets=wanted(trial.mesh))
            trial = trial.moved(optimum.mesh)
            value = score(trial, price, wanted(trial.mesh)) if optimum.valid else np.inf
            if not optimum.valid or less(value, best):
                break
        if less(value, best):
            current, best, failures = trial, value, 0
            chords = narrowest_last(current)
        else:
            failures += 1
    return current


def _collapsed(current: BaseComplex, chord: int) -> BaseComplex | None:
    """Return the mesh without a chord, None where that is not allowed or simplifies nothing."""
    mesh = current.mesh
    trial = contract(mesh, current.chord == chord)
    if trial is None:
        return None
    try:
        blocks = base_complex(trial)
    except BlockingError:
        return None
    fewer = irregular_inside(trial) < irregular_inside(mesh)
    return blocks if fewer or len(blocks.blocks) < len(current.blocks) else None


def irregular_inside(mesh: QuadMesh) -> int:
    """Return how many nodes inside have other than four quads."""
    return int(np.count_nonzero(mesh.irregular & ~mesh.wall_nodes))


def widths(current: BaseComplex) -> Floats:
    """Return how wide each chord (chords,) is: the mean length of sides of blocks across it."""
    chord = current.sides[2]
    edges = np.bincount(chord, minlength=current.chords)
    return np.bincount(chord, current.side_lengths().ravel(), current.chords) / edges
