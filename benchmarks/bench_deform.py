"""Grids that follow random changes of their walls, beside inverse-distance weighting: folds, layers, time.

    python benchmarks/bench_deform.py --airfoils FOLDER [--bodies FOLDER] [--count 500]
        [--page docs/benchmarks/deform.md]

FOLDER of airfoils holds ``*.dat``; that of bodies the elements of a multi-element airfoil, one of them called
``*flap*.dat``, which is turned.
"""

import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from page import arguments, processor, publish

import meshonet
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import MeshonetError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.threads import limited_to
from meshonet.kernels._native import blend_motions
from meshonet.solvers.deformation.deform import deform
from meshonet.solvers.deformation.motions import Turning, affine, turns_in_plane
from meshonet.solvers.deformation.outer import NodeTable, elements_of, first_heights
from meshonet.solvers.deformation.sources import areas_of
from meshonet.solvers.deformation.targets import NewWall, targets_of

HEAD = """# Deformed grids, compared with inverse-distance weighting

<!-- made by python benchmarks/bench_deform.py --airfoils FOLDER --bodies FOLDER -->

Use this page to compare [`meshonet deform`](../guide/deform.md) with two published methods on random
deformations of plane grids (seed {seed}). CPU times are for one thread of {machine}.

Deformations:

- *sharp airfoils*, *blunt airfoils*: airfoils with a sharp and with a blunt trailing edge. The thickness is
  multiplied by 0.9 to 1.1, and the camber is changed by -2 to 2 % of the chord. The C grids have 250 x 100
  nodes, a second block behind a blunt trailing edge, and first cells of y+ = 1 at Reynolds number 6e6.
- *flap*: in a multi-block grid around slat, main element and flap, with about 20,000 cells, the flap is
  rotated by up to 10 degrees about a point near its leading edge.

Methods:

- *IDW*: inverse-distance weighting of the displacements of the boundary nodes, with weights r^-3 at the
  distance r (Witteveen, Bijl, AIAA 2009-3996).
- *IDW, rotations*: displacements and rotations, with weights r^-3 + c r^-5 and a constant c (Luke, Collins,
  Blades, J. Comput. Phys. 231 (2012) 586-601).
- *deform*: as *IDW, rotations*, but with weights r^-2 + c r^-4. Groups of distant boundary nodes are treated
  as one node. If cells are folded, `deform` repeats the deformation in several steps (here for {steps}
  deformations).

Columns:

- *first-cell change*: largest relative change of a first-cell height.
- *angle increase*: increase of the largest cell angle, in the worst grid.
- *CPU*: CPU time for a new grid in memory, median / 90th percentile.

"""
TAIL = """
- `deform` folds no cells. IDW folds cells in 22 grids, IDW with rotations in 16 grids.
- For sharp airfoils and the flap, `deform` changes first-cell heights by less than 1e-6.
- For blunt airfoils, all three methods change some first-cell heights near the corners of the trailing edge
  by more than 50 %.
- `deform` takes about a third of the CPU time of IDW for the airfoils, and four fifths for the flap.
"""
SEED = 20261122
COLUMNS = "deformations", "method", "folded grids", "first-cell change", "angle increase, degrees", "CPU, ms"


@dataclass(frozen=True, eq=False)
class Move:
    """A grid and the new place of a wall."""

    kind: str
    grid: Grid
    walls: Mapping[str, NewWall] | NewWall


@dataclass
class Figures:
    """Of one method over all moves of a kind."""

    folded: list[int]
    height: list[float]
    angle: list[float]
    seconds: list[float]

    def row(self, kind: str, name: str) -> tuple[str, ...]:
        """Return a row of the table."""
        median, late = (1000 * np.percentile(self.seconds, part) for part in (50, 90))
        return (
            kind, name, f"{np.count_nonzero(self.folded)} of {len(self.folded)}", f"{max(self.height):.1e}",
            f"{max(self.angle):.1f}", f"{median:.1f} / {late:.1f}",
        )  # fmt: skip


def sections(folder: Path) -> Iterator[tuple[Airfoil, Grid]]:
    """Yield sections and their viscous C grids."""
    for path in sorted(folder.glob("*.dat")):
        try:
            (section,) = meshonet.read_all(path)
            if isinstance(section, Airfoil):
                body = section.normalised()
                settings = {"res": (250, 100), "topology": "c", "y_plus": 1, "reynolds": 6e6}
                yield body, meshonet.grid(body, **settings)
        except MeshonetError as error:
            print(f"left out: {error}", file=sys.stderr)


def changed(body: Airfoil, random: np.random.Generator) -> Airfoil:
    """Return the section with another thickness and camber; raises InputError where it crosses itself."""
    points = body.curve.points[1 if body.blunt else 0 :]
    x, y = points.T
    nose = int(np.argmin(x))
    lower, upper = (np.argsort(x[part]) + part.start for part in (slice(0, nose + 1), slice(nose, len(x))))
    middle = 0.5 * (np.interp(x, x[lower], y[lower]) + np.interp(x, x[upper], y[upper]))
    thick, camber = random.uniform(0.9, 1.1), random.uniform(-0.02, 0.02)
    moved = middle + thick * (y - middle) + 4.0 * camber * x * (1.0 - x)
    return Airfoil(np.stack([x, moved], axis=1), body.name)


