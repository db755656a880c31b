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

Use this page to find the quality and the CPU time of volume grids around [a body with a
wing](../guide/aircraft.md), made by the command `meshonet stack`. The {count} bodies and wings are random.
Times are for one thread of {machine}.

Each body has a round nose and a slender tail. These properties are random:

| property | range |
| --- | --- |
| section of the wing | one of {files} real airfoils, 10 to 20 % thick |
| height of the wing | from half a body radius below the axis to half a body radius above it |
| taper (chord at the tip / chord at the root) | 0.3 to 0.7 |
| sweep | 0 to 30 degrees |
| dihedral | 0 to 5 degrees |
| first-cell height | 1e-5 to 1e-3 root chords |

Each grid has {around} nodes around the wing, {span} nodes along the span, and its far field at {far:g} root
chords.

- *scaled Jacobian*: smallest [scaled Jacobian](../reference/metrics.md#cells-of-volumes) of a grid.
- *first-cell error*: largest relative error of the first-cell heights of a grid.
- *even growth*: Take all pairs of adjacent edges on a grid line. The figure is the share of pairs whose
  longer edge is at most 1.3 times as long as the shorter. Grid lines continue from block to block.
- *angle to the wall normal*: angle between a grid line that leaves a wall and the wall normal; 95th
  percentile of a grid.

| quantity | best | median | worst |
| --- | --- | --- | --- |
"""
TAIL = """
- {made} of the {count} bodies with a wing have a grid, with {fewest:,} to {most:,} nodes.
- {valid} of these {made} grids have no folded cells: all Bezier coefficients of the Jacobian are positive, so
  the Jacobian is positive everywhere.
- Nodes of adjacent blocks match: their largest distance is {seams:g}.
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
        count=count, files=files, around=AROUND, span=SPAN, far=FAR, machine=processor()
    )  # fmt: skip
    row = partial(line, made=made)
    rows = (
        row("scaled Jacobian", value=lambda each: each.scaled, form=".3f", high=True),
        row("first-cell error", value=lambda each: each.first, form=".0e"),
        row("even growth, %", value=lambda each: 100.0 * each.growth, form=".2f", high=True),
        row("angle to the wall normal, degrees", value=lambda each: each.normals, form=".1f"),
        row("CPU time, s", value=lambda each: each.seconds, form=".1f"),
    )
    tail = TAIL.format(
        made=len(made), count=count, valid=sum(each.folded == 0 for each in made),
        seams=max(each.seams for each in made),
        fewest=min(each.nodes for each in made), most=max(each.nodes for each in made),
    )  # fmt: skip
    return head + "\n".join(rows) + "\n" + tail


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
