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

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.growth import LARGEST, cells_for_growth, growing_steps

DEFAULT_CELLS = 320
_CORE, _BEND = 0.55, 0.25
_GROWTH = 1.2
_LEAST = 2
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
        if self.growth is not None and not 1.0 < self.growth <= LARGEST:
            problem = f"{self.growth:g}"
            raise InputError(problem, f"use more than 1 and at most {LARGEST:g}", parameter="growth")

    def rows(self, side: int) -> int:
        """Return the rows of the ring when the core has `side` cells along each side."""
        width = (1.0 - _CORE) * self.radius
        even = max(_LEAST, round(width / (self._edge(side))))
        if self.first_cell is None:
            return even
        return max(even, cells_for_growth(self.first_cell, width, self.growth or _GROWTH))

    def side(self) -> int:
        """Return the cells along a side of the core with which all cells are nearest to those wanted."""
        sides = range(_LEAST, 2 + int(np.sqrt(self.cells)))
        return min(sides, key=lambda n: abs(n * n + 4 * n * self.rows(n) - self.cells))

    def _edge(self, side: int) -> float:
        return 0.25 * np.pi * (1.0 + _CORE) * self.radius / side


def butterfly(disc: Disc) -> Grid:
    """Return the grid of a disc around the origin, its wall named ``wall``."""
    side = disc.side()
    rows = disc.rows(side)
    u = np.linspace(-1.0, 1.0, side + 1)
    arc = np.stack([np.cos(0.25 * np.pi * u), np.sin(0.25 * np.pi * u)], axis=1)
    straight = np.stack([np.ones(side + 1), u], axis=1) / np.sqrt(2.0)
    inner = disc.radius * _CORE * ((1.0 - _BEND) * straight + _BEND * arc)
    inner[0, 1], inner[-1, 1] = -inner[0, 0], inner[-1, 0]
    outer = disc.radius * arc
    along = _towards_core(disc, rows)
    ring = outer[:, None] + along[:, None] * (inner[:, None] - outer[:, None])
    ring[:, 0], ring[:, -1] = outer, inner
    rings = [np.ascontiguousarray(ring @ np.array(turn).T) for turn in _TURNS]
    for k in range(4):  # the diagonals are those of the ring before, bitwise
        rings[(k + 1) % 4][0] = rings[k][-1]
    east, north, west, south = (each[:, -1] for each in rings)
    core = _between(south, east, north[::-1], west[::-1])
    return Grid(
        (Block(core), *map(Block, rings)),
        tuple(Patch("wall", "south", 0, side, block=k) for k in range(1, 5)),
        _connections(side, rows),
        name="circle",
    )


def _towards_core(disc: Disc, rows: int) -> Floats:
    """Return places (rows + 1,) from the wall, 0, to the core, 1."""
    if disc.first_cell is None:
        return np.linspace(0.0, 1.0, rows + 1)
    width = (1.0 - _CORE) * disc.radius  # on the axes; a little more towards the corners of the core
    steps = growing_steps(min(disc.first_cell / width, 1.0 / rows), 1.0, rows)
    along = np.concatenate([[0.0], np.cumsum(steps)])
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
