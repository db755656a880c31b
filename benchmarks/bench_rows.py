"""Grids of blade rows, judged apart from the product: Rotor 37 and random rows of real sections.

python benchmarks/bench_rows.py --airfoils FOLDER [--seed 1] [--count 30] [--row rotor37.toml]
"""

from __future__ import annotations

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import time
from pathlib import Path

import numpy as np
from page import arguments
from random_rows import airfoils, drawn_rows
from row_judge import Judged, judge

from meshonet.formats.stack import stack_of
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import limited_to
from meshonet.solvers.rows.request import RowRequest
from meshonet.solvers.rows.row_grid import row_grid

CELLS, FIRST = 200_000, 1e-3
"""Of random rows."""


def figures(row: Row, request: RowRequest) -> tuple[Judged, float, tuple[str, ...]]:
    """Return the figures of a row's grid, CPU seconds and notes."""
    begun = time.process_time()
    with limited_to(request.threads):
        grid, notes = row_grid(row, request)
    seconds = time.process_time() - begun
    return judge(grid, row, request.height() * row.chord), seconds, notes


def line(name: str, made: Judged, seconds: float) -> str:
    """Return the line of the table for a grid."""
    growth = made.growths
    return " | ".join(
        (
            name, f"{made.nodes}", f"{seconds:.1f}", f"{made.folded_corners}/{made.folded_bezier}",
            f"{made.scaled.min():.3f} / {np.percentile(made.scaled, 0.1):.3f} / {made.scaled.mean():.3f}",
            f"{made.angle.max():.0f} / {np.percentile(made.angle, 99.9):.0f}",
            f"{max(made.first.values()):.0e}",
            f"{np.percentile(growth, 99):.3f} / {np.percentile(growth, 99.9):.3f} / {growth.max():.2f}",
            f"{made.periodic:.0e}", f"{made.blade:.0e}",
        )
    )  # fmt: skip


def by_line(made: Judged) -> str:
    """Return growth by the kind of line: 99.9 % and largest."""
    parts = [
        f"{name} {np.percentile(own, 99):.2f}/{np.percentile(own, 99.9):.2f}/{own.max():.2f}"
        for name, own in made.growth.items()
        if len(own)
    ]
    return ", ".join(parts)


def main() -> None:
    """Print the figures."""
    parser = arguments(__doc__)
    parser.add_argument("--airfoils", type=Path)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--row", type=Path)
    parser.add_argument("--cells", type=int, nargs="*", default=[1_000_000, 2_000_000])
    parser.add_argument("--first", type=float, default=1e-4)
    options = parser.parse_args()
    if options.row:
        row = stack_of(str(options.row))
        assert isinstance(row, Row)
        for cells in options.cells:
            made, seconds, notes = figures(row, RowRequest(first_cell=options.first, cells=cells, threads=1))
            print(line(f"{row.name} {cells}", made, seconds))
            print("   ", by_line(made), made.first, *notes, flush=True)
    if options.airfoils:
        scaled, valid, growths = [], 0, []
        for k, each in enumerate(drawn_rows(airfoils(options.airfoils), options.seed, options.count)):
            if options.only and k not in options.only:
                continue
            print(each.words)
            try:
                made, seconds, _ = figures(each.row, RowRequest(first_cell=FIRST, cells=CELLS, threads=1))
            except MeshonetError as error:
                print("    refused:", error, flush=True)
                continue
            folded = made.folded_corners or made.folded_bezier
            valid += not folded
            scaled.append(float(made.scaled.min()))
            growths.append(float(np.percentile(made.growths, 99.9)))
            print("   ", line("FOLDED" if folded else "made", made, seconds))
            print("        ", by_line(made), flush=True)
        print(f"{valid} of {options.count} valid, least scaled Jacobian median {np.median(scaled):.3f}, "
              f"growth 99.9 % median {np.median(growths):.2f}, largest {max(growths):.2f}")  # fmt: skip


if __name__ == "__main__":
    main()
