"""Full multigrid with FAS V-cycles for Winslow's system; the smoother is alternating zebra line relaxation.

Brandt, Math. Comp. 31 (1977) 333-390; Trottenberg, Oosterlee, Schüller, Multigrid (2001), chapters 5 and 8.
"""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, planar_nodes
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import MultigridLevel, multigrid_scratch
from meshonet.solvers.algebraic.tfi import Four, interpolate, parameters
from meshonet.solvers.elliptic.coarsening import Direction, uniform
from meshonet.solvers.elliptic.control import Controls
from meshonet.solvers.elliptic.corner_relaxation import CornerPatch, patches, reentrant


@dataclass(frozen=True)
class Settings:
    """Parameters of multigrid cycles."""

    # a direction with this many cells or fewer is not coarsened further. 8 is too few for airfoils, 50 slow.
    coarsest: int = 16
    sweeps: int = 1  # relaxation sweeps before and after the coarse correction


class Multigrid:
    """Multigrid levels for planar `nodes` (ni, nj, 2) inside `edges` (south, north, west, east).

    `nodes` belong to the finest level. They are changed in place; their initial values do not matter.
    `periodic` means an O grid.
    """

    def __init__(
        self, nodes: Floats, edges: Four, periodic: bool, settings: Settings | None = None,
        controls: Controls | None = None,
    ) -> None:  # fmt: skip
        self.settings = settings or Settings()
        self.levels: list[MultigridLevel] = []
        self._edges: list[Four] = []
        self._along: list[Four] = []
        self._directions: list[tuple[Direction, Direction]] = []
        self._patches: list[list[CornerPatch]] = []
        corners = [] if periodic else reentrant(edges)
        along = parameters(edges, "arclength")
        xi = uniform(nodes.shape[0], periodic)
        eta = uniform(nodes.shape[1], False)
        threads = threads_for(nodes[..., 0].size)
        scratch = np.empty(multigrid_scratch(xi.cells, eta.cells, threads))
        while True:
            if self.levels:
                nodes = planar_nodes(xi.cells + 1, eta.cells + 1)
            planes = nodes[..., 0], nodes[..., 1]
            coarse = bool(self.levels)
            weights, threads = (xi.differences, eta.differences), threads_for(planes[0].size)
            level = MultigridLevel(*planes, *weights, periodic, scratch, coarse, threads)
            self.levels.append(level)
            self._patches.append(patches(level, xi, eta, corners, scratch))
            self._edges.append(edges)
            self._along.append(along)
            self._directions.append((xi, eta))
            if min(xi.cells, eta.cells) <= max(self.settings.coarsest, 7):
                break
            level.transfer(xi.transfer, eta.transfer)
            edges, along = _thinned(edges, xi, eta), _thinned(along, xi, eta)
            xi, eta = xi.coarse, eta.coarse
        if controls is not None:
            self.control(controls)

    def control(self, controls: Controls) -> None:
        """Set the control functions on all levels; there is then no local relaxation at corners."""
        self._patches = [[] for _ in self.levels]
        phi, psi = controls.phi, controls.psi
        for k, (level, (xi, eta)) in enumerate(zip(self.levels, self._directions, strict=True)):
            if k > 0:
                finer = self._directions[k - 1]
                i, j = finer[0].kept, finer[1].kept
                phi, psi = phi.kept(i, j), psi.kept(i, j)
            level.control((phi.along, phi.across), (psi.along, psi.across), xi.reach, eta.reach)

    def interpolate_edges(self, k: int) -> None:
        """Set the nodes of level `k` to the transfinite interpolation of its edges."""
        level = self.levels[k]
        interpolate(level.x, level.y, self._edges[k], self._along[k])

    def residual(self, k: int = 0) -> float:
        """Return the root mean square residual of Winslow's equations on level `k` (right-hand side 0)."""
        level = self.levels[k]
        return float(np.sqrt(level.residual(False) / level.x.size))

    def nested_iteration(self) -> float:
        """Set the nodes to a first solution, by nested iteration from the coarsest level to the finest.

        Returns a reference for later residuals: that of transfinite interpolation on the finest level.
        """
        last = len(self.levels) - 1
        self.interpolate_edges(last)
        start = self.residual(last)
        self._relax_coarsest(False, 1e-4, 100)
        for k in range(last - 1, -1, -1):
            fine, coarse = self.levels[k], self.levels[k + 1]
            interpolate(coarse.x0, coarse.y0, self._edges[k + 1], self._along[k + 1])
            self.interpolate_edges(k)
            if k == 0:
                start = self.residual()
            fine.correct(coarse)
            if k > 0:
                self.cycle(k)
        return start

    def cycle(self, k: int = 0, forced: bool = False) -> float:
        """Run one V-cycle from level `k`; return the root mean square of the coarse correction, a length.

        This length estimates the error before the cycle; on the coarsest level it is 0. If not `forced`, the
        right-hand side is 0.
        """
        if k == len(self.levels) - 1:
            self._relax_coarsest(forced, 1e-2, 10)
            return 0.0
        fine, coarse = self.levels[k], self.levels[k + 1]
        self._smooth(k, forced)
        fine.restrict(coarse, forced)
        self.cycle(k + 1, True)
        correction = float(np.sqrt(fine.correct(coarse) / coarse.x.size))
        self._smooth(k, forced)
        return correction

    def _smooth(self, k: int, forced: bool) -> None:
        self.levels[k].smooth(forced, self.settings.sweeps)
        for patch in self._patches[k]:
            patch.smooth(forced)

    def _relax_coarsest(self, forced: bool, reduction: float, rounds: int) -> None:
        level = self.levels[-1]
        goal = 0.0
        for k in range(rounds):
            level.smooth(forced, 4)
            residual = level.residual(forced)
            if k == 0:
                goal = reduction**2 * residual
            elif not residual > goal:  # reached, or not a number
                return


def relax(nodes: Floats, sweeps: int) -> None:
    """Relax the inner nodes of planar `nodes` (ni, nj, 2) in place by `sweeps` sweeps, on a single level."""
    xi, eta = (uniform(n, False).differences for n in nodes.shape[:2])
    scratch = np.empty(multigrid_scratch(nodes.shape[0] - 1, nodes.shape[1] - 1))
    MultigridLevel(nodes[..., 0], nodes[..., 1], xi, eta, False, scratch, False).smooth(False, sweeps)


def _thinned(four: Four, xi: Direction, eta: Direction) -> Four:
    south, north, west, east = four
    i, j = xi.kept, eta.kept
    return south[i], north[i], west[j], east[j]
