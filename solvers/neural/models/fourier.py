"""Fourier neural operators (Li et al., arXiv 2010.08895): h <- gelu(K h + W h + b)."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, array_like, read_only
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.along_xi import SEEN, AlongXi
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes, gelu


@dataclass(frozen=True)
class FNO1D(AlongXi):
    """One-dimensional Fourier neural operator along xi; see `AlongXi`."""

    modes: int = 16  # that are mixed
    layers: int = 4  # Fourier layers
    padding: int = 9  # nodes of zeros before the transform

    def layer_shapes(self, frame: Frame) -> Shapes:
        return _layer_shapes(self.layers, (self.modes,), self.width)

    def hidden(self, xp: Any, w: Weights, h: Any) -> Any:
        for k in range(self.layers):
            mixed = mix_modes(xp, w[f"mix{k}/spectral"], h, self.modes, self.padding)
            h = gelu(xp, mixed + dense(xp, w, f"local{k}", h))
        return h


def mix_modes(xp: Any, weight: Any, h: Any, modes: int, padding: int) -> Any:
    """Multiply the channels of each of the lowest Fourier modes of `h` (batch, n, width) by a matrix.

    `weight` has one complex matrix per mode (modes, width, width, 2), or one (width, width, 2) for all modes.
    Higher modes become 0. Before the transform, `padding` zeros are appended to h, which is not periodic.
    """
    n = h.shape[1]
    spectrum = xp.fft.rfft(h, n + padding, 1)
    m = min(modes, spectrum.shape[1])
    matrix = weight[..., 0] + 1j * weight[..., 1]
    if matrix.ndim == 2:
        mixed = spectrum[:, :m] @ matrix
    else:
        mixed = xp.einsum("bmc,mcd->bmd", spectrum[:, :m], matrix[:m])
    return xp.fft.irfft(mixed, n + padding, 1)[:, :n]


def _layer_shapes(layers: int, mixing: tuple[int, ...], width: int) -> Shapes:
    shapes: Shapes = {}
    for k in range(layers):
        shapes |= dense_shapes(f"local{k}", (width, width))
        shapes[f"mix{k}/spectral"] = (*mixing, width, width, 2)
    return shapes


@dataclass(frozen=True)
class FNO2D(Architecture):
    """Two-dimensional Fourier neural operator, evaluated on the nodes of the training grids.

    The input at a node has xi, eta, and x and y of the four boundary nodes on its two grid lines.
    """

    native: ClassVar[bool] = True

    width: int = 12  # channels of the hidden state
    modes: int = 8  # that are mixed, in each direction (of eta positive and negative ones)
    layers: int = 4  # Fourier layers
    padding: int = 9  # nodes of zeros before the transform, in each direction

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of trained parameters. Raises InputError: too many modes for the node counts."""
        most = (min(frame.ni, frame.nj) + self.padding) // 2
        if not 1 <= self.modes <= most:
            problem = f"modes={self.modes} of grids of {frame.ni} x {frame.nj} nodes"
            raise InputError(problem, f"use 1 to {most}", parameter="set")
        layers = _layer_shapes(self.layers, (2 * self.modes, self.modes), self.width)
        return dense_shapes("lift", (10, self.width)) | layers | dense_shapes("project", (self.width, 64, 2))

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return x, y of south and north nodes (batch, ni, 4), and of west and east nodes (batch, nj, 4)."""
        along = np.array([np.hstack([boundary.south, boundary.north]) for boundary in boundaries])
        across = np.array([np.hstack([boundary.west, boundary.east]) for boundary in boundaries])
        return {"along": along, "across": across}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        along, across = inputs["along"], inputs["across"]
        batch, ni, nj = len(along), along.shape[1], across.shape[1]
        weight, bias = w["lift/0/weight"], w["lift/0/bias"]
        # the first layer is linear, so it is applied to the edges before they are broadcast to the square
        xi, eta = (array_like(np.linspace(0.0, 1.0, n)[:, None], along, xp) for n in (ni, nj))
        rows, columns = along @ weight[:4] + xi * weight[8], across @ weight[4:8] + eta * weight[9]
        h = rows[:, :, None] + columns[:, None] + bias
        for k in range(self.layers):
            local = dense(xp, w, f"local{k}", h)
            h = gelu(xp, self._mixed(xp, w[f"mix{k}/spectral"], h) + local)
        return dense(xp, w, "project", h.reshape(batch, ni * nj, self.width)[:, index])

    def _mixed(self, xp: Any, weight: Any, h: Any) -> Any:
        """Return h with the channels of each of its lowest modes multiplied by a complex matrix."""
        batch, ni, nj, width = h.shape
        m = self.modes
        along, across, back = (array_like(table, h, xp) for table in _waves(ni, nj, m, self.padding))
        # products with the few modes that are kept take a fifth of the time of complete transforms
        rows = (across @ h).reshape(batch, ni, m, 2, width)
        rows = (rows[..., 0, :] + 1j * rows[..., 1, :]).reshape(batch, ni, m * width)
        kept = (along.T @ rows).reshape(batch, 2 * m, m, width)
        mixed = xp.einsum("bmnc,mncd->bmnd", kept, weight[..., 0] + 1j * weight[..., 1])
        columns = (along.conj() @ mixed.reshape(batch, 2 * m, m * width)).reshape(batch, ni, m, width)
        return back @ xp.stack([columns.real, columns.imag], 3).reshape(batch, ni, 2 * m, width)


@cache
def _waves(ni: int, nj: int, modes: int, padding: int) -> tuple[NDArray[Any], Floats, Floats]:
    """Return the matrices of Fourier transforms of n nodes and `padding` zeros to the lowest modes.

    Along xi (ni, 2 modes), complex, modes from 0 and from -`modes` up; along eta (2 modes, nj), real and
    imaginary part of every mode from 0 up, and its inverse (nj, 2 modes), with the scaling of both inverses.
    """
    m, k = ni + padding, np.concatenate([np.arange(modes), np.arange(-modes, 0)])
    along = np.exp(-2j * np.pi / m * np.outer(np.arange(ni), k))
    n = nj + padding
    angle = 2 * np.pi / n * np.outer(np.arange(modes), np.arange(nj))
    across = np.stack([np.cos(angle), -np.sin(angle)], 1).reshape(2 * modes, nj)
    twice = np.where(np.arange(2 * modes) < 2, 1.0, 2.0) / (m * n)
    return read_only(along), read_only(across), read_only((across * twice[:, None]).T)


@dataclass(frozen=True)
class KNO(AlongXi):
    """Koopman neural operator along xi; `width` is the number of observables g of the inputs.

    A decoder computes the nodes from tanh(h + W g + b). h is at first g, and changes `steps` times::

        h <- h + K h

    K multiplies each of the lowest Fourier modes by the same trained matrix. The matrix W applies to all
    modes; W and the vector b are trained, too. A second decoder reconstructs the inputs from g (weight
    `reconstruction` in the loss). Xiong et al., Koopman neural operator as a mesh-free solver of non-linear
    partial differential equations, Journal of Computational Physics 513 (2024) 113194.
    """

    modes: int = 16  # on which the operator acts
    steps: int = 4  # applications of the operator
    padding: int = 9  # nodes of zeros before the transform
    reconstruction: float = 0.1  # weight of the reconstructed inputs in the loss

    def layer_shapes(self, frame: Frame) -> Shapes:
        return {
            "operator/spectral": (self.width, self.width, 2),
            **dense_shapes("local", (self.width, self.width)),
            **dense_shapes("inputs", (self.width, SEEN)),
        }

    def hidden(self, xp: Any, w: Weights, h: Any) -> Any:
        g = h = xp.tanh(h)
        for _ in range(self.steps):
            h = h + mix_modes(xp, w["operator/spectral"], h, self.modes, self.padding)
        return xp.tanh(h + dense(xp, w, "local", g))

    def penalty(self, xp: Any, w: Weights, inputs: Weights) -> Any:
        """Return the mean square error of the reconstructed inputs, times the weight `reconstruction`."""
        edges = inputs["edges"]
        observables = xp.tanh(dense(xp, w, "lift", edges))
        return self.reconstruction * ((dense(xp, w, "inputs", observables) - edges) ** 2).mean()
