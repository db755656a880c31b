"""Full approximation scheme for Winslow's equations in a volume, with semi-coarsening.

Only the directions with the shortest steps are coarsened; line relaxation in three directions is then
effective. Brandt, Math. Comp. 31 (1977) 333-390; Trottenberg, Oosterlee and Schüller, Multigrid (2001),
section 5.1.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.six_faces import SixFaces
from meshonet.geometry.threads import threads_for
from meshonet.kernels._native import combine_along, winslow_residual, winslow_room, winslow_smooth
from meshonet.solvers.volumes.interpolate import interpolate, uniform_laws

COARSEST = 9  # nodes along a direction that is not coarsened any more
ALIKE = 1.6  # a direction is coarsened when its steps are at most so many times the shortest
SOME = 3  # every third node along each direction tells how much a cycle has changed
SWEEPS, FIRST = 12, 30  # on the coarsest level: in a cycle, and to start with


@dataclass(frozen=True, eq=False)
class Transfer:
    """Interpolations along one direction between a multigrid level and the next coarser one.

    Each is a pair of arrays, with a row for each node that gets a value: the index of the first node that it
    is interpolated from, and the weights of that first node and of those after it.
    """

    up: tuple[NDArray[np.intp], Floats]  # (n, 2) linear interpolation to the fine nodes
    down: tuple[NDArray[np.intp], Floats]  # (m, terms) transpose of `up`, divided by the ratio of the steps
    at: tuple[NDArray[np.intp], Floats]  # (m, 4) cubic interpolation at the coarse nodes


class Level:
    """A multigrid level, and the transfer to the next coarser level along each direction."""

    def __init__(self, faces: SixFaces, *, coarse: bool) -> None:
        self.faces = faces
        start = interpolate(faces, uniform_laws(faces.counts))
        self.start = np.ascontiguousarray(np.moveaxis(start, -1, 0))
        self.residual = np.empty_like(self.start)
        self.right = np.zeros_like(self.start) if coarse else None
        self.threads = threads_for(self.start[0].size)
        self.room = np.empty(winslow_room(faces.counts, self.threads))
        self.transfers: list[Transfer | None] = []

    def smooth(self, x: Floats, sweeps: int, forced: bool, factor: float) -> None:
        """Relax x (3, ni, nj, nk) in place; the right-hand side is 0 unless `forced`."""
        for _ in range(sweeps):
            winslow_smooth(x, self.right if forced else None, factor, self.threads, self.room)

    def norm(self, x: Floats, forced: bool) -> float:
        """Store the residual of x (3, ni, nj, nk), return its norm; the right side is 0 unless `forced`."""
        right = self.right if forced else None
        return float(np.sqrt(winslow_residual(x, right, self.residual, self.threads, self.room)))


class VolumeMultigrid:
    """Multigrid cycles in a volume with `faces`; `sweeps` relaxations precede and follow coarser levels."""

    def __init__(self, faces: SixFaces, sweeps: int = 1, factor: float = 1.0) -> None:
        self.levels = [Level(faces, coarse=False)]
        self._sweeps, self._factor = sweeps, factor
        self._rooms: dict[tuple[int, str, int], Floats] = {}
        while (counts := _coarser(self.levels[-1].faces)) is not None:
            level = self.levels[-1]
            pairs = zip(level.faces.counts, counts, strict=True)
            level.transfers = [transfer(n, m) if n != m else None for n, m in pairs]
            self.levels.append(Level(level.faces.resampled(counts), coarse=True))

    def nested(self) -> tuple[Floats, float, float]:
        """Return x (3, ni, nj, nk) after a cycle on each level, from coarse to fine, and two numbers.

        The first number is the greatest difference of a coordinate between the two finest levels, about three
        times the discretisation error. The second is the greatest change of a coordinate in the last cycle.
        """
        last = len(self.levels) - 1
        x = self.levels[last].start.copy()
        self.levels[last].smooth(x, FIRST, False, self._factor)
        apart, change = 0.0, 0.0
        for depth in range(last - 1, -1, -1):
            level, coarse = self.levels[depth], x
            x = level.start.copy()
            self._moved(depth, "up", coarse - self.levels[depth + 1].start, x)
            if depth > 0:
                self._cycle(depth, x, False)
                continue
            change = self.cycle(x)[1]
            apart = float(np.abs(self._moved(depth, "at", x) - coarse).max())
        return x, apart, change

    def cycle(self, x: Floats) -> tuple[float, float]:
        """Run a V-cycle on `x` (3, ni, nj, nk), in place.

        Returns the norm of the residual before the cycle, and the greatest change of a coordinate, measured
        at every third node.
        """
        some = x[:, ::SOME, ::SOME, ::SOME]
        before = some.copy()
        norm = self._cycle(0, x, False)
        return norm, float(np.abs(some - before).max())

    def norm(self, x: Floats) -> float:
        """Return the norm of the residual of x (3, ni, nj, nk)."""
        return self.levels[0].norm(x, False)

    def _cycle(self, depth: int, x: Floats, forced: bool) -> float:
        level = self.levels[depth]
        if depth == len(self.levels) - 1:
            level.smooth(x, SWEEPS, forced, self._factor)
            return 0.0
        level.smooth(x, self._sweeps, forced, self._factor)
        norm = level.norm(x, forced)
        below = self.levels[depth + 1]
        coarse = self._moved(depth, "at", x)
        for side in range(3):
            ends = (slice(None),) * (side + 1)
            for end in (0, -1):  # the coarse level's own faces
                coarse[(*ends, end)] = below.start[(*ends, end)]
        before = coarse.copy()
        right = below.right
        if right is not None:
            below.norm(coarse, False)
            down = self._moved(depth, "down", level.residual)
            np.subtract(down, below.residual, out=right)
        self._cycle(depth + 1, coarse, True)
        np.subtract(coarse, before, out=before)
        self._moved(depth, "up", before, x)
        level.smooth(x, self._sweeps, forced, self._factor)
        return norm

    def _moved(self, depth: int, way: str, values: Floats, to: Floats | None = None) -> Floats:
        """Return values transferred to the next level, in reused memory; or add them to `to`."""
        fine, coarse = self.levels[depth].faces.counts, self.levels[depth + 1].faces.counts
        counts = fine if way == "up" else coarse
        order = (2, 1, 0) if way == "up" else (0, 1, 2)  # while arrays are short, or soon
        axes = [axis for axis in order if self.levels[depth].transfers[axis] is not None]
        for axis in axes:
            shape = (*values.shape[: axis + 1], counts[axis], *values.shape[axis + 2 :])
            add = to is not None and axis == axes[-1]
            result = to if add and to is not None else self._room(depth, way, axis, shape)
            first, weights = getattr(self.levels[depth].transfers[axis], way)
            combine_along(values, axis + 1, first, weights, add, threads_for(result.size), result)
            values = result
        return values

    def _room(self, depth: int, way: str, axis: int, shape: tuple[int, ...]) -> Floats:
        key = depth, way, axis
        if key not in self._rooms:
            self._rooms[key] = np.empty(shape)
        return self._rooms[key]


def transfer(n: int, m: int) -> Transfer:
    """Return the multigrid transfer between a level of n and a level of m < n equally spaced nodes."""
    at = np.arange(n) * ((m - 1) / (n - 1))
    first = np.minimum(at.astype(np.intp), m - 2)
    weights = np.stack([1.0 - (at - first), at - first], axis=1)
    weights[np.abs(weights) < 1e-12] = 0.0
    matrix = np.zeros((n, m))
    matrix[np.arange(n), first], matrix[np.arange(n), first + 1] = weights.T
    down = matrix.T * ((m - 1) / (n - 1))
    reached = down != 0
    terms = int(max((n - row[::-1].argmax() - row.argmax()) for row in reached))
    begin = np.minimum(reached.argmax(axis=1), n - terms)
    kept = np.take_along_axis(down, begin[:, None] + np.arange(terms), axis=1)
    places: Floats = np.arange(m, dtype=np.float64) * ((n - 1) / (m - 1))
    four = min(4, n)
    low = np.clip(places.astype(np.intp) - 1, 0, n - four)
    return Transfer(
        (first, weights), (begin, kept), (low, _lagrange(np.asarray(places - low, dtype=np.float64), four))
    )


def _lagrange(t: Floats, terms: int) -> Floats:
    """Return the weights (n, terms) of values at 0, 1, ... for their polynomial at t (n,)."""
    weights = np.ones((len(t), terms))
    for a in range(terms):
        for b in range(terms):
            if a != b:
                weights[:, a] *= (t - b) / (a - b)
    weights[np.abs(weights) < 1e-12] = 0.0
    return weights


def _coarser(faces: SixFaces) -> tuple[int, int, int] | None:
    """Return the node counts of the next coarser level, or None."""
    counts = faces.counts
    steps = []
    for axis in range(3):
        lengths = [norms(np.diff(edge, axis=0)).sum() for edge in faces.edges_along(axis)]
        steps.append(float(np.mean(lengths)) / (counts[axis] - 1))
    open_ = [axis for axis in range(3) if counts[axis] > COARSEST]
    if not open_:
        return None
    shortest = min(steps[axis] for axis in open_)
    halved = [axis for axis in open_ if steps[axis] <= ALIKE * shortest]
    ni, nj, nk = (n // 2 + 1 if axis in halved else n for axis, n in enumerate(counts))
    return ni, nj, nk
