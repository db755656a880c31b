"""A trained operator: its file, and its answer on the nodes of any grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from meshonet.geometry.arrays import TOPOLOGIES, Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.algebraic.resample.spline import spline_matrix
from meshonet.solvers.conformal.chebyshev import interpolation, points
from meshonet.solvers.neural.layers import Arrays, Weights
from meshonet.solvers.neural.models.model import Frame, Operator
from meshonet.solvers.neural.registry import OPERATORS, operator, settings_of
from meshonet.solvers.neural.sensors import at_nodes, square
from meshonet.solvers.neural.weights import read_tensors, write_tensors

KIND = "meshonet operator"
VERSION = 1
DIRECT = 129 * 129
"""Nodes up to which a network is evaluated at each; larger grids are interpolated where that is exact."""
TABLE = 65
CLOSE = 1e-6
"""Largest error of that interpolation, relative to the answer, at places between its points."""


@dataclass(frozen=True)
class Trained:
    """A model with its weights.

    Parameters
    ----------
    name : of the file.
    model, frame : what it is and what it was trained on.
    weights : trained and fixed arrays, float32.
    header : what the file says of itself: recipe and figures.
    """

    name: str
    model: Operator
    frame: Frame
    weights: Weights
    header: Mapping[str, Any]

    def difference(self, boundary: Boundary) -> Floats:
        """Return the answer at the nodes of `boundary`'s grid (ni, nj, 2), less the model's base.

        Raises
        ------
        InputError
            a boundary of another topology than the training grids'.
        """
        if boundary.topology != self.frame.topology:
            told = f"model {self.name} makes {self.frame.topology} grids"
            raise InputError(f"{told}, and this boundary is {boundary.topology}", "use another model")
        ni, nj = boundary.ni, boundary.nj
        # a native model answers on the nodes of the training grids, so these are the ones it sees
        known = at_nodes(boundary, self.frame.ni, self.frame.nj) if self.model.native else boundary
        inputs = {name: value.astype(np.float32) for name, value in self.model.encode([known]).items()}
        self.model.check(self.weights, inputs)
        if self.model.native:
            return self._splined(inputs, ni, nj)
        if ni * nj > DIRECT:
            found = self._interpolated(inputs, ni, nj)
            if found is not None:
                return found
        rows = max(1, DIRECT // nj)
        where = square(ni, nj).reshape(ni, nj, 2)
        parts = [self._at(inputs, where[k : k + rows].reshape(-1, 2)) for k in range(0, ni, rows)]
        return np.concatenate(parts).reshape(ni, nj, 2)

    def _at(self, inputs: Weights, where: Floats) -> Floats:
        found = self.model.answer(
            np, self.weights, inputs, self.model.seen(np, where.astype(np.float32)), None
        )
        return np.asarray(found[0], dtype=np.float64)

    def _interpolated(self, inputs: Weights, ni: int, nj: int) -> Floats | None:
        """Return the answer from its values at Chebyshev points, None where that is not exact enough."""
        axis = points(TABLE)
        grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
        table = self._at(inputs, grid).reshape(TABLE, TABLE, 2)
        check = np.random.default_rng(0).random((200, 2))
        left, right = interpolation(TABLE, check[:, 0]), interpolation(TABLE, check[:, 1])
        found = np.einsum("pa,abk,pb->pk", left, table, right)
        wanted = self._at(inputs, check)
        if not np.abs(found - wanted).max() <= CLOSE * max(np.abs(wanted).max(), np.abs(table).max()):
            return None
        left = interpolation(TABLE, np.linspace(0.0, 1.0, ni))
        right = interpolation(TABLE, np.linspace(0.0, 1.0, nj)).T
        return np.stack([left @ table[..., k] @ right for k in (0, 1)], axis=-1)

    def _splined(self, inputs: Weights, ni: int, nj: int) -> Floats:
        frame = self.frame
        where = self.model.seen(np, square(frame.ni, frame.nj).astype(np.float32))
        index = np.arange(frame.ni * frame.nj)
        found = self.model.answer(np, self.weights, inputs, where, index)[0]
        nodes = np.asarray(found, dtype=np.float64).reshape(frame.ni, frame.nj, 2)
        if (ni, nj) == (frame.ni, frame.nj):
            return nodes
        along = spline_matrix(frame.ni, ni, periodic=frame.topology == "o")
        across = spline_matrix(frame.nj, nj).T
        return np.stack([along @ nodes[..., k] @ across for k in (0, 1)], axis=-1)


def write_trained(
    path: Path, name: str, model: Operator, kind: str, frame: Frame, arrays: Arrays, **facts: Any
) -> None:
    """Write a model file: float32 arrays and the header that `load_trained` checks.

    Parameters
    ----------
    kind : name of the model in the registry.
    facts : recipe and figures.
    """
    header = {
        "kind": KIND,
        "version": VERSION,
        "name": name,
        "model": kind,
        "settings": settings_of(model),
        "topology": frame.topology,
        "ni": frame.ni,
        "nj": frame.nj,
        "count": frame.count,
        **facts,
    }
    write_tensors(path, {key: value.astype(np.float32) for key, value in arrays.items()}, header)


@lru_cache(maxsize=4)
def load_trained(path: Path) -> Trained:
    """Return the model of a file.

    Raises
    ------
    InputError
        a file of another kind or version, or whose arrays are not those of the model it names.
    """
    header, tensors = read_tensors(path)
    source = str(path)
    if header.get("kind") != KIND or header.get("version") != VERSION or header.get("model") not in OPERATORS:
        told = f"it holds {header.get('kind')!r} {header.get('model', '')}, version {header.get('version')}"
        raise InputError(told, "use a file made by this version's meshonet train", source=source)
    try:
        topology = header["topology"]
        frame = Frame(topology, int(header["ni"]), int(header["nj"]), int(header.get("count", 0)))
        if topology not in TOPOLOGIES or not 2 <= min(frame.ni, frame.nj) <= max(frame.ni, frame.nj) <= 4096:
            raise ValueError("topology or size")
        model = operator(header["model"], topology, header["settings"])
        shapes = model.shapes(frame)
        if any(tensors[key].shape != shape for key, shape in shapes.items()):
            raise ValueError("shapes")
        weights = {key: array.astype(np.float32) for key, array in tensors.items()}
        trained = Trained(str(header.get("name", path.stem)), model, frame, weights, header)
        _try(trained)
    except InputError as error:
        error.source = source
        raise
    except (KeyError, IndexError, ValueError, TypeError, AttributeError) as error:
        raise InputError(
            f"its header or arrays do not fit ({error})", "use a file made by meshonet train", source=source
        ) from None
    return trained


def _try(trained: Trained) -> None:
    """Ask for a few nodes, so that arrays which do not fit are found when the file is read."""
    model, frame = trained.model, trained.frame
    inputs = {"sensors": np.zeros((1, model.sensors, 2), np.float32)}
    where, index = square(2, 2).astype(np.float32), np.array([0, 1, 2, frame.ni * frame.nj - 1])
    if type(model).encode is Operator.encode:  # it reads sensors only
        model.answer(np, trained.weights, inputs, model.seen(np, where), index)
    if any(key.startswith("fixed/") and array.ndim == 0 for key, array in trained.weights.items()):
        raise ValueError(f"a fixed array of {frame.topology} without axes")
