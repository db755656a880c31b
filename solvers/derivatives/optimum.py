"""Derivatives of a grid x that solves F(x, b) = 0 by its boundary nodes b: dx = -F_x⁻¹ F_b db.

A functional with the derivative p by x has the derivative -F_bᵀ F_x⁻ᵀ p by b (adjoint method).
"""

from dataclasses import dataclass

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError, SolverError
from meshonet.kernels._native import variational_energy
from meshonet.solvers.derivatives.lattice import Equations, Jacobian, jacobian, shortest_edges
from meshonet.solvers.elliptic.winslow import left_side
from meshonet.solvers.energy.functional import Weights, aspect_of
from meshonet.solvers.sparse import Factor, SparseMatrix, SparsePattern

STEPS = 20  # of Newton's method, to the optimum itself
STILL = 1e-11  # largest displacement of a node, relative to its shortest edge, at which the iteration ends
_NEAR = 0.5  # displacement of a node, in its shortest edges, above which the grid is too far from the optimum
_SHIFT = 1e-9  # subtracted from the zero diagonal of the augmented system, so that it can be factored
_REFINED = 3  # steps of iterative refinement that make up for that
_REACH = {"variational": 2, "winslow": 1}  # nodes each way in the stencil of an equation


class OptimumDerivative:
    """The derivative of the interior nodes of a four-sided grid with respect to its boundary nodes.

    Parameters
    ----------
    grid : a grid near the solution for the same boundary nodes, so that Newton's method converges.
    method : the equations that inner nodes satisfy, ``variational`` or ``winslow``.
    weights : weights of the functional. None: the weights in the provenance of `grid`, or the defaults of
        `solve_pde`.

    Raises InputError if the grid is an O grid, a volume, or has several blocks, or if the method is unknown.
    Raises SolverError if the grid is far from the solution.
    """

    grid: Grid  # the converged solution

    def __init__(self, grid: Grid, method: str = "variational", weights: Weights | None = None) -> None:
        if grid.topology not in ("quad", "c"):
            raise InputError(f"topology {grid.topology}", "give a grid of one block whose rim is fixed")
        if method not in _REACH:
            problem = f"method {method!r} has no derivative"
            raise InputError(problem, "use variational or winslow", parameter="method")
        self._method, self._weights = method, weights or _weights(grid)
        nodes = np.array(np.moveaxis(grid.nodes, -1, 0), order="C")
        self._inner = np.arange(nodes.size).reshape(nodes.shape)[:, 1:-1, 1:-1].ravel()
        self._aspect = aspect_of(grid.nodes)
        self._systems = _Systems(self._inner, nodes.size, symmetric=method == "variational")
        self._approach(nodes)
        self.grid = grid.with_nodes(np.moveaxis(nodes, 0, -1))
        self._by_aspect = self._aspect_term(nodes)

    def along(self, moves: Floats) -> Floats:
        """Return the derivative (ni, nj, 2) of all nodes in the direction `moves` of the boundary nodes.

        `moves` has the shape (ni, nj, 2); its values at inner nodes are ignored.
        """
        rim = np.array(np.moveaxis(moves, -1, 0), dtype=np.float64, order="C")
        rim[:, 1:-1, 1:-1] = 0.0
        right = self._jacobian.times(rim.ravel())
        right += self._by_aspect * float(product(self._aspect_slope, rim.ravel()))
        rim.ravel()[self._inner] = -self._system.solve(right[self._inner])
        return np.ascontiguousarray(np.moveaxis(rim, 0, -1))

    def transposed(self, pull: Floats) -> Floats:
        """Return the derivative (ni, nj, 2) of a functional by the boundary nodes; it is zero at inner nodes.

        `pull` (ni, nj, 2) is the derivative of the functional by all nodes as independent variables.
        """
        flat = np.array(np.moveaxis(pull, -1, 0), dtype=np.float64, order="C")
        adjoint = np.zeros(flat.size)
        adjoint[self._inner] = self._system.solve(flat.ravel()[self._inner], transposed=True)
        back = self._jacobian.transposed_times(adjoint)
        back += self._aspect_slope * float(product(self._by_aspect, adjoint))
        result = flat - back.reshape(flat.shape)
        result[:, 1:-1, 1:-1] = 0.0
        return np.ascontiguousarray(np.moveaxis(result, 0, -1))

    def _approach(self, nodes: Floats) -> None:
        """Move `nodes` (2, ni, nj) to the solution by Newton's method, and linearise there.

        A Jacobian is kept while each step is less than a quarter of the one before.
        """
        edges, before, fresh = shortest_edges(nodes), np.inf, False
        for _ in range(STEPS):
            if not fresh and before > STILL * 1e3:
                self._linearise(nodes)
                fresh = True
            residual = self._equations(self._aspect)(nodes).ravel()[self._inner]
            move = np.zeros(nodes.size)
            move[self._inner] = -self._system.solve(residual)
            size = float((np.abs(move.reshape(nodes.shape)) / edges).max())
            if not size < _NEAR:
                problem = (
                    f"the grid is no solution by {self._method}: nodes move by {size:.2g} of their cells"
                )
                raise SolverError(problem)
            nodes += move.reshape(nodes.shape)
            if size < STILL:
                break
            fresh = fresh and size < 0.25 * before
            before = size
        self._linearise(nodes)

    def _equations(self, aspect: float) -> Equations:
        if self._method == "winslow":
            return winslow_residual
        terms = aspect, self._weights.shape, self._weights.smoothness, 0.0, False, None

        def gradient(nodes: Floats) -> Floats:
            values = np.empty_like(nodes)
            variational_energy(nodes, *terms, values)
            return values

        return gradient

    def _linearise(self, nodes: Floats) -> None:
        self._jacobian = jacobian(self._equations(self._aspect), nodes, _REACH[self._method])
        self._system = self._systems(self._jacobian)

    def _aspect_term(self, nodes: Floats) -> Floats:
        """Return the derivative of the equations by the aspect ratio a; that of a by the nodes is stored."""
        self._aspect_slope = np.zeros(nodes.size)
        if self._method == "winslow":
            return np.zeros(nodes.size)
        self._aspect_slope = aspect_slope(nodes).ravel()
        step = 1e-6 * self._aspect
        ahead, back = (self._equations(self._aspect + sign * step)(nodes) for sign in (1, -1))
        return np.asarray((ahead - back).ravel() / (2.0 * step))


