"""Divides the inside of a closed curve into five blocks: a core, and a ring of four around it.

Corners of the core are on the diagonals, its sides bent towards arcs. Ring blocks count i along the wall,
counter-clockwise, and j away from it. The core is as large as the growth limit permits.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeAlias

import numpy as np

from meshonet.geometry.arrays import Floats, growth_ratios, norms
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.elementary import tan
from meshonet.solvers.sweeping.ring_steps import TRIED, fewest_rows, largest_ratio, ring_steps

GROWTH = 1.2  # default of the largest ratio of neighbouring cells away from walls
_BEND, _BEND_RADIAL = 0.25, 0.4  # of the core's sides, from 0, lines, to 1, arcs; the second for radial lines
# sizes of the core relative to the section; the first one that the growth limit permits is used
_SIZES = (0.6, 0.55, 0.5, 0.45, 0.4, 0.35, 0.3, 0.25, 0.2, 0.15, 0.1)
_ROUNDING = 1e-9  # of ratios, by which the limit may be exceeded
_RADIAL = (1.0, 0.75, 0.5, 0.25, 0.0)  # tried alignments with radii; 0 gives equal cells in the core

Sides: TypeAlias = Sequence[Floats]
"""Nodes (n, 2) on east, north, west and south of a closed curve, counter-clockwise."""


class FiveBlocks(NamedTuple):
    """Division of the inside of closed curves into a core and a ring of four blocks (butterfly grid)."""

    core: float  # relative size of the core
    rows: int  # rows of cells of the ring
    radial: float = 0.0  # alignment of the lines of the ring with radii, 0 to 1


@dataclass(frozen=True)
class CrossSection:
    """A closed curve whose inside is divided into a core block and four blocks around it."""

    arcs: Sides  # nodes on four sides that meet at corners of blocks
    first: float | None = None  # first-cell height at the wall; None: about that of the core's cells

    def inner(self, core: float, radial: float) -> list[Floats]:
        """Return the nodes (n, 2) on each side of the central block; for parameters, see `FiveBlocks`."""
        middle = np.concatenate([arc[:-1] for arc in self.arcs]).mean(axis=0)
        u = np.linspace(-1.0, 1.0, len(self.arcs[0]))
        t = (0.5 + 0.5 * ((1.0 - radial) * u + radial * tan(0.25 * np.pi * u)))[:, None]
        t[0], t[-1] = 0.0, 1.0
        lines = ((1.0 - t) * arc[0] + t * arc[-1] for arc in self.arcs)
        both = zip(lines, self.arcs, strict=True)
        bend = _BEND + (_BEND_RADIAL - _BEND) * radial
        return [middle + core * ((1.0 - bend) * line + bend * arc - middle) for line, arc in both]

    def across(self, core: float, radial: float, *, eighth: bool = False) -> tuple[Floats, Floats]:
        """Return lengths (k,) of lines from wall to core, and lengths (k,) of core cells that continue them.

        For `core` and `radial`, see `FiveBlocks`. `eighth`: only an eighth of the lines, enough for a circle.
        """
        inner = self.inner(core, radial)
        lengths = [norms(side - arc) for side, arc in zip(inner, self.arcs, strict=True)]
        last, first = slice(-2, -1), slice(1, 2)
        seconds = (
            _between(inner, rows=last)[0], _between(inner, columns=last)[::-1, 0],
            _between(inner, rows=first)[0, ::-1], _between(inner, columns=first)[:, 0],
        )  # fmt: skip
        sizes = []
        for side, second in zip(inner, seconds, strict=True):
            size = norms(second - side)
            size[0], size[-1] = size[1], size[-2]  # no line runs on from the corners
            sizes.append(size)
        if eighth:
            middle = len(lengths[0]) // 2 + 1
            return lengths[0][:middle], sizes[0][:middle]
        return np.concatenate(lengths), np.concatenate(sizes)


def planned(
    sections: Sequence[CrossSection], growth: float = GROWTH, rows: int | None = None, *, radial: bool = False
) -> FiveBlocks:
    """Return one division into blocks for all sections, in which cells grow by at most `growth`.

    If that is impossible, the growth ratio is the least possible. `rows` is the number of rows of cells in
    the ring, by default the smallest that suffices. `radial`, for circles, makes lines of the ring radial.
    """
    best, least = FiveBlocks(_SIZES[0], rows or 1), np.inf
    for core in _SIZES:
        way, inside = _most_radial(sections, core, growth) if radial else (0.0, 1.0)
        lines = [(*section.across(core, way, eighth=radial), section.first) for section in sections]
        for count in _counts(lines, growth) if rows is None else (rows,):
            steps = (largest_ratio(*line[:2], ring_steps(*line[:2], count, line[2])) for line in lines)
            largest = max(inside, *steps)
            if largest < least:
                best, least = FiveBlocks(core, count, way), largest
            if largest <= growth * (1.0 + _ROUNDING):
                return best
    return best


def _most_radial(sections: Sequence[CrossSection], core: float, growth: float) -> tuple[float, float]:
    """Return the best alignment with radii, and the growth along the core's sides."""
    for way in _RADIAL:
        inside = max(_side_ratio(section.inner(core, way)) for section in sections)
        if inside <= growth:
            break
    return way, inside


