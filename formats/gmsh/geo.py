"""Gmsh's ``.geo``: the outer edges as transfinite curves, for those who mesh or change it in Gmsh.

The nodes of the boundary are kept; those inside are Gmsh's own interpolation. O and C grids become two
surfaces, split at the middle of i, since no transfinite surface may meet itself.
https://gmsh.info/doc/texinfo/gmsh.html#Structured-grids
"""

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import numpy as np

from meshonet.formats.format import only_one
from meshonet.formats.gmsh.msh import INTERIOR, quotable
from meshonet.formats.mesh.unstructured import Indices, node_numbers, unstructured
from meshonet.geometry.blocks.grid import Grid


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the outer edges of the one grid of `grids`, a line for each cell at them."""
    grid = only_one(grids, "a .geo file")
    number = node_numbers(grid) + 1
    ends = (0, grid.ni - 1) if not grid.connections else (0, (grid.ni - 1) // 2, grid.ni - 1)
    loops = [_loop(number, first, last) for first, last in pairwise(ends)]
    sides = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop, _ in loops])
    lines, which = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    signed = np.where(sides[:, 0] < sides[:, 1], 1, -1) * (which.ravel() + 1)
    points, first = np.unique(number.ravel(), return_index=True)
    with path.open("w", encoding="utf-8") as stream:
        used = np.isin(points, lines)
        rows = np.column_stack([points, grid.nodes.reshape(-1, 2)[first]])[used]
        for k, x, y in rows.tolist():
            stream.write(f"Point({k:.0f}) = {{{x:.17g}, {y:.17g}, 0}};\n")
        for k, (start, stop) in enumerate(lines.tolist(), start=1):
            stream.write(f"Line({k}) = {{{start}, {stop}}};\n")
        stream.write(f"Transfinite Curve {{1:{len(lines)}}} = 2;\n")
        begun = 0
        for k, (loop, corners) in enumerate(loops, start=1):
            curves = signed[begun : begun + len(loop)]
            begun += len(loop)
            stream.write(f"Curve Loop({k}) = {{{_listed(curves)}}};\nPlane Surface({k}) = {{{k}}};\n")
            stream.write(
                f"Transfinite Surface {{{k}}} = {{{_listed(corners)}}};\nRecombine Surface {{{k}}};\n"
            )
        for name, edges in _named(grid, number, lines).items():
            stream.write(f'Physical Curve("{quotable(name)}") = {{{_listed(edges)}}};\n')
        stream.write(f'Physical Surface("{INTERIOR}") = {{1:{len(loops)}}};\n')


def _loop(number: Indices, first: int, last: int) -> tuple[Indices, Indices]:
    """Return the nodes around columns `first` to `last`, counter-clockwise, and the four corners."""
    south, north = number[first : last + 1, 0], number[first : last + 1, -1]
    east, west = number[last], number[first]
    loop = np.concatenate([south[:-1], east[:-1], north[:0:-1], west[:0:-1]])
    return loop, np.array([south[0], south[-1], north[-1], north[0]])


def _named(grid: Grid, number: Indices, lines: Indices) -> dict[str, Indices]:
    """Return the numbers of the lines of each part."""
    mesh = unstructured(grid)
    own = np.unique(number)  # the mesh counts its points without gaps
    width = int(number.max()) + 1
    keys = lines[:, 0] * width + lines[:, 1]
    line_numbers = {}
    for name, edges in mesh.edges.items():
        ends = np.sort(own[edges], axis=1)
        line_numbers[name] = np.searchsorted(keys, ends[:, 0] * width + ends[:, 1]) + 1
    return line_numbers


def _listed(numbers: Indices) -> str:
    return ", ".join(map(str, numbers.tolist()))
