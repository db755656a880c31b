"""Boundaries to solutions by a quad model: the batch's grids, then what polish each was asked for."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import chain
from typing import TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError, SolverError
from meshonet.solvers.algebraic.resample.grids import thinned
from meshonet.solvers.neural.operator import Polish
from meshonet.solvers.neural.quads import around
from meshonet.solvers.neural.quads.canonical_frame import OwnFrame
from meshonet.solvers.neural.quads.canonical_sides import OwnSides
from meshonet.solvers.neural.quads.edges import Edges
from meshonet.solvers.neural.quads.encoding import WINSLOW
from meshonet.solvers.neural.quads.model import ANSWERS, ANSWERS_AROUND, QuadModel, head_of, load_quads
from meshonet.solvers.neural.quads.operator import coarse_grids, evaluate, in_batches
from meshonet.solvers.neural.weights import model_path
from meshonet.solvers.solution import Solution

Counts: TypeAlias = tuple[int, int]
"""Nodes along xi and eta."""

AUTO = {WINSLOW: 2, 1: 5}
"""Steps of "auto": cycles of multigrid, or of descent."""

SOLVED = 129
"""Nodes along a direction at the most of the grid that Winslow's equations are solved on."""

DESCENDED, OTHERWISE = 513, 257
"""Nodes along a direction up to which grids descend in full, and how many the larger ones do with."""

LAST = 2
"""Steps that are taken at full resolution at the most; those before, on the network's own grid.

There they gain most of the angles in the mean, above all as steps of Newton's method, which four-sided
domains have: where the network is far off, dozens of others would not do. The last, a descent that follows
the own grid's Hessian in smooth moves, take out folds and kinks between its nodes.
"""

STILL = 1e-4
"""Moves at which a descent stops sooner, as `meshonet.solvers.energy.variational.STILL`."""


def infer_quads(
    boundaries: Sequence[Boundary],
    model: str,
    polish: Polish = "auto",
    dtype: str = "float64",
    threads: int = 1,
) -> list[Solution]:
    """Return a grid inside each of the boundaries by a quad model.

    Parameters
    ----------
    boundaries : of four-sided domains, or around bodies for a model that makes O grids; those with equal
        node counts go through the network together.
    model : ``quad-general``, ``quad-winslow``, ``hole-o``, ``hole-winslow``, or the path of a file, whose
        variational answer is taken.
    polish : steps after the network: of descent for the variational answer, multigrid cycles for Winslow's;
        a number, ``off`` or ``auto``.
    dtype : arithmetic of the network: ``float64``, or ``float32``, with which grids differ by 1e-6 of
        their size and invariances hold to that.
    threads : batches at work at a time. Grids do not depend on it.

    Returns
    -------
    list
        of a solution for each boundary, whose edges it has bitwise. Grids may be folded: see `meshonet.solvers.pipeline.fallback`.
        Seconds are a batch's, divided by its members.

    Raises
    ------
    InputError
        no such model, or one that cannot be read; a boundary of another topology.
    """
    held = load_quads(model_path(model))
    for boundary in boundaries:
        if boundary.topology != held.topology:
            told = f"model {model} makes {held.topology} grids, and this boundary is {boundary.topology}"
            raise InputError(told, "use another model", source=boundary.name)
    known = ANSWERS if held.topology == "quad" else ANSWERS_AROUND
    head = head_of(model, held.topology)
    held.network(dtype)  # made once a process: no part of a grid's time
    name = model if model in known else held.name
    steps = AUTO[head] if polish == "auto" else 0 if polish == "off" else polish

    def solve(group: Sequence[int]) -> list[Solution]:
        return _solved([boundaries[k] for k in group], held, head, steps, dtype, name)

    groups = list(in_batches(boundaries, threads))
    if threads == 1:
        answers = [solve(group) for group in groups]
    else:
        with ThreadPoolExecutor(threads) as pool:
            answers = list(pool.map(solve, groups))
    found = dict(zip(chain(*groups), chain(*answers), strict=True))
    return [found[k] for k in range(len(boundaries))]


def _solved(
    boundaries: Sequence[Boundary], model: QuadModel, head: int, steps: int, dtype: str, name: str
) -> list[Solution]:
    """Return the solutions of boundaries with equal counts, made together."""
    begun = time.perf_counter()
    frames = _frames(boundaries, model, head) if steps else []
    planes, taken = _polished([one.boundary for one in frames] or boundaries, model, head, steps, dtype)
    if frames:
        planes = np.stack([frame.back(one) for frame, one in zip(frames, planes, strict=True)])
    spent = (time.perf_counter() - begun) / len(boundaries)
    with np.errstate(invalid="ignore"):  # infinity less infinity
        finite = bool(np.isfinite(planes.sum()))
    solutions = []
    for boundary, nodes, cycles in zip(boundaries, planes.transpose(0, 2, 3, 1), taken, strict=True):
        facts = {"method": "operator", "model": name, "polish": cycles}
        grid = boundary.grid(nodes, facts, finite=finite)
        solutions.append(Solution(grid, "operator", model=name, cycles=cycles, seconds={"grid": spent}))
    return solutions