def _counts(lines: Sequence[tuple[Floats, Floats, float | None]], growth: float) -> Iterator[int]:
    fewest = max(fewest_rows(lengths, sizes, first, growth) for lengths, sizes, first in lines)
    yield from range(fewest, fewest + TRIED + 1)


def _side_ratio(sides: Sides) -> float:
    """Return the largest growth along the sides of a core."""
    return float(growth_ratios(np.stack([norms(np.diff(side, axis=0)) for side in sides])).max())


def filled(section: CrossSection, plan: FiveBlocks) -> Grid:
    """Return the grid of five blocks inside a closed curve; its boundary is the patch ``wall``."""
    side = len(section.arcs[0]) - 1
    inner = section.inner(plan.core, plan.radial)
    lengths, sizes = section.across(plan.core, plan.radial)
    steps = ring_steps(lengths, sizes, plan.rows, section.first)
    along = np.concatenate([np.zeros((len(steps), 1)), np.cumsum(steps, axis=1)], axis=1) / lengths[:, None]
    rings = []
    for k, (arc, end) in enumerate(zip(section.arcs, inner, strict=True)):
        own = along[k * (side + 1) : (k + 1) * (side + 1), :, None]
        ring = arc[:, None] + own * (end[:, None] - arc[:, None])
        ring[:, 0], ring[:, -1] = arc, end
        rings.append(ring)
    for k in range(4):  # the diagonals are those of the ring before, bitwise
        rings[(k + 1) % 4][0] = rings[k][-1]
    core = _core([ring[:, -1] for ring in rings])
    patches = tuple(Patch("wall", "south", 0, side, block=k) for k in range(1, 5))
    return Grid((Block(core), *map(Block, rings)), patches, _connections(side, plan.rows))


def _core(inner: Sides) -> Floats:
    """Return the nodes (n, n, 2) of the core; its sides are along x and y."""
    nodes = _between(inner)
    east, north, west, south = inner
    nodes[:, 0], nodes[:, -1], nodes[0], nodes[-1] = south, north[::-1], west[::-1], east
    return nodes


def _between(inner: Sides, rows: slice = slice(None), columns: slice = slice(None)) -> Floats:
    """Return transfinite nodes (n, n, 2) between the sides of the core, or only `rows` i or `columns` j."""
    east, north, west, south = inner[0], inner[1][::-1], inner[2][::-1], inner[3]
    a = np.linspace(0.0, 1.0, len(south))
    i, j = a[rows, None, None], a[None, columns, None]
    corners = (1 - i) * ((1 - j) * south[0] + j * north[0]) + i * ((1 - j) * south[-1] + j * north[-1])
    between = (1 - i) * west[None, columns] + i * east[None, columns]
    return np.asarray(between + (1 - j) * south[rows, None] + j * north[rows, None] - corners)


def _connections(side: int, rows: int) -> tuple[Connection, ...]:
    """Return the connections of the core, block 0, and the ring, blocks 1 (east) to 4 (south)."""
    core, away = ((0, side),), ((0, rows),)
    inner = (("east", 1), ("north", -1), ("west", -1), ("south", 1))
    joined = [
        Connection(0, name, core, k, "north", core, (way,))  # type: ignore[arg-type]
        for k, (name, way) in enumerate(inner, start=1)
    ]
    return (*joined, *(Connection(k, "east", away, k % 4 + 1, "west", away, (1,)) for k in range(1, 5)))