def _weights(grid: Grid) -> Weights:
    from meshonet.solvers.energy.variational import WEIGHTS

    default = WEIGHTS[grid.topology]
    facts = grid.provenance if grid.provenance.get("method") == "variational" else {}
    return Weights(facts.get("shape", default.shape), facts.get("smoothness", default.smoothness))


def aspect_slope(nodes: Floats) -> Floats:
    """Return the derivative (2, ni, nj) of the aspect ratio `functional.aspect_of` by `nodes`."""
    slope = np.zeros_like(nodes)
    walls, sides = nodes[:, :, :: nodes.shape[2] - 1], nodes[:, :: nodes.shape[1] - 1]
    along, across = np.diff(walls, axis=1), np.diff(sides, axis=2)
    aspect = float(np.sqrt((across**2).mean() / (along**2).mean()))
    for way, axis, sign, view in (
        (along, 1, -1.0, slope[:, :, :: nodes.shape[2] - 1]),
        (across, 2, 1.0, slope[:, :: nodes.shape[1] - 1]),
    ):
        part = sign * aspect * way / (way**2).sum()
        first, last = [slice(None)] * 3, [slice(None)] * 3
        first[axis], last[axis] = slice(0, -1), slice(1, None)
        view[tuple(last)] += part
        view[tuple(first)] -= part
    return slope


def winslow_residual(nodes: Floats) -> Floats:
    """Return the residual of Winslow's equations at the `nodes` (2, ni, nj) of a grid; 0 on its boundary."""
    residual, middle = np.zeros_like(nodes), nodes[:, 1:-1, 1:-1]
    west, east = nodes[:, :-2, 1:-1], nodes[:, 2:, 1:-1]
    south, north = nodes[:, 1:-1, :-2], nodes[:, 1:-1, 2:]
    mixed = 0.25 * (nodes[:, 2:, 2:] - nodes[:, 2:, :-2] - nodes[:, :-2, 2:] + nodes[:, :-2, :-2])
    first = 0.5 * (east - west), 0.5 * (north - south)
    second = east - 2.0 * middle + west, mixed, north - 2.0 * middle + south
    residual[:, 1:-1, 1:-1] = left_side((*first, *second), lambda a, b: (a * b).sum(axis=0))[0]
    return residual


@dataclass(frozen=True, eq=False)
class _System:
    """The factored Jacobian of the equations with respect to the inner nodes."""

    matrix: SparseMatrix
    factor: Factor
    scale: Floats | None  # (n,) scaling of the equations; None for a symmetric system

    def solve(self, right: Floats, *, transposed: bool = False) -> Floats:
        """Return the solution (n,) of A x = right, or of Aᵀ x = right."""
        if self.scale is None:
            return self.factor.refine(self.matrix, right, 1)
        zero = np.zeros(len(right))
        if transposed:
            both = self.factor.refine(self.matrix, np.concatenate([zero, right]), _REFINED)
            return np.asarray(self.scale * both[: len(right)])
        both = self.factor.refine(self.matrix, np.concatenate([self.scale * right, zero]), _REFINED)
        return np.asarray(both[len(right) :])


class _Systems:
    """Makes systems of Jacobians of one sparsity pattern, for `inner` unknowns among `size` coordinates."""

    def __init__(self, inner: Indices, size: int, *, symmetric: bool) -> None:
        self._own = np.full(size, -1, dtype=np.intp)
        self._own[inner] = np.arange(len(inner))
        self._symmetric, self._n = symmetric, len(inner)
        self._pattern: SparsePattern | None = None

    def __call__(self, entries: Jacobian) -> _System:
        kept = self._own[entries.columns] >= 0
        rows, columns = self._own[entries.rows[kept]], self._own[entries.columns[kept]]
        values = entries.values[kept]
        if self._symmetric:
            lower = rows >= columns
            self._pattern = self._pattern or SparsePattern(self._n, rows[lower], columns[lower])
            matrix = self._pattern.matrix(values[lower])
            return _System(matrix, matrix.factor(), None)
        return self._augmented(rows, columns, values)

    def _augmented(self, rows: Indices, columns: Indices, values: Floats) -> _System:
        n, one, largest = self._n, np.arange(self._n), np.zeros(self._n)
        np.maximum.at(largest, rows, np.abs(values))
        scale = 1.0 / largest
        if self._pattern is None:
            places = (np.concatenate([one, rows, n + one]), np.concatenate([one, n + columns, n + one]))
            self._pattern = SparsePattern(2 * n, *places)
        entries = [np.concatenate([np.ones(n), scale[rows] * values, np.full(n, -s)]) for s in (0.0, _SHIFT)]
        return _System(self._pattern.matrix(entries[0]), self._pattern.factor(entries[1]), scale)
