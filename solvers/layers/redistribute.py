"""Adds layers with given heights to any grid by moving nodes along its lines.

::

    grid --rows along xi--> west, east --lines along eta--> south, north --first cells made exact--> grid

The curves of the lines that leave a wall do not change; their nodes are redistributed
(``kernels/layers/layers.c``). A valid grid with even rows thus becomes one with thin rows. Along xi
the same redistribution applies to all rows; every kink of a wall remains at a node.
"""

from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, as_planar, planar_nodes
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.resample import patches_in_place
from meshonet.geometry.curves.cubic import sampled
from meshonet.geometry.curves.curve import Curve, wall_line
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.elementary import exp
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.along_curve import on_corners
from meshonet.geometry.spacing.growth import LARGEST
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import layer_lines, redistribute
from meshonet.solvers.elliptic.wall_control import first_heights, lines_from_side
from meshonet.solvers.layers.first_cells import (
    Heights,
    arcs_in_layers,
    cells_needed,
    check_fit,
    edge_in_layers,
)
from meshonet.solvers.layers.limited import limit_growth
from meshonet.solvers.solution import Solution

FADE_NODES = 12.0  # nodes over which the last correction of a first cell fades out
EXACT = 1e-10  # relative error of a first cell that is left
SLIGHT = 1e-3  # relative error up to which the first node alone is moved
MORE_ROWS = 40  # that growth may need along bent lines, beyond those that it needs along straight ones
PASSES = 100  # largest number of alternating corrections of first cells off edges that meet


def spread(solution: Solution, boundary: Boundary, heights: Heights) -> Solution:
    """Return `solution` with its nodes moved along its grid lines into layers.

    `solution` is a valid quad or O grid for `boundary`, preferably with rows of similar height. Nodes on the
    sides of the grid move too, so that the result has a new `boundary`. Raises InputError if the boundary
    cannot have the heights, or if growth would exceed the limit.
    """
    check_fit(heights, boundary)
    check_columns(boundary, heights)
    grid = solution.grid
    nodes = grid.nodes
    if heights.west or heights.east:
        nodes = _along_xi(nodes, boundary, heights)
    growth = 1.0
    if heights.south or heights.north:
        nodes, growth = _within_growth(nodes, boundary, heights)
    else:
        _make_exact(nodes, grid.periodic, heights)
    edges = replace(
        boundary, south=nodes[:, 0], north=nodes[:, -1], west=nodes[0], east=nodes[-1],
        patches=(), sensors=None,
    )  # fmt: skip
    edges = replace(edges, patches=patches_in_place(boundary, edges))
    first_cells = heights.by_side
    facts = {**grid.provenance, **{f"spacing_{side}": height for side, height in first_cells.items()}}
    note = f"first cells {heights}, at every node there"
    note += f", growing by at most {growth:.3f} a row" if growth > 1.0 else ""
    spaced, notes = Grid.from_nodes(nodes, grid.topology, edges.patches, grid.name, facts), solution.notes
    return replace(solution, first_cells=first_cells, grid=spaced, boundary=edges, notes=(*notes, note))


def _within_growth(nodes: Floats, boundary: Boundary, heights: Heights) -> tuple[Floats, float]:
    """Return nodes with layers at south and north and exact first cells, and the largest growth ratio.

    Raises InputError: the number of rows is too small for the growth limit along some line.
    """
    ends = [heights.constant if height else 0 for height in (heights.south, heights.north)]
    for more in range(MORE_ROWS):
        out, ratio = _along_eta(nodes, boundary, heights, more)
        _make_exact(out, boundary.periodic, heights)
        if not heights.growth or limit_growth(out, heights.growth, *ends):
            break
        if not heights.free_rows:
            problem = (
                f"{out.shape[1]} rows of nodes do not keep to a growth of {heights.growth:g} on every line"
            )
            raise InputError(problem, f"use {out.shape[1] + 1} or more")
    if boundary.periodic:
        out[-1] = out[0]
    return out, ratio


def _along_eta(nodes: Floats, boundary: Boundary, heights: Heights, more: int) -> tuple[Floats, float]:
    """Return nodes with layers at south and north, of free rows `more` than needed; the largest ratio."""
    ni, nj = nodes.shape[:2]
    longest = float(np.hypot(*np.diff(nodes, axis=1).T).sum(axis=0).max())
    count = nj
    if heights.free_rows:
        count = cells_needed(1.001 * longest, heights.south, heights.north, heights) + 1 + more
    out = planar_nodes(ni, count)
    planar = as_planar(nodes)
    ends = heights.south, heights.north
    planes = planar[..., 0], planar[..., 1], out[..., 0], out[..., 1]
    ratio = layer_lines(*planes, *ends, heights.constant, threads_for(planes[2].size))
    _check_ratio(ratio, count, longest, ends, heights)
    if boundary.periodic:
        out[-1] = out[0]
    else:
        for i, edge in ((0, boundary.west), (-1, boundary.east)):
            out[i] = edge_in_layers(edge, count, *ends, heights)
    return out, ratio


