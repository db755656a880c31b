"""DeepONets: inner products of branch features (of the boundary) and trunk features (of points).

s: coordinates of m sensors; [:k], [k:]: halves of features for x and y; b: biases.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes, products
from meshonet.solvers.neural.models.sensors import lift
from meshonet.solvers.neural.samples import Samples


@dataclass(frozen=True)
class MeshONet(Architecture):
    """The neural operator of the MeshONet paper with the authors' settings; 54,482 parameters.

    ``x = branch_x(s_x) . trunk(lift(xi, eta)) + b``: s_x are the x coordinates of boundary points, and lift
    returns sines, cosines and powers of xi and eta. y has its own branch and the same trunk. The trunk ends
    with tanh. Xiao et al., arXiv 2501.11937.
    """

    interior: ClassVar[float] = 900.0
    boundary: ClassVar[float] = 1000.0

    hidden: tuple[int, ...] = (64, 128, 64)  # widths of a branch's hidden layers (Adjust Layer)
    features: int = 50  # of branch and trunk, k in the paper
    depth: int = 4  # layers of the trunk, each `features` wide
    powers: int = 4  # of xi and eta in the Lift-Layer, q in the paper

    def shapes(self, frame: Frame) -> Shapes:
        trunk = (4 + 2 * self.powers, *[self.features] * self.depth)
        branches = _two_branches((self.sensors, *self.hidden, self.features))
        return {**branches, **dense_shapes("trunk", trunk), "output/bias": (2,)}

    def seen(self, xp: Any, points: Any) -> Any:
        """Return sines, cosines and powers of xi and eta (p, features) at `points` (p, 2)."""
        return lift(xp, points, self.powers)

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        trunk = dense(xp, w, "trunk", places, last=True)
        s = inputs["sensors"]
        both = xp.stack([dense(xp, w, f"branch_{name}", s[..., k]) for k, name in enumerate("xy")], 1)
        return products(trunk, both) + w["output/bias"]


@dataclass(frozen=True)
class DeepONet(Architecture):
    """One branch and one trunk; half of their features are for x, the other half for y.

    ``x = branch(s)[:k] . trunk(xi, eta)[:k] + b``, where s has the coordinates of boundary points. Lu et al.,
    Nature Machine Intelligence 3 (2021) 218.
    """

    hidden: tuple[int, ...] = (64, 128, 64)  # widths of a branch's hidden layers
    features: int = 50  # of each coordinate
    width: int = 50  # of the trunk's hidden layers
    depth: int = 3

    def shapes(self, frame: Frame) -> Shapes:
        branch = dense_shapes("branch", (2 * self.sensors, *self.hidden, 2 * self.features))
        return {**branch, **self._trunk(2 * self.features), "output/bias": (2,)}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        c = dense(xp, w, "branch", inputs["sensors"].reshape(len(inputs["sensors"]), -1))
        trunk, k = dense(xp, w, "trunk", places, last=True), self.features
        return xp.stack([c[:, :k] @ trunk[:, :k].T, c[:, k:] @ trunk[:, k:].T], -1) + w["output/bias"]

    def _trunk(self, features: int) -> Shapes:
        return dense_shapes("trunk", (2, *[self.width] * self.depth, features))


@dataclass(frozen=True)
class MIONet(DeepONet):
    """A DeepONet with two branches, for x and y of boundary points s, whose outputs are multiplied.

    ``x = (branch_x(s_x) * branch_y(s_y))[:k] . trunk(xi, eta) + b`` with a bias b, and y from the other half,
    ``[k:]``, of the product. Jin, Meng & Lu, SIAM Journal on Scientific Computing 44 (2022) A3490.
    """

    def shapes(self, frame: Frame) -> Shapes:
        branches = _two_branches((self.sensors, *self.hidden, 2 * self.features))
        return {**branches, **self._trunk(self.features), "output/bias": (2,)}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        s = inputs["sensors"]
        c = dense(xp, w, "branch_x", s[..., 0]) * dense(xp, w, "branch_y", s[..., 1])
        trunk = dense(xp, w, "trunk", places, last=True)
        return products(trunk, c.reshape(len(c), 2, self.features)) + w["output/bias"]


@dataclass(frozen=True)
class PODDeepONet(Architecture):
    """DeepONet whose trunk is the proper orthogonal decomposition of the training grids.

    ``(x, y) = mean + sum_k branch(s)_k * mode_k(xi, eta)`` at the nodes of the training grids, where s are
    points of the boundary. A mode has x and y. Modes are scaled so that the branch's outputs are of the order
    of 1. Lu et al., CMAME 393 (2022) 114778, sections 3.1.4 and 3.1.6.
    """

    native: ClassVar[bool] = True

    hidden: tuple[int, ...] = (64, 128, 64)  # widths of the branch's hidden layers
    features: int = 16  # modes; fewer where the training set has fewer grids

    def shapes(self, frame: Frame) -> Shapes:
        return dense_shapes("branch", (2 * self.sensors, *self.hidden, self.features))

    def fixed(self, samples: Samples, targets: Floats) -> Arrays:
        """Return the mean of `targets` (nodes, 2) and their POD modes (nodes, features, 2), by name."""
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
        c = dense(xp, w, "branch", inputs["sensors"].reshape(len(inputs["sensors"]), -1))
        return xp.einsum("bk,pkd->bpd", c, w["fixed/modes"][index]) + w["fixed/mean"][index]


def _two_branches(sizes: tuple[int, ...]) -> Shapes:
    return {**dense_shapes("branch_x", sizes), **dense_shapes("branch_y", sizes)}
