"""Operators on functions of xi, the nodes of a grid line along eta being channels, by wavelets or poles."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats, array_like, read_only
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes, gelu

SIDE = 5  # nodes of west and of east that are seen at every xi
SEEN = 4 + 4 * SIDE + 1  # input channels
PROJECT = 128  # width of the hidden layer that leads to the nodes
SCALING = (  # filter of the scaling function
    0.2303778133088964, 0.7148465705529154, 0.6308807679298587, -0.0279837694168599,
    -0.1870348117190931, 0.0308413818355607, 0.0328830116668852, -0.0105974017850690,
)  # fmt: skip


@dataclass(frozen=True)
class AlongXi(Architecture):
    """A neural operator from functions of xi to functions of xi, evaluated on nodes of the training grids.

    The input at each xi is xi itself, x and y of the south and the north node at xi, and x and y of a few
    fixed nodes on west and east. The output at each xi is x and y of all nodes on this grid line.
    """

    native: ClassVar[bool] = True

    width: int = 48  # channels of the hidden state

    def shapes(self, frame: Frame) -> Shapes:
        lift = dense_shapes("lift", (SEEN, self.width))
        return lift | self.layer_shapes(frame) | dense_shapes("project", (self.width, PROJECT, 2 * frame.nj))

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return the input channels (batch, ni, channels) as the only entry of a dictionary."""
        rows = []
        for boundary in boundaries:
            chosen = np.linspace(0, boundary.nj - 1, SIDE).round().astype(int)
            sides = np.concatenate([boundary.west[chosen], boundary.east[chosen]]).reshape(-1)
            xi = np.linspace(0.0, 1.0, boundary.ni)[:, None]
            rows.append(np.hstack([boundary.south, boundary.north, np.tile(sides, (boundary.ni, 1)), xi]))
        return {"edges": np.array(rows)}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        h = self.hidden(xp, w, dense(xp, w, "lift", inputs["edges"]))
        out = dense(xp, w, "project", h)
        return out.reshape(len(out), -1, 2)[:, index]

    def layer_shapes(self, frame: Frame) -> Shapes:
        """Return the array shapes of the trained parameters that `hidden` uses, by name."""
        raise NotImplementedError

    def hidden(self, xp: Any, w: Weights, h: Any) -> Any:
        """Return the hidden state (batch, ni, width) after all layers, from the lifted input `h`."""
        raise NotImplementedError


