"""Block structures: their transfinite grids beside the joint optimum of all blocks, by checkMesh's measures.

    python benchmarks/bench_blockings.py [STRUCTURE.json ...] [--slide] [--pictures FOLDER]

A file holds a structure in its key ``planar``, or is one (`block_mesh`); five of our own are always there.
Prints the largest non-orthogonality and skewness of both grids, growth across sides and how far first cells
of layers are off, and ends with 1 if an optimum is worse than its transfinite grid in one of the first two.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np
from block_mesh import block_mesh
from structures import STRUCTURES

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.layout.from_grid import layout_of
from meshonet.geometry.quality.blocks import block_figures
from meshonet.geometry.quality.checkmesh import faces
from meshonet.solvers.smoothing.smooth import smooth
from meshonet.solvers.smoothing.wanted_lengths import thin_heights

ROUNDING = 1e-6
HEAD = ("cells", "non-orthogonality", "skewness", "deviation", "growth across", "first cells", "s")


def main() -> int:
    """Measure and print; return 1 if an optimum is worse."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("structures", nargs="*", type=Path)
    parser.add_argument("--slide", action="store_true", help="nodes of the boundary slide along it")
    parser.add_argument("--pictures", type=Path, help="folder for a picture of each grid")
    chosen = parser.parse_args()
    grids = []
    for path in chosen.structures:
        structure = json.loads(path.read_text(encoding="utf-8"))
        grids.append(block_mesh(structure.get("planar", structure), path.stem))
    grids += [block_mesh(make(), name) for name, make in STRUCTURES.items()]
    print(f"{'':22}" + "".join(f"{word:>20}" for word in HEAD))
    worse = [grid.name for grid in grids if _compared(grid, chosen.slide, chosen.pictures)]
    print(f"worse than their transfinite grids: {', '.join(worse) or 'none'}")
    return bool(worse)


def _compared(grid: Grid, slide: bool, pictures: Path | None) -> bool:
    begun = time.perf_counter()
    solution = smooth(grid, slide=slide)
    spent = time.perf_counter() - begun
    given, made = _figures(grid), _figures(solution.grid)
    heights = [layout_of(each).mesh.edge_lengths for each in (solution.grid, grid)]
    thin = thin_heights(layout_of(grid).mesh)
    ratio = np.abs(np.log(heights[0][thin] / heights[1][thin])).max(initial=0.0)
    cells = sum((block.counts[0] - 1) * (block.counts[1] - 1) for block in grid.blocks)
    pairs = [f"{a:9.4f} ->{b:8.4f}" for a, b in zip(given, made, strict=True)]
    print(
        f"{grid.name:22}{cells:20}"
        + "".join(pairs)
        + f"{'-' if slide else f'{np.expm1(ratio):.1%}':>20}{spent:20.2f}",
        flush=True,
    )
    for note in solution.notes:
        print(f"{'':22}{note}")
    if pictures:
        from meshonet import plot

        for name, each in (("given", grid), ("optimum", solution.grid)):
            plot(each, pictures / f"{grid.name}-{name}.png")
    return any(b > a + ROUNDING for a, b in zip(given[:2], made[:2], strict=True))


def _figures(grid: Grid) -> tuple[float, float, float, float]:
    result, blocks = faces(grid), block_figures(grid)
    across = blocks.lines.growth_across
    return (
        result.non_orthogonality.max if result.non_orthogonality else 0.0,
        result.face_skewness.max if result.face_skewness else 0.0,
        blocks.deviation.mean,
        across.max if across else 1.0,
    )


if __name__ == "__main__":
    sys.exit(main())
