"""Chords of blocks taken out of a quad mesh, as long as its score falls.

A chord is a row of blocks from wall to wall, or a ring of them. Contracting all edges across it removes the
row: the nodes on both sides of it become one. What is left is a quad mesh with fewer blocks and often as many
irregular nodes or fewer.

Borden, Benzley, Shepherd, "Hexahedral sheet extraction", 11th International Meshing Roundtable (2002);
Daniels, Silva, Shepherd, Cohen, "Quadrilateral mesh simplification", ACM Trans. Graph. 27 (2008).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.solvers.blocking.base_complex import BaseComplex, base_complex
from meshonet.solvers.blocking.contract import contract
from meshonet.solvers.blocking.errors import BlockingError
from meshonet.solvers.blocking.score import PRICE, score
from meshonet.solvers.energy.quads import optimise

FAILURES = 8
"""Trials without gain, one after another, after which the mesh stays as it is."""

ITERATIONS = (6, 12, 22)
"""Iterations of the functional before a trial is judged, and further ones before it is judged again."""


def simplify(
    mesh: QuadMesh, *, price: float = PRICE, iterations: tuple[int, ...] = ITERATIONS
) -> BaseComplex:
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
    current: BaseComplex, best: float, price: float, iterations: tuple[int, ...]
) -> tuple[BaseComplex, float] | None:
    """Return the first collapse, and its score, that lowers `best`; None after `FAILURES`."""
    failures = 0
    for chord in np.argsort(widths(current), kind="stable").tolist():
        trial = _collapsed(current, chord)
        if trial is None:
            continue
        mesh = trial.mesh
        for more in iterations:
            optimum = optimise(mesh, iterations=more)
            if not optimum.valid:
                break
            mesh = optimum.mesh
            value = score(mesh, len(trial.blocks), price)
            if value < best:
                return replace(trial, mesh=mesh), value
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
    sides = [line for block in current.blocks for line in (block[:, 0], block[0])]
    ends = np.array([line[:2] for line in sides])
    keys = mesh.edges[:, 0] * len(mesh.nodes) + mesh.edges[:, 1]
    first = np.searchsorted(keys, ends.min(axis=1) * len(mesh.nodes) + ends.max(axis=1))
    rows = np.zeros(current.chords)
    rows[current.chord[first]] = [len(line) - 1 for line in sides]
    return np.asarray(mean * rows)
