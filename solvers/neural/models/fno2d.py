"""FNO2D with two inputs and two outputs: a Fourier neural operator on the computational square.

::

    in    at (xi, eta): x and y of south and north at xi and of west and east at eta; xi; eta
    out   x and y there

The boundary is carried into the square, since the operator maps functions of the square to each other. Four
Fourier layers h <- gelu(K h + W h + b), K mixing the lowest modes; h is continued by zeros in both
directions before it is transformed. It answers on the nodes of the training grids.
Li et al., Fourier Neural Operator for Parametric Partial Differential Equations, arXiv 2010.08895.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes, gelu

SEEN = 10


@dataclass(frozen=True)
class FNO2D(Architecture):
    """Fourier layers on the square.

    Parameters
    ----------
    width : channels of the hidden state.
    modes : that are mixed, along either direction (of eta positive and negative ones).
    layers : Fourier layers.
    padding : nodes of zeros in either direction before the transform.
    """

    width: int = 12
    modes: int = 8
    layers: int = 4
    padding: int = 9

    @property
    def native(self) -> bool:
        """Whether it answers on the nodes of its training grids only: yes."""
        return True

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of what is trained.

        Raises
        ------
        InputError
            more modes than the grids have.
        """
        most = (min(frame.ni, frame.nj) + self.padding) // 2
        if not 1 <= self.modes <= most:
            told = f"modes={self.modes} of grids of {frame.ni} x {frame.nj} nodes"
            raise InputError(told, f"use 1 to {most}", parameter="set")
        shapes = {**dense_shapes("lift", (SEEN, self.width))}
        for k in range(self.layers):
            shapes |= dense_shapes(f"local{k}", (self.width, self.width))
            shapes[f"mix{k}/spectral"] = (2 * self.modes, self.modes, self.width, self.width, 2)
        return {**shapes, **dense_shapes("project", (self.width, 64, 2))}

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return the edges: south and north (batch, ni, 4), west and east (batch, nj, 4)."""
        along = np.array([np.hstack([one.south, one.north]) for one in boundaries])
        across = np.array([np.hstack([one.west, one.east]) for one in boundaries])
        return {"along": along, "across": across}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return coordinates (batch, p, 2) at nodes of the training grids."""
        along, across = inputs["along"], inputs["across"]
        batch, ni, nj = len(along), along.shape[1], across.shape[1]
        weight, bias = w["lift/0/weight"], w["lift/0/bias"]
        # the first layer is linear, so it is applied to the edges before they are carried into the square
        xi, eta = (_places(xp, n, along) for n in (ni, nj))
        rows, columns = along @ weight[:4] + xi * weight[8], across @ weight[4:8] + eta * weight[9]
        h = rows[:, :, None] + columns[:, None] + bias
        for k in range(self.layers):
            local = dense(xp, w, f"local{k}", h)
            h = gelu(xp, self._mixed(xp, w[f"mix{k}/spectral"], h) + local)
        return dense(xp, w, "project", h.reshape(batch, ni * nj, self.width)[:, index])

    def _mixed(self, xp: Any, weight: Any, h: Any) -> Any:
        """Return h (batch, ni, nj, width) with its lowest modes mixed, a complex matrix each."""
        batch, ni, nj, width = h.shape
        m = self.modes
        along, across, back = (_constant(xp, one, h) for one in _waves(ni, nj, m, self.padding))
        # products with the few waves that are kept take a fifth of the time of whole transforms
        rows = (across @ h).reshape(batch, ni, m, 2, width)
        rows = (rows[..., 0, :] + 1j * rows[..., 1, :]).reshape(batch, ni, m * width)
        kept = (along.T @ rows).reshape(batch, 2 * m, m, width)
        mixed = xp.einsum("bmnc,mncd->bmnd", kept, weight[..., 0] + 1j * weight[..., 1])
        columns = (along.conj() @ mixed.reshape(batch, 2 * m, m * width)).reshape(batch, ni, m, width)
        return back @ xp.stack([columns.real, columns.imag], 3).reshape(batch, ni, 2 * m, width)


@cache
def _waves(ni: int, nj: int, modes: int, padding: int) -> tuple[NDArray[Any], Floats, Floats]:
    """Return the matrices of discrete Fourier transforms of n nodes and `padding` zeros, lowest modes only.

    Along xi (ni, 2 modes), complex, its modes from 0 up and from -`modes` up; across it (2 modes, nj), the
    real and the imaginary part of every mode from 0 up, and the way back (nj, 2 modes), which has both norms.
    """
    m, k = ni + padding, np.concatenate([np.arange(modes), np.arange(-modes, 0)])
    along = np.exp(-2j * np.pi / m * np.outer(np.arange(ni), k))
    n = nj + padding
    angle = 2 * np.pi / n * np.outer(np.arange(modes), np.arange(nj))
    across = np.stack([np.cos(angle), -np.sin(angle)], 1).reshape(2 * modes, nj)
    twice = np.where(np.arange(2 * modes) < 2, 1.0, 2.0) / (m * n)
    return along, across, (across * twice[:, None]).T


def _constant(xp: Any, matrix: NDArray[Any], like: Any) -> Any:
    """Return a matrix as `xp` has them, of the precision of `like`."""
    both = np.iscomplexobj(matrix)
    if xp is np:
        return matrix.astype(np.result_type(like.dtype, np.complex64) if both else like.dtype)
    return xp.as_tensor(matrix, dtype=like.dtype.to_complex() if both else like.dtype, device=like.device)


def _places(xp: Any, n: int, like: Any) -> Any:
    """Return n places of the unit interval as a column of the kind and precision of `like`."""
    where = np.linspace(0.0, 1.0, n)[:, None]
    return where.astype(like.dtype) if xp is np else xp.as_tensor(where, dtype=like.dtype, device=like.device)