def check_columns(boundary: Boundary, heights: Heights) -> None:
    """Raise InputError if there are too few nodes along xi for the prescribed heights at west and east."""
    ends = heights.west, heights.east
    for edge in (boundary.south, boundary.north) if any(ends) else ():
        curve = Curve(edge)
        _, ratio = arcs_in_layers(curve, boundary.ni, *ends, heights)
        _check_ratio(ratio, boundary.ni, curve.length, ends, heights)


def _check_ratio(
    ratio: float, count: int, length: float, ends: tuple[float, float], heights: Heights
) -> None:
    allowed = heights.growth or LARGEST
    if ratio > allowed * (1 + 1e-9):
        needed = cells_needed(1.001 * length, *ends, heights) + 1
        raise InputError(
            f"{count} nodes across {length:.3g} need cells that grow by {ratio:.3g}, more than {allowed:g}",
            f"use {needed} or more",
        )


def _along_xi(nodes: Floats, boundary: Boundary, heights: Heights) -> Floats:
    """Return nodes with layers at west and east, by maps of the index along xi that vary linearly with j."""
    ni, nj = nodes.shape[:2]
    out = nodes.copy(order="K")
    index = np.arange(float(ni))
    maps = []
    for j, edge in ((0, boundary.south), (-1, boundary.north)):
        curve = wall_line(edge)
        ends = heights.west, heights.east
        arcs, _ = arcs_in_layers(curve, ni, *ends, heights)
        kinks = curve.corners[(curve.corners > arcs[1]) & (curve.corners < arcs[-2])]
        arcs = on_corners(arcs, kinks, fixed=(1, ni - 2))
        maps.append(monotone_cubic(curve.knots, index, arcs))
        out[:, j] = curve.at(arcs)
        out[0, j], out[-1, j] = edge[0], edge[-1]
    t = np.linspace(0.0, 1.0, nj)[1:-1, None]
    at = (1 - t) * maps[0] + t * maps[1]
    rows = sampled(nodes[:, 1:-1].swapaxes(0, 1), np.broadcast_to(index, at.shape), at)
    out[1:-1, 1:-1] = rows[:, 1:-1].swapaxes(0, 1)
    return out


def _make_exact(nodes: Floats, periodic: bool, heights: Heights) -> None:
    """Correct first cells in place, at one edge after the other, until all are exact."""
    order = ("west", "east", "south", "north")
    sides = [(side, height) for side in order if (height := getattr(heights, side))]
    for _ in range(PASSES):
        inexact = [(side, height) for side, height in sides if first_cell_error(nodes, side, height) > EXACT]
        for side, height in inexact:
            _correct(nodes, side, height)
        if periodic:
            nodes[-1] = nodes[0]
        if not inexact:
            return


def _correct(nodes: Floats, side: str, height: float) -> None:
    """Make the first cells at one edge exact; the displacement of nodes decreases away from it."""
    view = lines_from_side(nodes, side)
    if side in ("west", "east"):
        view = view[1:-1]
    planes = np.ascontiguousarray(view[..., 0]), np.ascontiguousarray(view[..., 1])
    count = view.shape[1]
    away = np.arange(count) - 1.0
    if first_cell_error(nodes, side, height) < SLIGHT:
        fade = (away == 0.0).astype(np.float64)
    else:  # nothing from the middle on: the other wall's cells are thin against the arc length there
        fade = exp(-np.maximum(away, 0.0) / FADE_NODES) * np.clip(1.0 - 2.0 * away / count, 0.0, 1.0)
    redistribute(*planes, np.full(len(view), height), fade, threads_for(planes[0].size))
    view[..., 0], view[..., 1] = planes


def worst_first_cell(solution: Solution) -> float:
    """Return the largest relative error of first-cell heights in `solution`; 0 if none is prescribed."""
    nodes, heights = solution.grid.nodes, solution.first_cells
    return max((first_cell_error(nodes, side, height) for side, height in heights.items()), default=0.0)


def first_cell_error(nodes: Floats, side: str, height: float) -> float:
    """Return the largest relative error of first-cell heights at a side of a block of nodes (ni, nj, 2)."""
    return float(np.abs(first_heights(lines_from_side(nodes, side)) / height - 1.0).max())
