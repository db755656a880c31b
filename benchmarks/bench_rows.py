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

Use this page to find the quality of grids of blade rows, and the CPU time to generate them. [Blade
rows](../guide/blade-rows.md) explains how to make such grids.

Rotor 37 is NASA's transonic compressor rotor, with its tip gap of 0.356 mm. The table has two grids of this
rotor with different `--cells`, first-cell heights of 1e-4 chords and a growth ratio of 1.2. The blade of a
random row is interpolated between two real airfoils, one at the hub and one at the casing. These properties
are random:

| property | range |
| --- | --- |
| stagger at mid-span | 0 to 65 degrees; at hub and casing it differs by up to 30 degrees |
| solidity (chord / distance between blades) at mid-span | 0.7 to 2 |
| ratio of hub radius to tip radius | 0.4 to 0.9 |
| channel | cylindrical, conical or curved |
| tip gap | up to 3 % of the span in two of three rows; the others have no gap |

Grids of random rows were made with `--cells {cells}`; they have more cells if their layers need more. Their
first-cell heights are {first:g} chords. Radial rows are centrifugal impellers, radial turbines, mixed-flow
pumps and vaned diffusers; about half of the impellers, turbines and pumps have a tip gap. The last two lines
of the table are for groups of rows. "30 of 30" means that all 30 rows have a valid grid; *nodes* and *CPU s*
are medians.

- *folded*: number of cells with a corner Jacobian of zero or less / number of cells in which a Bezier
  coefficient of the Jacobian is zero or less. If all these coefficients are positive, the Jacobian is
  positive everywhere in the cell.
- *SJ*: scaled Jacobian of cells: minimum / 0.1th percentile / mean. For groups of rows: median / smallest
  of the minima of the rows.
- *angle*: largest angle of the faces of a cell in degrees: maximum / 99.9th percentile. For groups of
  rows: median / largest of the maxima of the rows.
- *first cells*: largest relative error of a first-cell height, over all walls.
- *growth*: ratio of consecutive edges along all grid lines, also across block interfaces: 99th percentile
  / 99.9th percentile / maximum. For groups of rows: median of the 99.9th percentiles of the rows / largest
  ratio in all rows.
- *periodic*: largest distance between a node of the side `periodic2` and the corresponding node of
  `periodic1`, rotated by one pitch, divided by the radius.
- *blade*: largest distance of a blade node from the surface through the given profiles, in chords; not
  measured for groups.
- *CPU s*: CPU time in seconds, with one thread of {machine}, while other programs used the machine.

| grid | nodes | folded | SJ | angle | first cells | growth | periodic | blade | CPU s |
| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |
"""


def figures(row: Row, request: RowRequest, *, blade: bool = True) -> tuple[Judged, float]:
    """Return the figures of a row's grid, and CPU seconds."""
    begun = time.process_time()
    with limited_to(request.threads):
        grid, _ = row_grid(row, request)
    seconds = time.process_time() - begun
    return judge(grid, row, request.height() * row.chord, blade=blade), seconds


def line(name: str, made: Judged, seconds: float) -> str:
    """Return the line of the table for a grid."""
    growth = made.growths
    cells = (
        name, f"{made.nodes}", f"{made.folded_corners} / {made.folded_bezier}",
        f"{made.scaled.min():.3f} / {np.percentile(made.scaled, 0.1):.3f} / {made.scaled.mean():.3f}",
        f"{made.angle.max():.0f} / {np.percentile(made.angle, 99.9):.0f}", f"{max(made.first.values()):.0e}",
        f"{np.percentile(growth, 99):.3f} / {np.percentile(growth, 99.9):.3f} / {growth.max():.2f}",
        f"{made.periodic:.0e}", f"{made.blade:.0e}", f"{seconds:.1f}",
    )  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def summary(what: str, count: int, made: Sequence[tuple[Judged, float]]) -> str:
    """Return the line of the table for random rows, of which `made` are without folds."""
    judged, seconds = [each for each, _ in made], [spent for _, spent in made]
    scaled = [each.scaled.min() for each in judged]
    angles = [each.angle.max() for each in judged]
    cells = (
        f"{len(made)} of {count} {what}", f"{np.median([each.nodes for each in judged]):.0f}", "0 / 0",
        f"{np.median(scaled):.3f} / {min(scaled):.3f}", f"{np.median(angles):.0f} / {max(angles):.0f}",
        f"{max(max(each.first.values()) for each in judged):.0e}",
        f"{np.median([np.percentile(each.growths, 99.9) for each in judged]):.2f} / "
        f"{max(each.growths.max() for each in judged):.2f}",
        f"{max(each.periodic for each in judged):.0e}", "-",
        f"{np.median(seconds):.1f}",
    )  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def random_line(what: str, rows: Iterable[tuple[str, Callable[[], Row]]]) -> str:
    """Return the line of rows, by what they are; those that are refused or folded are printed."""
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
    return summary(what, count, made)


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
    rows = []
    if options.row:
        row = stack_of(str(options.row))
        assert isinstance(row, Row)
        for cells in options.cells:
            request = RowRequest(first_cell=options.first, cells=cells, threads=1)
            rows.append(line("Rotor 37", *figures(row, request)))
            print(rows[-1], flush=True)
    if options.airfoils:
        drawn = drawn_rows(airfoils(options.airfoils), options.seed, options.count)
        rows.append(
            random_line("random rows", ((each.words, partial(getattr, each, "row")) for each in drawn))
        )
        print(rows[-1], flush=True)
    seeds = range(options.radial, options.radial + RADIAL)
    rows.append(
        random_line("radial rows", ((f"radial row {seed}", partial(radial_row, seed)) for seed in seeds))
    )
    head = HEAD.format(cells=RANDOM_CELLS, first=RANDOM_FIRST, machine=processor())
    publish(head + "\n".join(rows) + "\n", options.page)


if __name__ == "__main__":
    main()
