"""NASA's neutral map file, ``.nmf``: which stretch of a Plot3D block is what, and where blocks join.

It goes with a Plot3D file of the same grid, plane, of volumes or of surfaces. Faces are 1, 2
at k = 1, kmax; 3, 4 at i = 1, imax; 5, 6 at j = 1, jmax; their two ranges run over the next indices in cyclic
order (i, j), (j, k), (k, i). Of two joined faces the second's ranges run as the first's, or are swapped.
Names of patches stand in comments before their rows. Periodic sides, which nobody has laid down, are rows of
type PERIODIC that else are as those of interfaces.
https://crumsey.github.io/turbmodels/nmf_documentation.html
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from meshonet.formats.format import only_one
from meshonet.formats.mesh.names import kinds, words
from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES, Range
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind

PART = "# part: "
"""Begins the comment that names the patch of the next row; before two names, that of its donor."""
FACES = (3, 5, 1)
"""Number of the face where each index is 1; the next number is that where it is greatest."""
_TYPES: dict[Kind, str] = {
    "wall": "VISCOUS", "farfield": "FARFIELD", "inlet": "INFLOW", "outlet": "OUTFLOW", "symmetry": "SYMMETRY",
}  # fmt: skip
_RULE = "# " + "=" * 78


def write_grids(path: Path, grids: Iterable[Grid]) -> None:
    """Write the map of the one grid of `grids`."""
    write_map(path, [only_one(grids, "a .nmf file")])


def write_map(path: Path, grids: Sequence[Grid], span: int = 2) -> None:
    """Write the map of all blocks of `grids`; their third direction, if any, is the index `span`."""
    dims: list[list[int]] = []
    rows: list[str] = []
    for grid in grids:
        before = len(dims)
        for block in grid.blocks:
            counts = [*block.counts, 1][:3]
            counts.insert(span, counts.pop())
            dims.append(counts)
        rows += _Rows(grid, before, span).all()
    heads = [f"{k} {' '.join(map(str, counts))}" for k, counts in enumerate(dims, start=1)]
    text = [_RULE, "# Block# IDIM JDIM KDIM", _RULE, str(len(dims)), *heads, _RULE]
    text += ["# Type B1 F1 S1 E1 S2 E2 [B2 F2 S1 E1 S2 E2 Swap]", _RULE, *rows, ""]
    path.write_text("\n".join(text), encoding="utf-8")


class _Rows:
    """The rows of one grid, whose blocks are counted from `before` on."""

    def __init__(self, grid: Grid, before: int, span: int) -> None:
        self._grid, self._before = grid, before
        self._axes = [axis for axis in range(3) if axis != span] + [span]
        """The index of the file that each direction is."""

    def all(self) -> list[str]:
        """Return the rows of patches and of connections."""
        grid, rows = self._grid, []
        patches = grid.outer_patches()
        kind, word = kinds(grid, patches), words(patch.name for patch in patches)
        for p in patches:
            rows.append(f"{PART}{p.name}")
            part = p.range(grid.blocks[p.block].face(p.side).shape[:-1])
            where, _ = self._window(p.block, p.side, part)
            rows.append(f"{_TYPES.get(kind[p.name], word[p.name])} {where}")
        for connection in grid.connections:
            rows += self._joined(connection)
        return rows

    def _joined(self, each: Connection) -> list[str]:
        along = list(each.donor_range)
        for way in each.orientation:
            first, last = along[abs(way) - 1]
            along[abs(way) - 1] = (first, last) if way > 0 else (last, first)
        own, own_first = self._window(each.block, each.side, each.range)
        donor, donor_first = self._window(each.donor, each.donor_side, tuple(along))
        # the third direction of blocks with two lies along that of others
        partner = [*(abs(way) - 1 for way in each.orientation), 1][own_first]
        swap = str(partner != donor_first).upper()
        if each.transform is None:
            return [f"ONE_TO_ONE {own} {donor} {swap}"]
        names = [_named(self._grid, way) for way in (each, each.reversed())]
        return [*(f"{PART}{name}" for name in names if all(names)), f"PERIODIC {own} {donor} {swap}"]

    def _window(self, block: int, side: Side, part: Range) -> tuple[str, int]:
        """Return block, face and ranges of a part of a side, and which direction the first range is of.

        The ranges of a face run along the two indices that follow its own in cyclic order.
        """
        fixed, end = PLACES[side]
        axis = self._axes[fixed]
        spans = [f"{first + 1} {last + 1}" for first, last in part]
        along = [self._axes[direction] for direction in range(3) if direction != fixed]
        spans += ["1 1"] * (2 - len(spans))
        first = along.index((axis + 1) % 3)
        return f"{self._before + block + 1} {FACES[axis] - end} {spans[first]} {spans[1 - first]}", first


def _named(grid: Grid, each: Connection) -> str:
    """Return the name of the patch that a side of a connection lies in."""
    counts = grid.blocks[each.block].face(each.side).shape[:-1]
    for p in grid.patches:
        if (p.block, p.side) == (each.block, each.side) and _within(each.range, p.range(counts)):
            return p.name
    return ""


def _within(part: Range, whole: Range) -> bool:
    return all(a <= first and last <= b for (first, last), (a, b) in zip(part, whole, strict=True))