def moves(airfoils: Path, bodies: Path | None, count: int) -> Iterator[Move]:
    """Yield moves whose outlines are valid."""
    random = np.random.default_rng(SEED)
    known = list(sections(airfoils))
    flaps = 0 if bodies is None else count // 5
    valid = 0
    while valid < count - flaps:
        body, grid = known[valid % len(known)]
        try:
            shape = changed(body, random)
        except MeshonetError:
            continue
        yield Move(f"{'blunt' if body.blunt else 'sharp'} airfoils", grid, shape)
        valid += 1
    if bodies is None:
        return
    files = sorted(bodies.glob("*.dat"), reverse=True)
    grid = meshonet.grid([str(path) for path in files], assemble=True, first_cell=1e-5)
    (name,) = (path.stem for path in files if "flap" in path.stem)
    nose = min((p for line in _lines(grid, name) for p in line), key=lambda point: point[0])
    for _ in range(flaps):
        about = nose + random.uniform(-0.01, 0.01, 2)
        yield Move("flap", grid, {name: meshonet.rotation(random.uniform(-10, 10), tuple(about))})


def _lines(grid: Grid, name: str) -> list[Floats]:
    table = NodeTable.of(grid)
    return [table.nodes[piece.numbers] for piece in table.pieces if piece.patch.name == name]


def ours(move: Move) -> tuple[Grid, bool]:
    """Return the grid, and whether it took more than one step."""
    solution = deform(move.grid, move.walls)
    return solution.grid, bool(solution.path)


def weighted(move: Move, *, rotations: bool) -> tuple[Grid, bool]:
    """Return the grid by inverse-distance weighting over all boundary nodes."""
    table = NodeTable.of(move.grid)
    targets = targets_of(table, move.walls)
    nodes, outer = table.nodes, np.flatnonzero(table.outer)
    edges = elements_of(table.pieces, 2)
    area = areas_of(nodes, edges)[outer]
    turn = np.zeros(len(nodes))
    if rotations:
        moving = edges[targets.moved[edges].all(axis=1)]
        turn = Turning.of(nodes, moving).angles(nodes, targets.nodes)
    motion = affine(nodes[outer], targets.nodes[outer], turns_in_plane(turn[outer]))
    shifts = targets.nodes[outer] - nodes[outer]
    size = float(np.sqrt(((nodes - nodes.mean(axis=0)) ** 2).sum(axis=1).max()))
    stiff = max(0.1, 5.0 * float(np.abs(shifts - shifts.mean(axis=0)).max()) / size)
    inner = np.flatnonzero(~table.outer)
    moved = np.empty((3, len(inner)))
    near = size * stiff**2.5 if rotations else 0.0
    blend_motions(_in_space(nodes[outer]), area, _lifted(motion), near, _in_space(nodes[inner]), 1, moved)
    made = targets.nodes.copy()
    made[inner] += moved[:2].T
    return Grid(table.with_nodes(made), move.grid.patches, move.grid.connections), False


def _in_space(points: Floats) -> Floats:
    """Return points (n, 2) of the plane as (3, n): the kernel for space has the exponents 3 and 5."""
    return np.stack([*points.T, np.zeros(len(points))])


def _lifted(motion: Floats) -> Floats:
    """Return motions (6, n) of the plane as (12, n) of space."""
    space = np.zeros((12, motion.shape[1]))
    space[[0, 1, 3, 4, 6, 7]] = motion
    return space


METHODS: dict[str, Callable[[Move], tuple[Grid, bool]]] = {
    "deform": ours,
    "IDW": lambda move: weighted(move, rotations=False),
    "IDW, rotations": lambda move: weighted(move, rotations=True),
}


def judged(move: Move, made: Grid) -> tuple[int, float, float]:
    """Return folded cells, the largest change of a first cell and that of the largest angle."""
    table = NodeTable.of(move.grid)
    walls = [piece for piece in table.pieces if piece.patch.kind in ("wall", "other")]
    before, after = (first_heights(grid, walls) for grid in (move.grid, made))
    folded = sum(count_folded(block.nodes) for block in made.blocks)
    angles = [grid.quality()["max_angle"].max for grid in (move.grid, made)]
    return folded, float(np.abs(after / before - 1.0).max()), angles[1] - angles[0]


def measured(airfoils: Path, bodies: Path | None, count: int) -> tuple[list[tuple[str, ...]], int]:
    """Return the rows of the table, and how many moves took several steps."""
    figures: dict[tuple[str, str], Figures] = {}
    several = 0
    for move in moves(airfoils, bodies, count):
        for name, method in METHODS.items():
            begun = time.process_time()
            made, stepped = method(move)
            spent = time.process_time() - begun
            several += stepped
            folded, height, angle = judged(move, made)
            own = figures.setdefault((move.kind, name), Figures([], [], [], []))
            for values, value in zip(
                (own.folded, own.height, own.angle, own.seconds), (folded, height, angle, spent), strict=True
            ):
                values.append(value)  # type: ignore[arg-type]
    return [own.row(*key) for key, own in figures.items()], several


def table_of(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as a table."""
    lines = [COLUMNS, ["---"] * len(COLUMNS), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines) + "\n"


def main() -> None:
    """Measure, print, and write the page when asked."""
    parser = arguments(__doc__)
    parser.add_argument("--airfoils", type=Path, required=True)
    parser.add_argument("--bodies", type=Path)
    parser.add_argument("--count", type=int, default=500)
    options = parser.parse_args()
    with limited_to(1):
        rows, several = measured(options.airfoils, options.bodies, options.count)
    head = HEAD.format(seed=SEED, steps=several, machine=processor())
    publish(head + table_of(rows) + TAIL, options.page)


if __name__ == "__main__":
    main()
