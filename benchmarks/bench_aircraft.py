"""Grids around random bodies with a wing, judged apart from the product.

    python benchmarks/bench_aircraft.py --airfoils FOLDER [--count 60] [--page docs/benchmarks/aircraft.md]

`space_judge` computes the figures, `random_aircraft` draws the aircraft.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from clock import clocked
from numpy.typing import NDArray
from page import arguments, processor, publish
from random_aircraft import DrawnAircraft, drawn_aircraft, sections
from space_judge import first_errors, growth_ratios, judged_cells, off_normals

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.threads import limited_to
from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
from meshonet.solvers.aircraft.request import AircraftRequest

SEED = 3
AROUND, SPAN, FAR = 65, 25, 50.0
WALLS = ("fuselage", "wing", "tip")
EVEN = 1.3
HEAD = """# Bodies with a wing

<!-- made by python benchmarks/bench_aircraft.py --airfoils FOLDER --page docs/benchmarks/aircraft.md -->

Use this page to see for how many random aircraft `stack` makes a valid grid, and the quality and CPU time of
these grids. [A body with wings](../guide/aircraft.md) explains how to make such grids.

Each of {count} aircraft has a fuselage with a round nose and a slender tail, and a wing. Random properties:

| property | range |
| --- | --- |
| section of the wing | one of {files} real airfoils, 10 to 20 % thick |
| height of the wing | from half a body radius below the axis to half a body radius above it |
| taper, the chord of the tip over the chord of the root | 0.3 to 0.7 |
| sweep, dihedral | 0 to 30 degrees, 0 to 5 degrees |
| first-cell height | 1e-5 to 1e-3 chords of the root |

Grids have {around} nodes around the wing and {span} along the span, and a far field at {far:g} chords.

- *folded*: grids with a cell in which the Jacobian at a corner, or a Bezier coefficient of the Jacobian, is
  not positive. (If all Bezier coefficients are positive, the Jacobian is positive in the whole cell.)
- *least scaled Jacobian*: the smallest [scaled Jacobian](../reference/metrics.md#cells-of-volumes) of a cell
  of the grid. *relative error of first cells*: the largest relative error of a first-cell height.
- *growth*: share of the pairs of consecutive edges along grid lines, also from block to block, whose lengths
  differ by a factor of at most 1.3.
- *normals*: 95th percentile of the angle between a grid line that leaves a wall and the normal of the wall.
- *best*, *median* and *worst* are over the grids. For nodes and CPU times, *best* means the smallest.
- *CPU s*: one thread of {machine}, while other programs used the machine.

A grid was made for {made} of the {count} aircraft; {folded} of these grids have folded cells.
The largest distance between the two copies of a node that two blocks share is {seams:g}.

| metric | best | median | worst |
| --- | --- | --- | --- |
"""


@dataclass
class Figures:
    """Of the grid of one aircraft."""

    nodes: int
    folded: int
    seams: float
    scaled: float
    first: float
    growth: float
    normals: float
    seconds: float


def figures(drawn: DrawnAircraft) -> Figures:
    """Return the figures of the grid around an aircraft.

    Raises MeshonetError: it is refused.
    """
    with limited_to(1):
        request = AircraftRequest.of(
            around=AROUND, span=SPAN, first_cell=drawn.first, far_field=FAR, growth=1.2, threads=1
        )
        seconds, (grid, *_) = clocked(lambda: aircraft_grid(drawn.aircraft, request))
    blocks = [np.asarray(block.nodes) for block in grid.blocks]
    parts = [judged_cells(block) for block in blocks]
    growth = np.concatenate(list(growth_ratios(grid, blocks).values()))
    first = first_errors(grid, blocks, WALLS, np.array([drawn.first * drawn.aircraft.wing.chord]))
    return Figures(
        sum(int(np.prod(block.shape[:3])) for block in blocks),
        sum(part[2] + part[4] for part in parts),
        _seams(grid),
        min(float(part[0].min()) for part in parts),
        max(first.values()),
        float((growth <= EVEN).mean()),
        float(np.percentile(off_normals(grid, blocks, WALLS), 95)),
        seconds,
    )


def _seams(grid: Grid) -> float:
    pairs = (connection.nodes(grid.face) for connection in grid.connections)
    return max(float(np.abs(one - other).max()) for one, other in pairs)


def line(
    name: str, made: list[Figures], value: Callable[[Figures], float], form: str, *, high: bool = False
) -> str:
    """Return a line of the table: best, median and worst of a figure, of which `high` ones are good."""
    values: NDArray[np.float64] = np.sort([value(each) for each in made])
    if high:
        values = values[::-1]
    shown = (values[0], float(np.median(values)), values[-1])
    return "| " + " | ".join([name, *(format(each, form) for each in shown)]) + " |"


def page(made: list[Figures], count: int, files: int) -> str:
    """Return the page of the grids that were made."""
    head = HEAD.format(
        count=count, files=files, around=AROUND, span=SPAN, far=FAR, machine=processor(), made=len(made),
        folded=sum(each.folded > 0 for each in made), seams=max(each.seams for each in made),
    )  # fmt: skip
    row = partial(line, made=made)
    rows = (
        row("least scaled Jacobian", value=lambda each: each.scaled, form=".3f", high=True),
        row("relative error of first cells", value=lambda each: each.first, form=".0e"),
        row("growth of at most 1.3, %", value=lambda each: 100.0 * each.growth, form=".2f", high=True),
        row("normals, degrees", value=lambda each: each.normals, form=".1f"),
        row("nodes", value=lambda each: each.nodes, form=".0f"),
        row("CPU s", value=lambda each: each.seconds, form=".1f"),
    )
    return head + "\n".join(rows) + "\n"


def main() -> None:
    """Print the figures, and write the page."""
    parser = arguments(__doc__)
    parser.add_argument("--airfoils", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--count", type=int, default=60)
    options = parser.parse_args()
    airfoils = sections(options.airfoils)
    made = []
    for drawn in drawn_aircraft(airfoils, options.seed, options.count):
        try:
            made.append(figures(drawn))
            print(drawn.words, made[-1], flush=True)
        except MeshonetError as error:
            print(drawn.words, "is refused:", error, flush=True)
    publish(page(made, options.count, len(airfoils)), options.page)


if __name__ == "__main__":
    main()
