"""FNO1D with two inputs and two outputs: a Fourier neural operator along xi; eta becomes channels.

::

    in    x and y of south and north at every xi, of west and east at a few eta (the same for all xi), xi
    out   x and y at every eta, for every xi

Four Fourier layers h <- gelu(K h + W h + b), K mixing the lowest modes of h. Edges of an open direction are
not periodic, so h is continued by zeros before it is transformed. It answers on the nodes of the training
grids.
Li et al., Fourier Neural Operator for Parametric Partial Differential Equations, arXiv 2010.08895.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes, gelu

SIDE = 5
"""Nodes of west and of east that are seen."""
SEEN = 4 + 4 * SIDE + 1


@dataclass(frozen=True)
class FNO1D(Architecture):
    """Fourier layers along xi.

    Parameters
    ----------
    width : channels of the hidden state.
    modes : that are mixed.
    layers : Fourier layers.
    padding : nodes of zeros before the transform.
    """

    width: int = 48
    modes: int = 16
    layers: int = 4
    padding: int = 9

    @property
    def native(self) -> bool:
        """Whether it answers on the nodes of its training grids only: yes."""
        return True

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of what is trained."""
        shapes = {**dense_shapes("lift", (SEEN, self.width))}
        for k in range(self.layers):
            shapes |= dense_shapes(f"local{k}", (self.width, self.width))
            shapes[f"mix{k}/spectral"] = (self.modes, self.width, self.width, 2)
        return {**shapes, **dense_shapes("project", (self.width, 128, 2 * frame.nj))}

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return what is seen at every xi (batch, ni, SEEN)."""
        rows = []
        for one in boundaries:
            chosen = np.linspace(0, one.nj - 1, SIDE).round().astype(int)
            sides = np.concatenate([one.west[chosen], one.east[chosen]]).reshape(-1)
            xi = np.linspace(0.0, 1.0, one.ni)[:, None]
            rows.append(np.hstack([one.south, one.north, np.tile(sides, (one.ni, 1)), xi]))
        return {"edges": np.array(rows)}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return coordinates (batch, p, 2) at nodes of the training grids."""
        h = dense(xp, w, "lift", inputs["edges"])
        n = h.shape[1]
        for k in range(self.layers):
            local = dense(xp, w, f"local{k}", h)
            h = gelu(xp, self._mixed(xp, w[f"mix{k}/spectral"], h, n) + local)
        out = dense(xp, w, "project", h)
        return out.reshape(len(out), -1, 2)[:, index]

    def _mixed(self, xp: Any, weight: Any, h: Any, n: int) -> Any:
        """Return h (batch, n, width) with its lowest modes mixed, a complex matrix each."""
        spectrum = xp.fft.rfft(h, n + self.padding, 1)
        m = min(self.modes, spectrum.shape[1])
        matrix = weight[:m, ..., 0] + 1j * weight[:m, ..., 1]
        mixed = xp.einsum("bmc,mcd->bmd", spectrum[:, :m], matrix)
        return xp.fft.irfft(mixed, n + self.padding, 1)[:, :n]
