"""Volumes around random wings: folds, angles, first cells and time; blades and pipes beside them.

    python benchmarks/bench_wings.py --airfoils FOLDER [--count 60] [--page docs/benchmarks/wings.md]

Wings are pairs of the sections in FOLDER (``.dat`` files), with a taper of 0.25 to 1, a twist of -8 to 4
degrees, a sweep of -0.2 to 0.8 and a dihedral of -0.1 to 0.25 of the span, which is 1.5 to 4 chords.
"""

import os

for variable in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from page import arguments, processor, publish

from meshonet.formats.registry import read_shapes
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.curves.path import SplinePath
from meshonet.geometry.errors import MeshonetError, NoValidGridError
from meshonet.geometry.quality.measure import measure
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Kind, Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.summary import Quality
from meshonet.solvers.pipeline.stacks import make_stack
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.sweeping.disc import Disc, butterfly
from meshonet.solvers.sweeping.sweep import Sweep, sweep

SEED = 1
COARSE = {"around": 81, "span": 33, "layers": 49, "first_cell": 2e-5, "far_field": 12.0}
FINE = {"around": 129, "span": 57, "layers": 113, "first_cell": 1e-5}
ROWS: tuple[tuple[str, Kind, dict[str, float]], ...] = (
    ("wings, coarse", "wing", COARSE),
    ("wings, default", "wing", {}),
    ("wings, fine", "wing", FINE),
    ("blades", "blade", {"first_cell": 1e-5}),
)
NOTE = """
The default grids take more CPU time than the fine grids: their marching is repeated until the
cells grow by a factor of at most 1.2.
"""
HEAD = """# Volumes from sections: wings, blades, pipes

<!-- made by python benchmarks/bench_wings.py --airfoils FOLDER --page docs/benchmarks/wings.md -->

Use this page to find the quality and the CPU time of volume grids of random [wings](../guide/wings.md), of
random blades between two walls, and of three [pipes](../guide/pipes.md). Times are for one thread of
{machine}.

Each of {count} wings and {count} blades has two sections, drawn from {files} airfoil files. The taper is 0.25
to 1 and the twist -8 to 4 degrees. The tip is displaced by -0.2 to 0.8 spans downstream and by -0.1 to 0.25
spans upwards.

| name | nodes around a section | nodes along the span | nodes from the wall to the far field \
| first-cell height, chords | far field, chords |
| --- | --- | --- | --- | --- | --- |
| wings, coarse | 81 | 33 | 49 | 2e-5 | 12 |
| wings, default | 129 | 49 | for a growth ratio of 1.2 | 1e-3 | 15 |
| wings, fine | 129 | 57 | 113 | 1e-5 | 15 |
| blades | 129 | 49 or more | for a growth ratio of 1.2 | 1e-5 | 15 |

- *valid grids*: grids in which all corner Jacobians are positive.
- *first-cell error*: largest relative error of the first-cell height over all wall nodes; for blades, over
  the nodes of the two given sections of the blade.
- *scaled Jacobian*: smallest scaled Jacobian of a grid.
- *largest angle*: largest angle of the cell faces of a grid.
- *CPU time*: time to compute the grid and its quality report.

| grids | valid grids | nodes, median | first-cell error | scaled Jacobian: median / worst \
| largest angle, degrees: median / worst | CPU time, s: median / largest |
| --- | --- | --- | --- | --- | --- | --- |
"""


@dataclass
class Figures:
    """Of one grid."""

    nodes: int
    quality: Quality
    first: float
    seconds: float


def stack_of(sections: Sequence[Airfoil], generator: np.random.Generator, kind: Kind) -> Stack:
    """Return a random stack of two of the sections."""
    root, tip = (sections[k] for k in generator.integers(len(sections), size=2))
    span, sweep_, taper = (generator.uniform(*limits) for limits in ((1.5, 4.0), (-0.2, 0.8), (0.25, 1.0)))
    twist, dihedral = generator.uniform(-8.0, 4.0), generator.uniform(-0.1, 0.25)
    end = Section(tip, taper, span, x=sweep_ * span, y=dihedral * span, twist=twist)
    return Stack((Section(root, 1.0, 0.0), end), kind=kind)


def first_cell_error(grid: Grid, height: float, kind: Kind) -> float:
    """Return the largest relative error of first cells; blades are exact at their sections."""
    axis = 2 if kind == "wing" else 1
    worst = 0.0
    for block in grid.blocks:
        nodes = np.moveaxis(block.nodes, axis, 0)
        first = np.linalg.norm(nodes[1] - nodes[0], axis=-1)
        first = first if kind == "wing" else first[:, [0, -1]]
        worst = max(worst, float(np.abs(first / height - 1.0).max()))
    return worst


