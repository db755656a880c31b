"""MIONet with two outputs: the branches of x and of y are multiplied, so that either coordinate sees both.

::

    x = (branch_x(x_1 .. x_m)[:k] * branch_y(y_1 .. y_m)[:k]) . trunk(xi, eta) + b0
    y = (branch_x(x_1 .. x_m)[k:] * branch_y(y_1 .. y_m)[k:]) . trunk(xi, eta) + b0'

The multi-input operator that the paper builds its theory on, with the branches' features in halves for its
two outputs. Jin, Meng & Lu, SIAM Journal on Scientific Computing 44 (2022) A3490.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Shapes, Weights, dense, dense_shapes, products


@dataclass(frozen=True)
class MIONet(Architecture):
    """Two branches, multiplied, and a trunk.

    Parameters
    ----------
    hidden : widths of a branch's hidden layers.
    features : of each coordinate.
    width, depth : of the trunk's hidden layers.
    """

    hidden: tuple[int, ...] = (64, 128, 64)
    features: int = 50
    width: int = 50
    depth: int = 3

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of what is trained."""
        branch = (self.sensors, *self.hidden, 2 * self.features)
        return {
            **dense_shapes("branch_x", branch),
            **dense_shapes("branch_y", branch),
            **dense_shapes("trunk", (2, *[self.width] * self.depth, self.features)),
            "output/bias": (2,),
        }

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return coordinates (batch, p, 2)."""
        s = inputs["sensors"]
        c = dense(xp, w, "branch_x", s[..., 0]) * dense(xp, w, "branch_y", s[..., 1])
        trunk = dense(xp, w, "trunk", places, last=True)
        return products(trunk, c.reshape(len(c), 2, self.features)) + w["output/bias"]
