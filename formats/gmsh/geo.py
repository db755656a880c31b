"""Gmsh's ``.geo``: outer edges as transfinite curves, each block a transfinite surface.

O and C grids become two surfaces. https://gmsh.info/doc/texinfo/gmsh.html#Structured-grids
"""

from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path

import numpy as np

from meshonet.formats.format import only_one
from meshonet.formats.gmsh.msh import INTERIOR, quotable
from meshonet.formats.mesh.unstructured import Indices, Unstructured, node_numbers, unstructured
from meshonet.geometry.blocks.grid import Grid


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the outer edges of the only grid of `grids` as lines, one for each cell edge."""
    grid = only_one(grids, "a .geo file")
    mesh = unstructured(grid)
    loops = [loop for k, number in enumerate(node_numbers(grid)) for loop in _loops(grid, k, number + 1)]
    sides = np.concatenate([np.stack([loop, np.roll(loop, -1)], axis=1) for loop, _ in loops])
    lines, which = np.unique(np.sort(sides, axis=1), axis=0, return_inverse=True)
    signed = np.where(sides[:, 0] < sides[:, 1], 1, -1) * (which.ravel() + 1)
    used = np.unique(lines)
    with path.open("w", encoding="utf-8") as stream:
        for k, x, y in np.column_stack([used, mesh.points[used - 1]]).tolist():
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
        for name, edges in _named(mesh, lines).items():
            stream.write(f'Physical Curve("{quotable(name)}") = {{{_listed(edges)}}};\n')
        stream.write(f'Physical Surface("{INTERIOR}") = {{1:{len(loops)}}};\n')


def _loops(grid: Grid, block: int, number: Indices) -> list[tuple[Indices, Indices]]:
    """Return boundary nodes and corners of the surfaces of a block; two if it joins itself."""
    last = len(number) - 1
    itself = any(each.block == each.donor == block for each in grid.connections if not each.transform)
    ends = (0, last // 2, last) if itself else (0, last)
    return [_loop(number, first, stop) for first, stop in pairwise(ends)]


def _loop(number: Indices, first: int, last: int) -> tuple[Indices, Indices]:
    """Return the nodes around columns `first` to `last`, counter-clockwise, and the four corners."""
    south, north = number[first : last + 1, 0], number[first : last + 1, -1]
    east, west = number[last], number[first]
    loop = np.concatenate([south[:-1], east[:-1], north[:0:-1], west[:0:-1]])
    return loop, np.array([south[0], south[-1], north[-1], north[0]])


def _named(mesh: Unstructured, lines: Indices) -> dict[str, Indices]:
    """Return the line numbers of each patch, by name."""
    width = len(mesh.points) + 1
    keys = lines[:, 0] * width + lines[:, 1]
    ends = {name: np.sort(edges + 1, axis=1) for name, edges in mesh.faces.items()}
    return {name: np.searchsorted(keys, rows[:, 0] * width + rows[:, 1]) + 1 for name, rows in ends.items()}


def _listed(numbers: Indices) -> str:
    return ", ".join(map(str, numbers.tolist()))
