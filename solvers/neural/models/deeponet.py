"""DeepONet with two outputs: one branch sees both coordinates, x and y each take half of its features.

::

    x = branch(s)[:k] . trunk(xi, eta)[:k] + b0        y = branch(s)[k:] . trunk(xi, eta)[k:] + b0'

s are the 2m coordinates of the sensors. To split the features is how Lu et al. treat several outputs; the
trunk sees xi and eta as they are, and the loss weighs all places alike.
Lu et al., Nature Machine Intelligence 3 (2021) 218; Computer Methods in Applied Mechanics and Engineering
393 (2022) 114778, section 3.1.6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Shapes, Weights, dense, dense_shapes


@dataclass(frozen=True)
class DeepONet(Architecture):
    """One branch, one trunk, features in halves.

    Parameters
    ----------
    hidden : widths of the branch's hidden layers.
    features : of each coordinate.
    width, depth : of the trunk's hidden layers.
    """

    hidden: tuple[int, ...] = (64, 128, 64)
    features: int = 50
    width: int = 50
    depth: int = 3

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of what is trained."""
        return {
            **dense_shapes("branch", (2 * self.sensors, *self.hidden, 2 * self.features)),
            **dense_shapes("trunk", (2, *[self.width] * self.depth, 2 * self.features)),
            "output/bias": (2,),
        }

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return coordinates (batch, p, 2)."""
        s = inputs["sensors"]
        c = dense(xp, w, "branch", s.reshape(len(s), -1))
        trunk, k = dense(xp, w, "trunk", places, last=True), self.features
        return xp.stack([c[:, :k] @ trunk[:, :k].T, c[:, k:] @ trunk[:, k:].T], -1) + w["output/bias"]
