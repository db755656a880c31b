"""Chords of blocks taken out of a quad mesh, as long as its score falls.

A chord is a row of blocks from wall to wall, or a ring of them. Contracting all edges across it removes the
row: the nodes on both sides of it become one. What is left is a quad mesh with fewer blocks and often as many
irregular nodes or fewer.

Borden, Benzley, Shepherd, "Hexahedral sheet extraction", 11th International Meshing Roundtable (2002);
Daniels, Silva, Shepherd, Cohen, "Quadrilateral mesh simplification", ACM Trans. Graph. 27 (2008).
"""

from __future__ import annotations

from dataclasses import dataclass

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


@dataclass
class _Work:
    """Quads times iterations that are left to spend."""

    left: float = MOST_WORK

    def spend(self, mesh: QuadMesh, iterations: int) -> None:
        """Take off what so many iterations of a mesh cost."""
        self.left -= len(mesh.quads) * iterations


def simplify(
    mesh: QuadMesh,
    *,
    price: float = PRICE,
    iterations: tuple[int, ...] = ITERATIONS,
    sizes: SizeMetric | None = None,
) -> BaseComplex:
    """Return the blocks of an optimised quad mesh after collapsing chords, the narrowest first.

    `price` is what a block costs, in degrees of mean deviation from 90; `sizes`, if any, are wanted of edges.
    """
    current = base_complex(mesh)
    best, work = score(current, price, sizes.edges(mesh) if sizes else None), _Work()
    while True:
        better = _first_gain(current, best, price, iterations, sizes, work)
        if better is None:
            return current
        current, best = better


def _first_gain(
    current: BaseComplex, best: float, price: float, iterations: tuple[int, ...], sizes: SizeMetric | None,
    work: _Work,
) -> tuple[BaseComplex, float] | None:  # fmt: skip
    """Return the first collapse, and its score, that lowers `best`; None after `FAILURES` or `work`."""
    failures = 0
    for chord in ascending(widths(current)).tolist():
        if work.left < 0.0:
            return None
        work.spend(current.mesh, PER_TRIAL)
        trial = _collapsed(current, chord)
        if trial is None:
            continue
        mesh = trial.mesh
        for more in iterations:
            work.spend(mesh, PER_OPTIMUM + more)
            optimum = optimise(mesh, iterations=more, targets=sizes.edges(mesh) if sizes else None)
            if not optimum.valid:
                break
            mesh = optimum.mesh
            judged = trial.moved(mesh)
            value = score(judged, price, sizes.edges(mesh) if sizes else None)
            if less(value, best):
                return judged, value
        failures += 1
        if failures >= FAILURES:
            return None
    return None


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
