"""NASA's neutral map file, ``.nmf``: which stretch of a Plot3D block is what, and where the cut joins.

It goes with a Plot3D file of the same grid: flat, or one cell thick when both are written so. Faces are
1, 2 at k = 1, kmax; 3, 4 at i = 1, imax; 5, 6 at j = 1, jmax; their two ranges run over the next indices in
cyclic order (i, j), (j, k), (k, i). https://crumsey.github.io/turbmodels/nmf_documentation.html
"""

from collections.abc import Iterable
from pathlib import Path

from meshonet.formats.format import Heights, only_one
from meshonet.formats.mesh.names import kinds, words
from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Kind

_FACES: dict[Side, int] = {"west": 3, "east": 4, "south": 5, "north": 6}
_TYPES: dict[Kind, str] = {
    "wall": "VISCOUS", "farfield": "FARFIELD", "inlet": "INFLOW", "outlet": "OUTFLOW", "symmetry": "SYMMETRY",
}  # fmt: skip
_RULE = "# " + "=" * 78


def write_grids(path: Path, grids: Iterable[Grid], heights: Heights = ()) -> None:
    """Write the map of the one grid of `grids`: of one plane, or repeated in z between symmetry planes."""
    grid, planes = only_one(grids, "a .nmf file"), len(heights) or 1
    patches = grid.outer_patches()
    kind, word = kinds(grid, patches), words(patch.name for patch in patches)
    rows = [
        f"{_TYPES.get(kind[p.name], word[p.name])} {_range(p.side, p.start, p.stop, planes)}" for p in patches
    ]
    if planes > 1:
        rows += [f"SYMMETRY 1 {face} 1 {grid.ni} 1 {grid.nj}" for face in (1, 2)]
    for connection in grid.connections:
        own, (side, *ends) = connection.stretches(0)
        first, last = ends[:: connection.orientation[0]]
        donor = _range(side, first, last, planes)
        rows.append(f"ONE_TO_ONE {_range(*own, planes)} {donor} FALSE")
    text = [_RULE, "# Block# IDIM JDIM KDIM", _RULE, "1", f"1 {grid.ni} {grid.nj} {planes}", _RULE]
    text += ["# Type B1 F1 S1 E1 S2 E2 [B2 F2 S1 E1 S2 E2 Swap]", _RULE, *rows, ""]
    path.write_text("\n".join(text), encoding="ascii")


def _range(side: Side, first: int, last: int, planes: int) -> str:
    """Return block, face and the two ranges of a stretch from node `first` to `last`."""
    spans = [f"{first + 1} {last + 1}", f"1 {planes}"]
    if side in ("south", "north"):
        spans.reverse()
    return f"1 {_FACES[side]} {' '.join(spans)}"
