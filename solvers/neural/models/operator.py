"""An operator of the MeshONet paper's kind, trained on solved grids and evaluated at any nodes."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Self

import numpy as np

from meshonet.geometry.arrays import TOPOLOGIES, Floats, as_planar
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.algebraic.resample.grids import thinned
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.conformal.chebyshev import barycentric, points, weights
from meshonet.solvers.conformal.harmonic import extend
from meshonet.solvers.conformal.solve import Polish
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.architectures import architecture, name_of, settings_of
from meshonet.solvers.neural.models.layers import Weights
from meshonet.solvers.neural.models.sensors import square
from meshonet.solvers.neural.operator import Operator
from meshonet.solvers.solution import Solution

DIRECT = 129 * 129  # nodes up to which a network is evaluated at each; more are interpolated if exact
TABLE = 65  # Chebyshev points along xi and eta that are interpolated between
CLOSE = 1e-6  # largest error of that interpolation, relative to the answer, at places between its points


@dataclass(frozen=True)
class PaperOperator(Operator):
    """A trained model with one of the architectures in `ARCHITECTURES`."""

    batched: ClassVar[bool] = False

    model: Architecture = field(default_factory=Architecture)  # what it is and what it was trained on
    frame: Frame = field(default_factory=lambda: Frame("quad", 2, 2))
    weights: Weights = field(default_factory=dict)  # trained and fixed arrays, float32

    @classmethod
    def of_file(cls, name: str, header: Mapping[str, Any], arrays: dict[str, Floats]) -> Self:
        """Return the operator from the header and the arrays of a model file."""
        topology = header["topology"]
        frame = Frame(topology, int(header["ni"]), int(header["nj"]), int(header.get("count", 0)))
        if topology not in TOPOLOGIES or not 2 <= min(frame.ni, frame.nj) <= max(frame.ni, frame.nj) <= 4096:
            raise ValueError("topology or size")
        model = architecture(header["model"], topology, header["settings"])
        if any(arrays[key].shape != shape for key, shape in model.shapes(frame).items()):
            raise ValueError("shapes")
        single = {key: array.astype(np.float32) for key, array in arrays.items()}
        operator = cls(name, topology, header, model, frame, single)
        operator._try()
        return operator

    def facts(self) -> dict[str, Any]:
        """Return the header entries of the model file that describe the model."""
        frame, facts = self.frame, {"model": name_of(self.model), "settings": settings_of(self.model)}
        return {**facts, "topology": frame.topology, "ni": frame.ni, "nj": frame.nj, "count": frame.count}

    def solve(
        self, boundaries: Sequence[Boundary], polish: Polish = "auto", *, paste: bool = True, **_: Any
    ) -> list[Solution]:
        """Return a grid inside each boundary, computed one by one; `polish` has no effect."""
        self.check(boundaries)
        return [self._solved(boundary, paste=paste) for boundary in boundaries]

    def _solved(self, boundary: Boundary, *, paste: bool) -> Solution:
        begun = time.perf_counter()
        nodes, error = self.nodes(boundary, paste=paste)
        spent = time.perf_counter() - begun
        facts = {"method": "operator", "model": self.name, "boundary_error": error}
        grid = boundary.grid(nodes, facts)
        done = "replaced by the true one" if paste else "left so"
        off = (f"the network's own boundary was off by {error:.1e} at most, and was {done}",)
        notes = off if error > 0.0 else ()
        return Solution(grid, "operator", model=self.name, seconds={"grid": spent}, notes=notes)

    def nodes(self, boundary: Boundary, *, paste: bool = True) -> tuple[Floats, float]:
        """Return nodes (ni, nj, 2), and the greatest distance of predicted boundary nodes from `boundary`.

        With `paste`, nodes of `boundary` replace predicted boundary nodes. Otherwise, only the two sides of
        the cut of an O grid are made equal.
        """
        answer = self.difference(boundary)
        if self.model.base == "harmonic":
            answer += extend(boundary)
        nodes = as_planar(answer)
        edges = [(nodes[:, 0], boundary.south), (nodes[:, -1], boundary.north)]
        if boundary.periodic:
            nodes[-1] = nodes[0]
        else:
            edges += [(nodes[0], boundary.west), (nodes[-1], boundary.east)]
        error = max(float(np.hypot(*(edge - true).T).max()) for edge, true in edges)
        if paste:
            for edge, true in edges:
                edge[:] = true
        return nodes, error

    def difference(self, boundary: Boundary) -> Floats:
        """Return the network's output (ni, nj, 2) at the nodes: the predicted grid minus the base grid.

        Raises InputError if `boundary` has another topology than the training grids.
        """
        self.check([boundary])
        ni, nj = boundary.ni, boundary.nj
        # a native model answers on the nodes of the training grids, so these are the ones it sees
        known, frame = boundary, self.frame
        if self.model.native and (ni, nj) != (frame.ni, frame.nj):
            known = thinned(boundary, frame.ni, frame.nj)
        inputs = {name: value.astype(np.float32) for name, value in self.model.encode([known]).items()}
        self.model.check(self.weights, inputs)
        if self.model.native:
            return self._splined(inputs, ni, nj)
        if ni * nj > DIRECT:
            nodes = self._interpolated(inputs, ni, nj)
            if nodes is not None:
                return nodes
        rows = max(1, DIRECT // nj)
        where = square(ni, nj).reshape(ni, nj, 2)
        parts = [self._at(inputs, where[k : k + rows].reshape(-1, 2)) for k in range(0, ni, rows)]
        return np.concatenate(parts).reshape(ni, nj, 2)

    def _at(self, inputs: Weights, where: Floats) -> Floats:
        seen = self.model.seen(np, where.astype(np.float32))
        return np.asarray(self.model.answer(np, self.weights, inputs, seen, None)[0], dtype=np.float64)

    def _interpolated(self, inputs: Weights, ni: int, nj: int) -> Floats | None:
        """Return the output interpolated from Chebyshev points; None where this is not accurate enough."""
        axis = points(TABLE)
        grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
        table = self._at(inputs, grid).reshape(TABLE, TABLE, 2)
        check = np.random.default_rng(0).random((200, 2))
        left, right = (barycentric(axis, weights(TABLE), x) for x in check.T)
        error = np.einsum("ap,abk,bp->pk", left, table, right)
        exact = self._at(inputs, check)
        error -= exact
        if not np.abs(error).max() <= CLOSE * max(np.abs(exact).max(), np.abs(table).max()):
            return None
        left, right = (barycentric(axis, weights(TABLE), np.linspace(0.0, 1.0, n)) for n in (ni, nj))
        return np.stack([left.T @ table[..., k] @ right for k in (0, 1)], axis=-1)

    def _splined(self, inputs: Weights, ni: int, nj: int) -> Floats:
        frame = self.frame
        where = self.model.seen(np, square(frame.ni, frame.nj).astype(np.float32))
        index = np.arange(frame.ni * frame.nj)
        answer = self.model.answer(np, self.weights, inputs, where, index)[0]
        nodes = np.asarray(answer, dtype=np.float64).reshape(frame.ni, frame.nj, 2)
        if (ni, nj) == (frame.ni, frame.nj):
            return nodes
        along = spline_matrix(frame.ni, ni, periodic=frame.topology == "o")
        across = spline_matrix(frame.nj, nj).T
        return np.stack([along @ nodes[..., k] @ across for k in (0, 1)], axis=-1)

    def _try(self) -> None:
        """Evaluate a few nodes, so that arrays of wrong shapes are reported when the file is read."""
        model, frame = self.model, self.frame
        inputs = {"sensors": np.zeros((1, model.sensors, 2), np.float32)}
        where, index = square(2, 2).astype(np.float32), np.array([0, 1, 2, frame.ni * frame.nj - 1])
        if type(model).encode is Architecture.encode:  # it reads sensors only
            model.answer(np, self.weights, inputs, model.seen(np, where), index)
        if any(key.startswith("fixed/") and array.ndim == 0 for key, array in self.weights.items()):
            raise ValueError(f"a fixed array of {frame.topology} without axes")
