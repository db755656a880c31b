"""Names for the outer edges of a grid of blocks that nobody named: those of the closed line they are part of.

The outermost line is ``outer``, those around bodies are ``body``, ``body2`` and so on.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshonet.formats.mesh.loops import closed_loops
from meshonet.formats.mesh.unstructured import node_numbers
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import Indices


def with_loop_names(grid: Grid) -> Grid:
    """Return a grid of planar blocks with patches on all its outer edges."""
    outer = grid.outer_patches()
    unnamed = [patch for patch in outer if not any(_covers(named, patch) for named in grid.patches)]
    if not unnamed:
        return grid
    numbers = node_numbers(grid)
    titles = _titles(grid, numbers, outer)
    taken = {patch.name for patch in grid.patches}
    new = []
    for patch in unnamed:
        line = face_of(numbers[patch.block], patch.side)[patch.start : patch.stop + 1]
        title = titles.get(int(line[0]), titles.get(int(line[-1]), "outer"))
        new.append(replace(patch, name=title if title not in taken else f"{title}-unnamed", kind="other"))
    return replace(grid, patches=(*grid.patches, *new))


def _covers(named: Patch, part: Patch) -> bool:
    same = (named.block, named.side, named.name) == (part.block, part.side, part.name)
    return same and named.start <= part.start and part.stop <= named.stop


def _titles(grid: Grid, numbers: list[Indices], outer: list[Patch]) -> dict[int, str]:
    """Return the name of the line that each outer node is on; periodic sides are parts of lines too."""
    rows = [_edges(numbers, p.block, p.side, p.start, p.stop) for p in outer]
    for each in grid.connections:
        if each.transform:
            ends = (each.block, each.side, each.range), (each.donor, each.donor_side, each.donor_range)
            rows += [_edges(numbers, block, side, *span[0]) for block, side, span in ends]
    count = 1 + max(int(number.max()) for number in numbers)
    points = np.empty((count, 2))
    for number, block in zip(numbers, grid.blocks, strict=True):
        points[number] = block.nodes
    try:
        loops = closed_loops({"": np.concatenate(rows)}, points)
    except InputError:  # lines that touch: they count as one
        return {}
    outermost, *others = sorted(loops, key=lambda loop: -abs(polygon_area(points[loop.nodes])))
    names = [(outermost, "outer")]
    names += [(loop, "body" if k == 1 else f"body{k}") for k, loop in enumerate(others, start=1)]
    return {int(node): name for loop, name in names for node in loop.nodes}


def _edges(numbers: list[Indices], block: int, side: str, start: int, stop: int) -> Indices:
    line = face_of(numbers[block], side)[start : stop + 1]  # type: ignore[arg-type]
    rows = np.stack([line[:-1], line[1:]], axis=-1)
    return np.asarray(rows[:, ::-1] if side in ("north", "west") else rows)