def timed(make: Callable[[], Grid], height: float, kind: Kind) -> Figures:
    """Return the figures of what `make` returns."""
    begun = time.process_time()
    grid = make()
    quality = measure(grid)
    seconds = time.process_time() - begun
    nodes = sum(int(np.prod(block.counts)) for block in grid.blocks)
    return Figures(nodes, quality, first_cell_error(grid, height, kind), seconds)


def row(name: str, count: int, made: Sequence[Figures]) -> str:
    """Return the line of a table for figures of several grids."""
    jacobian = [each.quality["scaled_jacobian"].min for each in made]
    angle = [each.quality["max_angle"].max for each in made]
    seconds, nodes = [each.seconds for each in made], [each.nodes for each in made]
    valid = sum(each.quality.folded == 0 for each in made)
    cells = (
        name, f"{valid} of {count}", f"{np.median(nodes):.0f}", f"{max(each.first for each in made):.0e}",
        f"{np.median(jacobian):.2f} / {min(jacobian):.2f}", f"{np.median(angle):.0f} / {max(angle):.0f}",
        f"{np.median(seconds):.2f} / {max(seconds):.2f}",
    )  # fmt: skip
    return "| " + " | ".join(cells) + " |"


def pipes() -> str:
    """Return the table of pipes."""
    t = np.linspace(0.0, 1.0, 65)
    turn = 1.5 * np.pi * t
    once, twice = 2.0 * np.pi * t, 4.0 * np.pi * t
    x, y = np.sin(once) + 2.0 * np.sin(twice), np.cos(once) - 2.0 * np.cos(twice)
    knot = np.stack([x, y, -np.sin(once + twice)], axis=1)
    knot[-1] = knot[0]
    paths = {
        "helix": (np.stack([2 * np.cos(6 * t), 2 * np.sin(6 * t), 3 * t], axis=1), 0.6),
        "bend, with a radius of 1.2 times the radius of the pipe": (
            np.stack([1.2 * np.cos(turn), 1.2 * np.sin(turn), 0 * t], axis=1),
            1.0,
        ),
        "knot, closed": (knot, 0.4),
    }
    lines = ["", "## Pipes", "",
             "A circle, divided into a square block and a ring of four blocks, is swept along each path.", "",
             "| path | folded cells | nodes | scaled Jacobian | largest angle, degrees | CPU time, ms |",
             "| --- | --- | --- | --- | --- | --- |"]  # fmt: skip
    for name, (points, radius) in paths.items():
        begun = time.process_time()
        grid = sweep(butterfly(Disc(radius, 1000, 0.01 * radius)), SplinePath(points), Sweep(planes=129))
        spent = 1e3 * (time.process_time() - begun)
        quality = measure(grid)
        nodes = sum(int(np.prod(block.counts)) for block in grid.blocks)
        jacobian, angle = quality["scaled_jacobian"].min, quality["max_angle"].max
        lines.append(f"| {name} | {quality.folded} | {nodes} | {jacobian:.2f} | {angle:.0f} | {spent:.0f} |")
    return "\n".join(lines)


def main() -> None:
    """Make the page."""
    parser = arguments(__doc__)
    parser.add_argument("--airfoils", required=True, help="folder of .dat files")
    parser.add_argument("--count", type=int, default=60)
    options = parser.parse_args()
    shapes = [next(read_shapes(str(path))) for path in sorted(Path(options.airfoils).glob("*.dat"))]
    sections = [shape for shape in shapes if isinstance(shape, Airfoil)]
    page = HEAD.format(count=options.count, files=len(sections), machine=processor())
    for name, kind, settings in ROWS:
        generator, made = np.random.default_rng(SEED), []
        for _ in range(options.count):
            stack = stack_of(sections, generator, kind)
            request = StackRequest(threads=1, **settings)  # type: ignore[arg-type]
            try:
                made.append(timed(lambda: make_stack(stack, request).grid, request.height(), kind))  # noqa: B023
            except (NoValidGridError, MeshonetError) as error:
                print(f"{name}: {stack.sections[0].shape.name}, {stack.sections[1].shape.name}: {error}")
        page += row(name, options.count, made) + "\n"
    page += NOTE + pipes() + "\n"
    publish(page, options.page)


if __name__ == "__main__":
    main()
