"""MeshONet to the paper's letter: branch-x sees x, branch-y sees y, a trunk they share.

::

    x = branch_x(x_1 .. x_m) . trunk(lift(xi, eta)) + b0
    y = branch_y(y_1 .. y_m) . trunk(lift(xi, eta)) + b0'

Widths, powers and weights of the loss are the authors' published settings: branch 50-64-128-64-50, trunk
12-50-50-50-50 with tanh after its last layer, powers to 4, 900 interior + 1000 boundary; 54,482 parameters.
Xiao et al., arXiv 2501.11937.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Shapes, Weights, dense, dense_shapes, products
from meshonet.solvers.neural.models.sensors import lift


@dataclass(frozen=True)
class MeshONet(Architecture):
    """Dual branch, shared trunk.

    Parameters
    ----------
    hidden : widths of a branch's hidden layers (Adjust Layer).
    features : of branch and trunk, k in the paper.
    depth : layers of the trunk, each `features` wide.
    powers : of xi and eta in the Lift-Layer, q in the paper.
    """

    interior: ClassVar[float] = 900.0
    boundary: ClassVar[float] = 1000.0

    hidden: tuple[int, ...] = (64, 128, 64)
    features: int = 50
    depth: int = 4
    powers: int = 4

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of what is trained."""
        branch = (self.sensors, *self.hidden, self.features)
        trunk = (4 + 2 * self.powers, *[self.features] * self.depth)
        return {
            **dense_shapes("branch_x", branch),
            **dense_shapes("branch_y", branch),
            **dense_shapes("trunk", trunk),
            "output/bias": (2,),
        }

    def seen(self, xp: Any, points: Any) -> Any:
        """Return places as the Lift-Layer makes them."""
        return lift(xp, points, self.powers)

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return coordinates (batch, p, 2)."""
        trunk = dense(xp, w, "trunk", places, last=True)
        s = inputs["sensors"]
        both = xp.stack([dense(xp, w, f"branch_{name}", s[..., k]) for k, name in enumerate("xy")], 1)
        return products(trunk, both) + w["output/bias"]
