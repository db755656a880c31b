"""Coordinates whose gradients fit the frames; along walls one is constant; at the cut they match."""

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats, Indices
from meshonet.geometry.elementary import exp, modulus, times
from meshonet.kernels._native import joined_classes
from meshonet.solvers.blocking.decomposition.field.frames import Frames
from meshonet.solvers.blocking.decomposition.surface.surface import NEXT
from meshonet.solvers.sparse import SparsePattern

_SOFT = 1e-8  # small value instead of zero in the matrix of the constraints, which permits redundant ones
_EXACT = 1e-14  # residual over the solution at which refinement ends: round-off
_REFINEMENTS = 6  # largest number of refinement steps, which remove the effect of `_SOFT`
_REAL = np.array([1.0, 0.0, -1.0, 0.0])  # real parts of the powers of i
_IMAGINARY = np.array([0.0, 1.0, 0.0, -1.0])  # imaginary parts of them


class Parametrisation:
    """Linear system for the coordinates w = u + i v of the vertices of a surface that is cut open.

    The solution minimises the sum over all triangles of area times weight (an argument of `solve`) times

        |grad u - s (cos theta, sin theta)|^2 + |grad v - s (-sin theta, cos theta)|^2

    Along each wall, u or v is constant, with an unknown value. Differences of w along one side of the cut
    equal the differences along the other side, rotated by a multiple of 90 degrees (Lagrange multipliers).
    This is the map of Bommes, Zimmer, Kobbelt (ACM Trans. Graph. 28 (2009) 77) without integer rounding.

    Parameters
    ----------
    frames : directions theta in the triangles, and the cut.
    sizes : (t,) lengths s of the gradients.
    """

    def __init__(self, frames: Frames, sizes: Floats) -> None:
        surface = frames.field.surface
        self.surface, self.sizes = surface, sizes
        self._wedges, self._count = frames.wedges, int(frames.wedges.max()) + 1
        self._number, self._size = self._unknowns(frames)
        places, self._values = self._stiffness()
        rows, columns, self._coefficients = self._conditions(frames)
        self._conditions_number = len(rows) and int(rows.max()) + 1
        below = np.arange(self._size, self._size + self._conditions_number)
        self._pattern = SparsePattern(
            self._size + self._conditions_number,
            np.concatenate([places[0], self._size + rows, below]),
            np.concatenate([places[1], columns, below]),
        )
        direction = sizes * exp(1j * frames.angles)
        shear = frames.field.shears[surface.triangles].mean(axis=1)
        self._wanted = sizes**2 * (1.0 - modulus(shear) ** 2)
        sheared = times(shear, np.conj(direction))
        wanted = direction - sheared, times(1j, direction + sheared)
        inner = [times(surface.areas[:, None] * np.conj(surface.gradients), g[:, None]) for g in wanted]
        self._right = np.stack([slopes.real for slopes in inner])

    def _unknowns(self, frames: Frames) -> tuple[Indices, int]:
        """Return the index (2, t, 3) of u and v of each corner among the unknowns, -1 for 0; their number."""
        triangle, edge = self.surface.walls
        along = np.where(frames.wall_axis % 2 == 0, self._count, 0)
        pairs = np.stack([self._wedges[triangle, edge] + along, self._wedges[triangle, NEXT[edge]] + along])
        label, count = joined_classes(np.ascontiguousarray(pairs.T), 2 * self._count)
        kept = np.ones(count, dtype=bool)
        kept[label[self._wedges[0, 0] + np.array([0, self._count])]] = False
        number = np.where(kept, np.cumsum(kept) - 1, -1)[label]
        both = np.stack([self._wedges, self._wedges + self._count])
        return number[both], int(kept.sum())

    def _stiffness(self) -> tuple[tuple[Indices, Indices], Floats]:
        """Return rows and columns (m,) of the entries, and their values (2, t, 6) for weights of 1."""
        surface, number = self.surface, self._number
        squares = surface.areas[:, None] * modulus(surface.gradients) ** 2
        row = np.concatenate([number, number], axis=2)
        column = np.concatenate([number, number[:, :, NEXT]], axis=2)
        values = np.concatenate([squares, surface.edge_weights], axis=1)
        values = np.where((row == column) & (np.arange(6) > 2), 2.0 * values, values)
        self._there = (row >= 0) & (column >= 0)
        return (row[self._there], column[self._there]), values

    def _conditions(self, frames: Frames) -> tuple[Indices, Indices, Floats]:
        """Return row, column and value of the conditions across the cut, two for each edge."""
        surface = self.surface
        triangle, edge = np.nonzero(frames.cut)
        neighbour, back = surface.neighbours[triangle, edge], surface.neighbour_edge[triangle, edge]
        once = triangle < neighbour
        triangle, edge, neighbour, back = (a[once] for a in (triangle, edge, neighbour, back))
        turn = frames.turns[triangle, edge]
        real, imaginary, unit = _REAL[turn], _IMAGINARY[turn], np.ones(len(turn))
        here = self._number[:, triangle, edge], self._number[:, triangle, NEXT[edge]]
        there = self._number[:, neighbour, NEXT[back]], self._number[:, neighbour, back]
        # u' = real u - imaginary v, v' = imaginary u + real v
        columns, values = [], []
        for part, (of_u, of_v) in enumerate(((real, -imaginary), (imaginary, real))):
            columns.append([there[0][part], there[1][part], here[0][0], here[1][0], here[0][1], here[1][1]])
            values.append([unit, -unit, -of_u, of_u, -of_v, of_v])
        column, value = np.array(columns), np.array(values)
        rows = np.arange(2 * len(turn)).reshape(2, 1, -1) + np.zeros((1, 6, 1), dtype=np.intp)
        kept = (column >= 0) & (value != 0.0)
        return rows[kept], column[kept].astype(np.intp), value[kept]

    def solve(self, weights: Floats) -> Complexes:
        """Return coordinates u + i v (t, 3) at the corners of t triangles, for triangle `weights` (t,)."""
        stiffness = (weights[:, None] * self._values)[self._there]
        values = np.concatenate([stiffness, self._coefficients])
        scale = 1.0 / max(float(np.abs(stiffness).mean()), 1e-300)
        exact = self._pattern.matrix(np.append(values, np.zeros(self._conditions_number)))
        factor = self._pattern.factor(np.append(values, np.full(self._conditions_number, -_SOFT * scale)))
        right = np.zeros(self._size + self._conditions_number)
        numbered = self._number >= 0
        pull = (weights[:, None] * self._right)[numbered]
        right[: self._size] = np.bincount(self._number[numbered], pull, self._size)
        solution = factor.solve(right)
        for _ in range(_REFINEMENTS):
            rest = right - exact.times(solution)
            solution += factor.solve(rest)
            if np.abs(rest).max() < _EXACT * np.abs(solution[: self._size]).max():
                break
        coords = np.where(numbered, solution[self._number], 0.0)
        return np.asarray(coords[0] + 1j * coords[1])

    def jacobians(self, coords: Complexes) -> Floats:
        """Return the map's Jacobian in each of t triangles, divided by that of the prescribed gradients.

        `coords` (t, 3) are u + i v at the corners of the triangles.
        """
        first, second = coords[:, 1] - coords[:, 0], coords[:, 2] - coords[:, 0]
        return np.asarray(times(np.conj(first), second).imag / (2.0 * self.surface.areas * self._wanted))
