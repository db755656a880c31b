"""The Laplace neural operator, along xi: h <- sin(K h + W h + b).

Cao, Goswami & Karniadakis, LNO: Laplace neural operator for solving differential equations, arXiv 2303.10528.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import array_like, read_only
from meshonet.solvers.neural.models.along_xi import AlongXi
from meshonet.solvers.neural.models.architecture import Frame
from meshonet.solvers.neural.models.layers import Shapes, Weights, dense, dense_shapes


@dataclass(frozen=True)
class LNO(AlongXi):
    """Laplace neural operator along xi."""

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
    """Return the responses (batch, n, out) of linear systems to h (batch, n, in), at n times from 0 to 1.

    `poles`: (in, out * poles, 2), the logarithm of the decay rate, and the frequency in half turns;
    `residues`: (in, out, poles, 2). With poles mu, residues beta, and the Fourier coefficients alpha and
    frequencies omega of h, the response at xi from rest is ::

        sum_l alpha_l H(i omega_l) exp(i omega_l xi) - sum_n beta_n A(mu_n) exp(mu_n xi)
        H(s) = sum_n beta_n / (s - mu_n)        A(s) = sum_l alpha_l / (i omega_l - s)
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
