"""The wavelet neural operator, along xi: h <- gelu(K h + W h + b).

Tripura & Chakraborty, CMAME 404 (2023) 115783; Daubechies, Ten Lectures on Wavelets (1992), table 6.1.
"""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats, array_like, read_only
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.along_xi import AlongXi
from meshonet.solvers.neural.models.architecture import Frame
from meshonet.solvers.neural.models.layers import Shapes, Weights, dense, dense_shapes, gelu

SCALING = (
    0.2303778133088964, 0.7148465705529154, 0.6308807679298587, -0.0279837694168599,
    -0.1870348117190931, 0.0308413818355607, 0.0328830116668852, -0.0105974017850690,
)  # fmt: skip
"""Filter of the scaling function."""


@dataclass(frozen=True)
class WNO(AlongXi):
    """Wavelet neural operator along xi."""

    levels: int = 3  # of the wavelet transform
    layers: int = 4  # wavelet layers
    padding: int = 9  # least number of zeros before the transform

    def layer_shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of trained parameters. Raises InputError: more levels than the nodes permit."""
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
    """Return the orthonormal periodic scaling functions and wavelets of the last level (2 n / 2^levels, n).

    `n` is a multiple of 2^levels.
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
