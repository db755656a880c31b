"""POD-DeepONet with two outputs: the trunk is the proper orthogonal decomposition of the training grids.

::

    (x, y) = mean + sum_k branch(s)_k * mode_k(xi, eta)

x and y of a grid are one vector, so a mode moves both and needs one coefficient. Modes are scaled by the
root mean square of their coefficients over the training set, so that the branch answers numbers of the order
of 1. It answers on the nodes of the training grids; others are splined from those.
Lu et al., Computer Methods in Applied Mechanics and Engineering 393 (2022) 114778, section 3.1.4.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes
from meshonet.solvers.neural.samples import Samples


@dataclass(frozen=True)
class PODDeepONet(Architecture):
    """A branch that answers coefficients of fixed modes.

    Parameters
    ----------
    hidden : widths of the branch's hidden layers.
    features : modes; fewer where the training set has fewer grids.
    """

    hidden: tuple[int, ...] = (64, 128, 64)
    features: int = 16

    @property
    def native(self) -> bool:
        """Whether it answers on the nodes of its training grids only: yes."""
        return True

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of what is trained."""
        return dense_shapes("branch", (2 * self.sensors, *self.hidden, self.features))

    def fixed(self, samples: Samples, targets: Floats) -> Arrays:
        """Return the mean grid (nodes, 2) and the modes (nodes, features, 2); missing ones are zero."""
        n = len(targets)
        rows = targets.reshape(n, -1)
        mean = rows.mean(axis=0)
        _, size, vectors = np.linalg.svd(rows - mean, full_matrices=False)
        modes = np.zeros((self.features, rows.shape[1]))
        count = min(self.features, n - 1)
        modes[:count] = vectors[:count] * (size[:count, None] / np.sqrt(n))
        shape = (self.features, -1, 2)
        return {"fixed/mean": mean.reshape(-1, 2), "fixed/modes": modes.reshape(shape).swapaxes(0, 1)}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return coordinates (batch, p, 2) at nodes of the training grids."""
        s = inputs["sensors"]
        c = dense(xp, w, "branch", s.reshape(len(s), -1))
        return xp.einsum("bk,pkd->bpd", c, w["fixed/modes"][index]) + w["fixed/mean"][index]