def _frames(boundaries: Sequence[Boundary], model: QuadModel, head: int) -> Sequence[OwnFrame | OwnSides]:
    """Return frames of the boundaries' own, in which descents take the same steps wherever they lie."""
    if model.topology == "o":
        return [OwnFrame.of(one) for one in boundaries]
    return [OwnSides.of(one) for one in boundaries] if head != WINSLOW else []


def _polished(
    boundaries: Sequence[Boundary], model: QuadModel, head: int, steps: int, dtype: str
) -> tuple[Floats, list[int]]:
    """Return the planes (batch, 2, ni, nj) of boundaries with equal counts, and the steps taken for each."""
    grids, evaluated = _way(boundaries, model)
    given = boundaries[0].ni, boundaries[0].nj
    coarse = grids(head, dtype)
    if not steps:
        return evaluated(coarse, given), [0] * len(boundaries)
    newton = head != WINSLOW and model.topology == "quad"
    last = steps if head == WINSLOW else min((steps + 1) // 2 if newton else steps, LAST)
    begin = _newton if newton else _descent
    taken = [begin(one, steps - last, model.topology) for one in coarse]
    ni, nj = (_polished_on(n, head) for n in given)
    planes = evaluated(coarse, (ni, nj))
    for k, one in enumerate(planes):
        if head == WINSLOW:
            taken[k] += _cycles(one, last, model.topology)
        else:
            taken[k] += _descent(one, last, model.topology, coarse[k] if newton else None)
    return (planes if (ni, nj) == given else evaluated(planes, given)), taken


def _way(
    boundaries: Sequence[Boundary], model: QuadModel
) -> tuple[Callable[[int, str], Floats], Callable[[Floats, Counts], Floats]]:
    """Return what makes the network's grids, by head and precision, and what evaluates them at counts."""
    if model.topology == "quad":
        edges = Edges.of(boundaries)
        return (
            lambda head, dtype: coarse_grids(edges, model, head, dtype),
            lambda planes, counts: evaluate(planes, edges.thinned(*counts)),
        )
    return (
        lambda head, dtype: around.coarse_grids(boundaries, model, head, dtype),
        lambda planes, counts: around.evaluate(planes, [_with(one, counts) for one in boundaries]),
    )


def _with(boundary: Boundary, counts: Counts) -> Boundary:
    """Return a boundary with the node counts."""
    return boundary if counts == (boundary.ni, boundary.nj) else thinned(boundary, *counts)


def _polished_on(n: int, head: int) -> int:
    if head == WINSLOW:
        return min(n, SOLVED)
    return n if n <= DESCENDED else OTHERWISE


def _newton(planes: Floats, steps: int, topology: Topology) -> int:
    """Take steps of Newton's method from the planes (2, m, n) in place; return how many."""
    if not steps:
        return 0
    from meshonet.solvers.energy.descent import newton
    from meshonet.solvers.energy.variational import WEIGHTS

    return newton(np.moveaxis(planes, 0, -1), WEIGHTS[topology], steps)


def _descent(planes: Floats, steps: int, topology: Topology, own: Floats | None = None) -> int:
    """Descend from the planes (2, m, n) in place, steered by the network's `own`; return the steps taken."""
    if not steps:
        return 0
    from meshonet.solvers.energy.descent import descend, stiffness_of
    from meshonet.solvers.energy.variational import WEIGHTS

    weights = WEIGHTS[topology]
    every_second = None if own is None else np.moveaxis(own[:, ::2, ::2].copy(), 0, -1)
    stiffness = None if every_second is None else stiffness_of(every_second, weights)
    nodes = np.moveaxis(planes, 0, -1)
    return descend(nodes, weights, STILL, steps, periodic=topology == "o", stiffness=stiffness)[0]


def _cycles(planes: Floats, steps: int, topology: Topology) -> int:
    """Solve Winslow's equations from the planes (2, m, n) by so many cycles, in place; return how many."""
    from meshonet.solvers.elliptic.solve import solve

    nodes = np.moveaxis(planes, 0, -1)
    try:
        boundary = Boundary(nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1], topology)
        initial = Grid.from_nodes(nodes.copy(order="K"), topology)
        solution = solve(boundary, tol=1e-12, max_cycles=steps, initial=initial)
    except (SolverError, InputError):
        return 0  # diverged, or nodes that no boundary can have
    nodes[:] = solution.grid.nodes
    return solution.cycles or 0
