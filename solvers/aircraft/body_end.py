"""Nose and tail of a body on a level: a core at the pole, and rows from there to a collar."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.surface.pole_core import PoleCore, core_of
from meshonet.solvers.aircraft.collar_level import FEWEST, WIDEST
from meshonet.solvers.aircraft.level_lines import Points, Side, lines_between, ways_between
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells

_POLE_CELL = 0.5  # ratio of the cells at nose and tail to the cells beside the collar


@dataclass(frozen=True, eq=False)
class BodyEnd:
    """The part of the grid at the nose or the tail; s and theta of the nodes are equal on all levels."""

    theta: Floats  # (n,) angles of the lines from the pole, the tip of nose or tail
    core: PoleCore  # block that covers the pole, in a plane with polar coordinates s, theta
    at: float  # s at which the rows around the core end
    step: float  # last step of s in these rows
    cells: int  # number of cells from these rows to the next collar

    @classmethod
    def of(cls, points: Points, sides: Sequence[Side]) -> Self:
        """Return the end beside the first or last column of wings.

        `sides` are the nodes on the side of the column, on some levels, the first on the body. s is measured
        from the pole.
        """
        nodes, cells = sides[0]
        way, last = min((float(nodes[k, 0]), float(cells[k])) for k in (0, -1))
        theta = np.linspace(0.0, np.pi, len(sides[0][1]))
        pole = _POLE_CELL * last
        count = smooth_cells(way, (pole, last), WIDEST, 2 * FEWEST)
        s = smooth_arcs(np.array([way]), (pole, last), count)[0]
        polar = np.stack(
            [s * cos(theta)[:, None], s * sin(theta)[:, None], np.zeros((len(theta), len(s)))], axis=-1
        )
        core = core_of(polar, 2, max(count // 2, 3), even=True)
        end = cls(theta, core, float(s[core.at]), float(s[core.at + 1] - s[core.at]), 0)
        lines = [end._lines(*side) for side in sides]
        begin, side, first, cells = (np.concatenate(each) for each in zip(*lines, strict=True))
        return replace(
            end, cells=smooth_cells(*ways_between(points, begin, side, (first, cells)), WIDEST, FEWEST)
        )

    def _lines(self, side: Floats, last: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        """Return begin and end (n, 3) of lines to a `side` (n, 3), and their end cells (n,) in s."""
        zeta = 0.5 * float(side[0, 2] + side[-1, 2])
        begin = np.stack([np.full(len(side), self.at), self.theta, np.full(len(side), zeta)], axis=1)
        return begin, side, np.full(len(side), self.step), last

    def patches(self, points: Points, side: Floats, last: Floats) -> tuple[Floats, Floats]:
        """Return two patches (., ., 3), rows and core, between the `side` (n, 3) of a column and the pole.

        `last` (n,) are the lengths in s of the cells at the side. Nodes are s, theta, zeta, with s from the
        pole; `points` maps nodes to space.
        """
        begin, end, *sizes = self._lines(side, last)
        lines = lines_between(points, begin, end, (sizes[0], sizes[1]), self.cells)
        zeta = float(begin[0, 2])
        rows = _polar(self.core.rows[:-1, :, :2], zeta).swapaxes(0, 1)
        rows[0, :, 1], rows[-1, :, 1] = 0.0, np.pi
        return np.concatenate([rows, lines], axis=1), _polar(self.core.nodes[..., :2], zeta)


def _polar(nodes: Floats, zeta: float) -> Floats:
    x, y = nodes[..., 0], nodes[..., 1]
    theta = arctan2(np.where(np.abs(y) < 1e-15, 0.0, y), x)
    return np.stack([np.sqrt(x * x + y * y), theta, np.full(x.shape, zeta)], axis=-1)
