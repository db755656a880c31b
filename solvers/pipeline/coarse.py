"""A grid of any resolution from a small one: solve with few nodes, then evaluate at many.

A few nodes describe a smooth grid. So the boundary is thinned to the coarse counts, a solver works there, and
splines through its nodes are evaluated inside the full edges (`meshonet.solvers.algebraic.resample.quad`). Around a body lines keep
their own course instead (`meshonet.solvers.algebraic.resample.o_grid`). Thinned edges are taken between the given nodes at equal
steps of their index.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, Topology, as_planar, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import Indices
from meshonet.geometry.quality.measure import angles, count_folded
from meshonet.solvers.algebraic.resample import corner_damping as acute
from meshonet.solvers.algebraic.resample import quad as evaluation
from meshonet.solvers.algebraic.resample.o_grid import evaluate_around
from meshonet.solvers.algebraic.resample.spline import between
from meshonet.solvers.solution import Solution

LEAST = 9
"""Fewest coarse nodes along a direction that describe anything."""

REACH = 3.0
"""Coarse cells to each side of a kink, and inwards, that are relaxed at full resolution.

Half as many where that is more than `NEAR` fine cells and Winslow's equations were solved: what the
sweeps change is nearer to the kink, and the largest angles are the same to a tenth of a degree.
"""

NEAR = 40

SWEEPS = 4
"""Sweeps there."""


def solve_coarse(
    boundary: Boundary, method: Callable[[Boundary], Solution], n: int, *, smooth: bool
) -> Solution:
    """Solve with `method` on at most n x n nodes and return the grid at the node counts of `boundary`.

    Parameters
    ----------
    boundary : quad, o or c.
    method : a solver of boundary to solution.
    n : coarse nodes along each direction that has more.
    smooth : whether to end with sweeps of Winslow's equations at full resolution around kinks of the
        boundary: always where these were solved or the grid came out folded, else where angles gain by them.

    Returns
    -------
    Solution
        the method's, with the fine grid; residual and cycles are those of the coarse solve. The edges equal
        those of `boundary` bitwise.

    Raises
    ------
    InputError
        fewer than 9 coarse nodes.
    """
    if n < LEAST:
        raise InputError(f"{n} coarse nodes along a direction are too few", f"use at least {LEAST}")
    counts = min(n, boundary.ni), min(n, boundary.nj)
    if counts == (boundary.ni, boundary.nj):
        return method(boundary)
    begun = time.perf_counter()
    solution = method(thinned(boundary, *counts))
    nodes = evaluate(solution.grid.nodes, boundary)
    if smooth:
        winslow = solution.method == "winslow" or count_folded(nodes) > 0
        sweep_kinks(nodes, boundary, counts, only_better=not winslow)
    facts = {**solution.grid.provenance, "coarse": counts}
    grid = boundary.grid(nodes, facts)
    return replace(solution, grid=grid, seconds={**solution.seconds, "grid": time.perf_counter() - begun})


def thinned(boundary: Boundary, ni: int, nj: int) -> Boundary:
    """Return `boundary` with ni x nj nodes, at equal steps of the index of the given ones.

    A C becomes a quad: thinned, its trailing edge need not be a node.
    """
    topology: Topology = "quad" if boundary.topology == "c" else boundary.topology
    south, north = _thinned(boundary.south, ni), _thinned(boundary.north, ni)
    west, east = _thinned(boundary.west, nj), _thinned(boundary.east, nj)
    return Boundary(south, north, west, east, topology, name=boundary.name)


def evaluate(coarse: Floats, boundary: Boundary) -> Floats:
    """Return planar nodes inside `boundary` from a grid (m, n, 2) inside its thinned edges."""
    if boundary.topology == "o":
        return evaluate_around(coarse, boundary)
    names = ("south", "north", "west", "east")
    south, north, west, east = (np.ascontiguousarray(getattr(boundary, side).T)[None] for side in names)
    planes = np.ascontiguousarray(np.moveaxis(coarse, -1, 0))[None]
    return np.moveaxis(evaluation.evaluate(planes, (south, north, west, east))[0], 0, -1)


def divided(coarse: Floats, boundary: Boundary) -> Floats:
    """Return what `evaluate` does for a quad by straight lines between coarse nodes.

    They bend at these, but cells inside a valid coarse cell are valid: folds are left only beside edges that
    bend between coarse nodes.
    """
    nodes = planar_nodes(boundary.ni, boundary.nj)
    along, across = acute.linear(len(coarse), boundary.ni), acute.linear(coarse.shape[1], boundary.nj)
    for c in (0, 1):
        nodes[..., c] = along @ coarse[..., c] @ across.T
    nodes[:, 0], nodes[:, -1] = boundary.south, boundary.north
    nodes[0], nodes[-1] = boundary.west, boundary.east
    return nodes


def sweep_kinks(
    nodes: Floats, boundary: Boundary, counts: tuple[int, int], *, only_better: bool = False
) -> bool:
    """Relax planar `nodes` in place by sweeps of Winslow's equations around the kinks of the boundary.

    There the solution is not smooth, and a spline through the `counts` coarse nodes smears it. With
    `only_better` a kink is left alone around which the largest angle would not be smaller. Returns whether
    there are kinks.
    """
    from meshonet.solvers.elliptic.relax import relax

    any_kinks = False
    steps = [(n - 1) / (m - 1) for n, m in zip(nodes.shape[:2], counts, strict=True)]
    for axis, sides in ((0, ("south", "north")), (1, ("west", "east"))):
        if boundary.topology == "o" and axis == 1:
            continue
        n, lines = nodes.shape[axis], nodes.shape[1 - axis]
        wide = REACH * steps[axis], REACH * steps[1 - axis]
        reach, depth = (int(np.ceil(w if only_better else min(w, max(NEAR, 0.5 * w)))) for w in wide)
        for side in sides:
            corners = boundary.corners[side]
            any_kinks = any_kinks or len(corners) > 0
            inside = (
                slice(0, depth + 1) if side in {"south", "west"} else slice(max(lines - depth - 1, 0), lines)
            )
            for start, stop in _joined(corners, reach, n):
                window = (slice(start, stop), inside) if axis == 0 else (inside, slice(start, stop))
                patch = as_planar(nodes[window])
                before = angles(patch)[0] if only_better else 0.0
                relax(patch, SWEEPS)
                if not only_better or angles(patch)[0] < before:
                    nodes[window] = patch
    return any_kinks


def _joined(kinks: Indices, reach: int, n: int) -> Iterator[tuple[int, int]]:
    """Yield ranges of indices, none touching another, `reach` to each side of the `kinks`, within n."""
    start = stop = 0
    for kink in kinks:
        if stop and kink - reach > stop:
            yield start, stop
            stop = 0
        start = start if stop else max(int(kink) - reach, 0)
        stop = min(int(kink) + reach + 1, n)
    if stop:
        yield start, stop


def _thinned(edge: Floats, n: int) -> Floats:
    return np.asarray(between(edge.T, n).T)
