"""Nose and tail of a body on a level: a core in place of the pole, rows from there to a collar."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import arctan2, cos, sin
from meshonet.geometry.surface.pole_core import PoleCore, core_of
from meshonet.solvers.aircraft.collar_level import FEWEST, WIDEST, lines_between
from meshonet.solvers.rows.span_spacing import smooth_arcs, smooth_cells

_POLE_CELL = 0.5
"""Cells at nose and tail over those beside the collar."""


@dataclass(frozen=True, eq=False)
class BodyEnd:
    """Nose or tail: what all levels have in common there.

    Parameters
    ----------
    theta : (n,) angles of the lines out of the pole.
    core : what replaces the pole, in the plane of polar coordinates s, theta.
    at, step : s where the core's rows end, and its last step there.
    cells : number of cells from there to the collar.
    """

    theta: Floats
    core: PoleCore
    at: float
    step: float
    cells: int

    @classmethod
    def of(cls, levels: list[tuple[float, float]], lines: int) -> BodyEnd:
        """Return the end for ways from the pole to the collar, and cells there, of some levels."""
        way, last = levels[0]
        theta = np.linspace(0.0, np.pi, lines + 1)
        pole = _POLE_CELL * last
        count = smooth_cells(way, (pole, last), WIDEST, 2 * FEWEST)
        s = smooth_arcs(np.array([way]), (pole, last), count)[0]
        polar = np.stack(
            [s * cos(theta)[:, None], s * sin(theta)[:, None], np.zeros((len(theta), len(s)))], axis=-1
        )
        core = core_of(polar, 2, max(count // 2, 3), even=True)
        at, step = float(s[core.at]), float(s[core.at + 1] - s[core.at])
        cells = max(smooth_cells(far - at, (step, size), WIDEST, FEWEST) for far, size in levels)
        return cls(theta, core, at, step, cells)

    def patches(self, side: Floats, last: Floats) -> tuple[Floats, Floats]:
        """Return rows and core (., ., 3) from the pole to the `side` (n, 3) of a column, with `last` cells.

        Both are places whose s is counted from the pole.
        """
        far, zeta = side[:, 0], 0.5 * float(side[0, 2] + side[-1, 2])
        arcs = self.at + smooth_arcs(far - self.at, (self.step, last), self.cells)
        begin = np.stack([np.full(len(side), self.at), self.theta, np.full(len(side), zeta)], axis=1)
        lines = lines_between(arcs, begin, side)
        lines[:, -1, 0] = far
        rows = _polar(self.core.rows[:-1, :, :2], zeta).swapaxes(0, 1)
        rows[0, :, 1], rows[-1, :, 1] = 0.0, np.pi
        return np.concatenate([rows, lines], axis=1), _polar(self.core.nodes[..., :2], zeta)


def _polar(nodes: Floats, zeta: float) -> Floats:
    x, y = nodes[..., 0], nodes[..., 1]
    theta = arctan2(np.where(np.abs(y) < 1e-15, 0.0, y), x)
    return np.stack([np.sqrt(x * x + y * y), theta, np.full(x.shape, zeta)], axis=-1)