@dataclass(frozen=True)
class WNO(AlongXi):
    """Wavelet neural operator along xi: its layers multiply wavelet coefficients by trained matrices."""

    levels: int = 3  # of the wavelet transform
    layers: int = 4  # wavelet layers
    padding: int = 9  # least number of zeros before the transform

    def layer_shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of trained parameters. Raises InputError: too many levels for the node count."""
        if not 1 <= self.levels <= 8 or 2**self.levels > frame.ni:
            problem = f"levels={self.levels} of grids of {frame.ni} nodes along xi"
            raise InputError(problem, "use fewer, at least 1", parameter="set")
        coefficients = 2 * self._padded(frame.ni) // 2**self.levels
        shapes: Shapes = {}
        for k in range(self.layers):
            shapes |= dense_shapes(f"local{k}", (self.width, self.width))
            shapes[f"kernel{k}/weight"] = (coefficients, self.width, self.width)
        return shapes

    def hidden(self, xp: Any, w: Weights, h: Any) -> Any:
        for k in range(self.layers):
            h = gelu(xp, self._convolved(xp, w[f"kernel{k}/weight"], h) + dense(xp, w, f"local{k}", h))
        return h

    def _convolved(self, xp: Any, weight: Any, h: Any) -> Any:
        """Return h with the channels of each coefficient of the last level multiplied by its matrix."""
        n = h.shape[1]
        transform = array_like(wavelets(self._padded(n), self.levels)[:, :n], h, xp)
        coefficients = transform @ h
        # wavelets are orthonormal: the change of a few coefficients is added, the others stay as they are
        changed = xp.einsum("bmc,mcd->bmd", coefficients, weight) - coefficients
        return h + transform.T @ changed

    def _padded(self, n: int) -> int:
        step = 2**self.levels
        return -(-(n + self.padding) // step) * step


@cache
def wavelets(n: int, levels: int) -> Floats:
    """Return the periodic orthonormal scaling functions of the coarsest level, followed by its wavelets.

    The array (2 n / 2^levels, n) has the values of one function per row, at n nodes; 2^levels divides n.
    """
    low = np.array(SCALING)
    high = low[::-1] * np.where(np.arange(low.size) % 2, -1.0, 1.0)
    coarse = np.eye(n)
    detail = coarse
    for level in range(levels):
        m = n >> level
        at = (2 * np.arange(m // 2)[:, None] + np.arange(low.size)) % m
        detail = np.einsum("k,mkn->mn", high, coarse[at])
        coarse = np.einsum("k,mkn->mn", low, coarse[at])
    return read_only(np.concatenate([coarse, detail]))


@dataclass(frozen=True)
class LNO(AlongXi):
    """Laplace neural operator along xi: h <- sin(r + W h + b), r: response of dynamical systems to h.

    Cao, Goswami & Karniadakis, LNO: Laplace neural operator, arXiv 2303.10528.
    """

    width: int = 16
    poles: int = 8  # of each transfer function
    layers: int = 2  # Laplace layers

    def layer_shapes(self, frame: Frame) -> Shapes:
        shapes: Shapes = {}
        for k in range(self.layers):
            shapes |= dense_shapes(f"local{k}", (self.width, self.width))
            shapes[f"system{k}/poles"] = (self.width, self.width * self.poles, 2)
            shapes[f"system{k}/spectral"] = (self.width, self.width, self.poles, 2)
        return shapes

    def hidden(self, xp: Any, w: Weights, h: Any) -> Any:
        for k in range(self.layers):
            response = respond(xp, w[f"system{k}/poles"], w[f"system{k}/spectral"], h)
            h = xp.sin(response + dense(xp, w, f"local{k}", h))
        return h


def respond(xp: Any, poles: Any, residues: Any, h: Any) -> Any:
    """Return the responses (batch, n, out) of linear systems to `h` (batch, n, in), at n places from 0 to 1.

    For each pair of an input and an output channel, `poles` (in, out * m, 2) has p and q of m poles mu_j =
    -exp(p) + i pi q, and `residues` (in, out, m, 2) the real and imaginary parts of their residues beta_j.
    With Fourier coefficients alpha_l of `h` at frequencies omega_l, the response that starts at rest is ::

        sum_l alpha_l H(i omega_l) exp(i omega_l xi) - sum_j beta_j A(mu_j) exp(mu_j xi)
        H(s) = sum_j beta_j / (s - mu_j)        A(s) = sum_l alpha_l / (i omega_l - s)
    """
    inputs, outputs, count, _ = residues.shape
    omega, waves, xi = (array_like(table, h, xp) for table in _frequencies(h.shape[1]))
    alpha = xp.fft.fft(h, None, 1) / h.shape[1]
    mu = -xp.exp(poles[..., 0]) + 1j * np.pi * poles[..., 1]
    beta = residues[..., 0] + 1j * residues[..., 1]
    inverse = 1.0 / (omega[:, None] - mu[:, None])  # (in, n, out * poles)
    transfer = (inverse.reshape(inputs, -1, outputs, count) * beta[:, None]).sum(-1)  # (in, n, out)
    steady = waves @ xp.einsum("blc,cld->bld", alpha, transfer)
    taken = xp.einsum("blc,clp->bcp", alpha, inverse) * beta.reshape(inputs, -1)
    decay = xp.exp(mu[..., None] * xi).reshape(inputs, outputs, count, -1)  # (in, out, poles, n)
    transient = xp.einsum("bcop,copn->bno", taken.reshape(-1, inputs, outputs, count), decay)
    return (steady - transient).real


@cache
def _frequencies(n: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """Return i omega (n,) of a series of n values, its waves (n, n) at the nodes, and xi (n,) there."""
    step = 1.0 / (n - 1)
    omega = 2j * np.pi * np.fft.fftfreq(n, step)
    xi = np.linspace(0.0, 1.0, n)
    return read_only(omega), read_only(np.exp(np.outer(xi, omega))), read_only(xi)
