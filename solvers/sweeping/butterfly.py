r"""The inside of a circle in five blocks: a core, and a ring of four around it.

::

         .-----------.          Corners of the core lie on the diagonals, and its sides are bent outwards, a
       .' \         / '.        quarter of the way from lines to arcs, so that no corner is far from a right
      /    +-------+    \       angle: 120 degrees, which three blocks that meet cannot stay below.
      |    |  core |    |
      \    +-------+    /       Ring blocks count i along the wall, counter-clockwise, and j away from it.
       '. /         \ .'
         '-----------'
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.elementary import cos, product, sin
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import cells_for_growth, check_growth, growing_steps

DEFAULT_CELLS = 320  # of a disc
CORE, _BEND = 0.55, 0.25
"""Size of the core in sizes of the section, and how far its sides are bent from lines, 0, to arcs, 1."""
_GROWTH = 1.2  # ratio of cells from the wall inwards, where the first one is given and no ratio
_LEAST = 2  # cells along a side of the core, and rows around it
# quarter turns: east, north, west, south
_TURNS = (((1, 0), (0, 1)), ((0, -1), (1, 0)), ((-1, 0), (0, -1)), ((0, 1), (-1, 0)))


@dataclass(frozen=True)
class Disc:
    """A circle and its cells.

    Parameters
    ----------
    radius : in any unit.
    cells : about how many.
    first_cell : height of the cells at the wall; None makes them about as long as they are wide.
    growth : largest ratio of neighbouring cells away from the wall.

    Raises InputError: a value that is not positive, a first cell wider than the ring.
    """

    radius: float
    cells: int = DEFAULT_CELLS
    first_cell: float | None = None
    growth: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.radius < 1e12:
            raise InputError(f"a circle of radius {self.radius:g}", "use more than 0")
        if not 12 <= self.cells <= 10_000_000:
            raise InputError(f"{self.cells} cells", "use 12 to 10 million", parameter="cells")
        if self.first_cell is not None and not 1e-9 < self.first_cell / self.radius < 0.2:
            problem = f"{self.first_cell:g} in a circle of radius {self.radius:g}"
            raise InputError(problem, "use up to a fifth of the radius", parameter="first_cell")
        check_growth(self.growth)

    def rows(self, side: int) -> int:
        """Return the rows of the ring when the core has `side` cells along each side."""
        edge = 0.25 * np.pi * (1.0 + CORE) * self.radius / side
        return ring_rows((1.0 - CORE) * self.radius, edge, self.first_cell, self.growth)

    def side(self) -> int:
        """Return the cells along a side of the core with which all cells are nearest to those wanted."""
        sides = range(_LEAST, 2 + int(np.sqrt(self.cells)))
        return min(sides, key=lambda n: abs(n * n + 4 * n * self.rows(n) - self.cells))


def ring_rows(width: float, edge: float, first: float | None, growth: float | None) -> int:
    """Return the rows of a ring so wide, of cells as long as `edge`; they may begin with a height `first`."""
    even = max(_LEAST, round(width / edge))
    return even if first is None else max(even, cells_for_growth(first, width, growth or _GROWTH))


def butterfly(disc: Disc) -> Grid:
    """Return the grid of a disc around the origin, its wall named ``wall``."""
    side = disc.side()
    rows = disc.rows(side)
    u = np.linspace(-1.0, 1.0, side + 1)
    arc = disc.radius * np.stack([cos(0.25 * np.pi * u), sin(0.25 * np.pi * u)], axis=1)
    arcs = [product(arc, np.array(turn).T) for turn in _TURNS]
    first = None if disc.first_cell is None else disc.first_cell / ((1.0 - CORE) * disc.radius)
    return replace(filled(arcs, rows, first), name="circle")


def filled(arcs: Sequence[Floats], rows: int, first: float | None = None) -> Grid:
    """Return the five blocks inside a closed curve, its wall named ``wall``.

    `arcs` are its nodes (n, 2) on the east, north, west and south, counter-clockwise, that meet in corners of
    blocks. The ring has `rows` cells across, of which the first is as high as `first` says, in widths of the
    ring; None makes them equal.
    """
    side, middle = len(arcs[0]) - 1, np.concatenate([arc[:-1] for arc in arcs]).mean(axis=0)
    t = np.linspace(0.0, 1.0, side + 1)[:, None]
    along = _towards_core(rows, first)
    rings = []
    for arc in arcs:
        lines = (1.0 - t) * arc[0] + t * arc[-1]
        inner = middle + CORE * ((1.0 - _BEND) * lines + _BEND * arc - middle)
        ring = arc[:, None] + along[:, None] * (inner[:, None] - arc[:, None])
        ring[:, 0], ring[:, -1] = arc, inner
        rings.append(ring)
    for k in range(4):  # the diagonals are those of the ring before, bitwise
        rings[(k + 1) % 4][0] = rings[k][-1]
    east, north, west, south = (each[:, -1] for each in rings)
    core = _between(south, east, north[::-1], west[::-1])
    patches = tuple(Patch("wall", "south", 0, side, block=k) for k in range(1, 5))
    return Grid((Block(core), *map(Block, rings)), patches, _connections(side, rows))


def _towards_core(rows: int, first: float | None) -> Floats:
    """Return places (rows + 1,) from the wall, 0, to the core, 1."""
    if first is None:
        return np.linspace(0.0, 1.0, rows + 1)
    along = np.concatenate([[0.0], np.cumsum(growing_steps(min(first, 1.0 / rows), 1.0, rows))])
    along[-1] = 1.0
    return along


def _between(south: Floats, east: Floats, north: Floats, west: Floats) -> Floats:
    """Return nodes (n, n, 2) by transfinite interpolation; sides run along x and along y."""
    a = np.linspace(0.0, 1.0, len(south))
    i, j = a[:, None, None], a[None, :, None]
    corners = (1 - i) * ((1 - j) * south[0] + j * north[0]) + i * ((1 - j) * south[-1] + j * north[-1])
    nodes = (1 - i) * west[None] + i * east[None] + (1 - j) * south[:, None] + j * north[:, None] - corners
    nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1] = south, north, west, east
    return np.asarray(nodes)


def _connections(side: int, rows: int) -> tuple[Connection, ...]:
    """Return how the core, block 0, and the ring blocks, 1 east to 4 south, counter-clockwise, join."""
    core, away = ((0, side),), ((0, rows),)
    inner = (("east", 1), ("north", -1), ("west", -1), ("south", 1))
    joined = [
        Connection(0, name, core, k, "north", core, (way,))  # type: ignore[arg-type]
        for k, (name, way) in enumerate(inner, start=1)
    ]
    return (*joined, *(Connection(k, "east", away, k % 4 + 1, "west", away, (1,)) for k in range(1, 5)))
