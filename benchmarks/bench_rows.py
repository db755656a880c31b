"""Grids of blade rows, judged apart from the product: a row given and random ones of real sections.

    python benchmarks/bench_rows.py --row TOML --airfoils FOLDER [--count 30] [--page docs/benchmarks/rows.md]

`row_judge` computes the figures, `random_rows` draws the rows.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import sys
import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

import numpy as np
from page import arguments, processor, publish
from radial_rows import radial_row
from random_rows import airfoils, drawn_rows
from row_judge import Judged, judge

from meshonet.formats.stack import stack_of
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import limited_to
from meshonet.solvers.rows.request import RowRequest
from meshonet.solvers.rows.row_grid import row_grid

RANDOM_CELLS, RANDOM_FIRST, RADIAL = 100_000, 1e-3, 24
HEAD = """# Blade rows

<!-- made by python benchmarks/bench_rows.py --row TOML --airfoils FOLDER --page docs/benchmarks/rows.md -->

Use this page to find the quality and the CPU time of grids of [blade rows](../guide/blade-rows.md): of Rotor
37, of random axial rows and of random radial rows. Times are for one thread of {machine}.

- *folded cells*: cells in which a Bezier coefficient of the Jacobian is not positive. Without such cells the
  Jacobian is positive everywhere.
- *scaled Jacobian*: smallest [scaled Jacobian](../reference/metrics.md#cells-of-volumes) of the cells.
- *largest angle*: largest angle of the cell faces.
- *first-cell error*: largest relative error of a first-cell height over all walls.
- *growth*: ratio of the lengths of adjacent edges along a grid line, larger over smaller. Grid lines continue
  from block to block.
- *distance from the blade*: largest distance of a blade node from the surface through the given profiles.

## Rotor 37

Rotor 37 is NASA's transonic compressor rotor, with a tip gap of 0.356 mm. The two grids differ in `--cells`.
The first-cell height is {first:g} chords, and `--growth` is 1.2.

| nodes | folded cells | scaled Jacobian | largest angle, degrees | first-cell error \
| growth: 99.9th percentile / largest | distance from the blade, chords | CPU time, s |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""
RANDOM = """
## Random rows

The blade of an axial row is interpolated between two real airfoils, at hub and casing. These
properties are random:

| property | range |
| --- | --- |
| stagger at mid-span | 0 to 65 degrees; at hub and casing it differs by up to 30 degrees |
| solidity (chord / distance between blades) at mid-span | 0.7 to 2 |
| ratio of hub radius to tip radius | 0.4 to 0.9 |
| channel | cylindrical, conical or curved |
| tip gap | up to 3 % of the span in two of three rows; the others have no gap |

Radial rows are centrifugal impellers, radial turbines, mixed-flow pumps and vaned diffusers. All grids are
made with `--cells {cells}` and first-cell heights of {first:g} chords. Most grids have more cells, because
the layers at the walls need them.

| rows | valid grids | nodes, median | scaled Jacobian: median / worst \
| largest angle, degrees: median / worst | first-cell error \
| growth: median of 99.9th percentiles / largest | CPU time, s: median |
| --- | --- | --- | --- | --- | --- | --- | --- |
"""
TAIL = """
- Radial rows have larger angles and growth than axial rows.
- Nodes on periodic sides match: their largest distance after a rotation by one pitch is {periodic:g}.
"""


def figures(row: Row, request: RowRequest, *, blade: bool = True) -> tuple[Judged, float]:
    """Return the figures of a row's grid, and CPU seconds."""
    begun = time.process_time()
    with limited_to(request.threads):
        grid, _ = row_grid(row, request)
    seconds = time.process_time() - begun
    return judge(grid, row, request.height() * row.chord, blade=blade), seconds


def line(made: Judged, seconds: float) -> str:
    """Return the line of the table for a grid."""
    growth = made.growths
    cells = (
        f"{made.nodes}", f"{max(made.folded_corners, made.folded_bezier)}", f"{made.scaled.min():.3f}",
        f"{made.angle.max():.0f}", f"{max(made.first.values()):.0e}",
        f"{np.percentile(growth, 99.9):.3f} / {growth.max():.2f}", f"{made.blade:.0e}", f"{seconds:.1f}",
    )  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def summary(what: str, count: int, made: Sequence[tuple[Judged, float]]) -> str:
    """Return the line of the table for random rows, of which `made` are without folds."""
    judged, seconds = [each for each, _ in made], [spent for _, spent in made]
    scaled = [each.scaled.min() for each in judged]
    angles = [each.angle.max() for each in judged]
    cells = (
        what, f"{len(made)} of {count}", f"{np.median([each.nodes for each in judged]):.0f}",
        f"{np.median(scaled):.3f} / {min(scaled):.3f}", f"{np.median(angles):.0f} / {max(angles):.0f}",
        f"{max(max(each.first.values()) for each in judged):.0e}",
        f"{np.median([np.percentile(each.growths, 99.9) for each in judged]):.2f} / "
        f"{max(each.growths.max() for each in judged):.2f}",
        f"{np.median(seconds):.1f}",
    )  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def random_line(what: str, rows: Iterable[tuple[str, Callable[[], Row]]]) -> tuple[str, float]:
    """Return the line of rows and their largest periodic distance; refused and folded ones are printed."""
    made, count = [], 0
    request = RowRequest(first_cell=RANDOM_FIRST, cells=RANDOM_CELLS, threads=1)
    for words, row in rows:
        count += 1
        try:
            judged, seconds = figures(row(), request, blade=False)
        except MeshonetError as error:
            print(words, "is refused:", error)
            continue
        if judged.folded_corners or judged.folded_bezier:
            print(words, "IS FOLDED")
            continue
        made.append((judged, seconds))
    return summary(what, count, made), max((judged.periodic for judged, _ in made), default=0.0)


def main() -> None:
    """Print the figures, and write the page."""
    parser = arguments(__doc__)
    parser.add_argument("--airfoils", type=Path)
    parser.add_argument("--seed", type=int, default=5)
    parser.add_argument("--count", type=int, default=30)
    parser.add_argument("--radial", type=int, default=64, help="seed of the first radial row")
    parser.add_argument("--row", type=Path, help="Rotor 37 as a TOML file")
    parser.add_argument("--cells", type=int, nargs="*", default=[1_000_000, 1_600_000])
    parser.add_argument("--first", type=float, default=1e-4)
    options = parser.parse_args()
    text = HEAD.format(first=options.first, machine=processor())
    periodic = [0.0]
    if options.row:
        row = stack_of(str(options.row))
        assert isinstance(row, Row)
        for cells in options.cells:
            made, seconds = figures(row, RowRequest(first_cell=options.first, cells=cells, threads=1))
            text += line(made, seconds) + "\n"
            periodic.append(made.periodic)
    text += RANDOM.format(cells=RANDOM_CELLS, first=RANDOM_FIRST)
    groups: dict[str, Iterable[tuple[str, Callable[[], Row]]]] = {}
    if options.airfoils:
        drawn = drawn_rows(airfoils(options.airfoils), options.seed, options.count)
        groups["axial"] = ((each.words, partial(getattr, each, "row")) for each in drawn)
    seeds = range(options.radial, options.radial + RADIAL)
    groups["radial"] = ((f"radial row {seed}", partial(radial_row, seed)) for seed in seeds)
    for name, rows in groups.items():
        own, away = random_line(name, rows)
        text += own + "\n"
        periodic.append(away)
    publish(text + TAIL.format(periodic=max(periodic)), options.page)


if __name__ == "__main__":
    main()
