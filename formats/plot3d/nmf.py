"""NASA's neutral map file, ``.nmf``: which stretch of a Plot3D block is what, and where blocks join.

It goes with a Plot3D file of the same grid: flat, or one cell thick when both are written so. Faces are 1, 2
at k = 1, kmax; 3, 4 at i = 1, imax; 5, 6 at j = 1, jmax; their two ranges run over the next indices in cyclic
order (i, j), (j, k), (k, i). Of two joined faces the second's ranges run as the first's, or are swapped.
Names of patches stand in comments before their rows. Periodic sides, which nobody has laid down, are rows of
type PERIODIC that else are as those of interfaces.
https://crumsey.github.io/turbmodels/nmf_documentation.html
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from meshonet.formats.format import Heights, only_one
from meshonet.formats.mesh.names import kinds, words
from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind, Patch

PART = "# part: "
"""Begins the comment that names the patch of the next row; before two names, that of its donor."""
FACES = (3, 5, 1)
"""Number of the face where each index is 1; the next number is that where it is greatest."""
_TYPES: dict[Kind, str] = {
    "wall": "VISCOUS", "farfield": "FARFIELD", "inlet": "INFLOW", "outlet": "OUTFLOW", "symmetry": "SYMMETRY",
}  # fmt: skip
_RULE = "# " + "=" * 78


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = ()) -> None:
    """Write the map of the one grid of `grids`: of one plane, or repeated in z between symmetry planes."""
    write_map(path, [only_one(grids, "a .nmf file")], len(heights) or 1)


def write_map(path: Path, grids: Sequence[Grid], planes: int, span: int = 2) -> None:
    """Write the map of all blocks of `grids`, whose `planes` in z are counted by the index `span`."""
    dims: list[list[int]] = []
    rows: list[str] = []
    for grid in grids:
        before = len(dims)
        for block in grid.blocks:
            counts = list(block.counts)
            counts.insert(span, planes)
            dims.append(counts)
        rows += _Rows(grid, before, planes, span).all()
    heads = [f"{k} {' '.join(map(str, counts))}" for k, counts in enumerate(dims, start=1)]
    text = [_RULE, "# Block# IDIM JDIM KDIM", _RULE, str(len(dims)), *heads, _RULE]
    text += ["# Type B1 F1 S1 E1 S2 E2 [B2 F2 S1 E1 S2 E2 Swap]", _RULE, *rows, ""]
    path.write_text("\n".join(text), encoding="utf-8")


class _Rows:
    """The rows of one grid, whose blocks are counted from `before` on."""

    def __init__(self, grid: Grid, before: int, planes: int, span: int) -> None:
        self._grid, self._before, self._planes, self._span = grid, before, planes, span
        self._axes = [axis for axis in range(3) if axis != span]  # those of xi and eta

    def all(self) -> list[str]:
        """Return the rows of patches, of the outermost planes, of connections."""
        grid, rows = self._grid, []
        patches = grid.outer_patches()
        kind, word = kinds(grid, patches), words(patch.name for patch in patches)
        for p in patches:
            rows.append(f"{PART}{p.name}")
            where, _ = self._range(p.block, p.side, p.start, p.stop)
            rows.append(f"{_TYPES.get(kind[p.name], word[p.name])} {where}")
        if self._planes > 1:
            rows += [row for block in range(len(grid.blocks)) for row in self._ends(block)]
        for connection in grid.connections:
            rows += self._joined(connection)
        return rows

    def _ends(self, block: int) -> list[str]:
        first, second = (self._span + 1) % 3, (self._span + 2) % 3
        counts = dict(zip(self._axes, self._grid.blocks[block].counts, strict=True))
        face = FACES[self._span]
        ranges = f"1 {counts[first]} 1 {counts[second]}"
        return [f"SYMMETRY {self._before + block + 1} {face + end} {ranges}" for end in (0, 1)]

    def _joined(self, each: Connection) -> list[str]:
        (own, own_swapped) = self._range(each.block, each.side, *each.range[0])
        first, last = each.donor_range[0][:: each.orientation[0]]
        donor, donor_swapped = self._range(each.donor, each.donor_side, first, last)
        swap = str(own_swapped != donor_swapped).upper()
        if each.transform is None:
            return [f"ONE_TO_ONE {own} {donor} {swap}"]
        names = [_named(self._grid.patches, way) for way in (each, each.reversed())]
        return [*(f"{PART}{name}" for name in names if all(names)), f"PERIODIC {own} {donor} {swap}"]

    def _range(self, block: int, side: Side, first: int, last: int) -> tuple[str, bool]:
        """Return block, face and ranges of a stretch of a side, and whether that in z comes first."""
        axis, end = PLACES[side]
        fixed = self._axes[axis]
        spans = [f"{first + 1} {last + 1}", f"1 {self._planes}"]
        swapped = (fixed + 1) % 3 == self._span
        ordered = " ".join(reversed(spans) if swapped else spans)
        return f"{self._before + block + 1} {FACES[fixed] - end} {ordered}", swapped


def _named(patches: Sequence[Patch], each: Connection) -> str:
    first, last = each.range[0]
    for p in patches:
        if (p.block, p.side) == (each.block, each.side) and p.start <= first and last <= p.stop:
            return p.name
    return ""
