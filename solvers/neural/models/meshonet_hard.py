"""MeshONet with exact boundary nodes (modes: Lu et al., CMAME 393 (2022) 114778)."""

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes, products
from meshonet.solvers.neural.models.sensors import sensors
from meshonet.solvers.neural.samples import Samples


@dataclass(frozen=True)
class MeshONetHard(Architecture):
    """MeshONet with exact boundary nodes.

    ::

        (x, y) = H + s * B(xi, eta) * branch(x_1, y_1 .. x_m, y_m) . trunk(lift(xi, eta))

    H is the harmonic extension of the boundary, whose points are (x_1, y_1) .. (x_m, y_m). B is zero on the
    boundary. lift(xi, eta) are xi, eta, and sines and cosines of both; for O grids only functions that are
    periodic in xi. s is the root mean square difference of the training grids from H. If `modes` is not 0,
    that many modes of the proper orthogonal decomposition of these differences replace B * trunk.
    """

    base: ClassVar[Literal["none", "harmonic"]] = "harmonic"
    boundary: ClassVar[float] = 0.0

    hidden: tuple[int, ...] = (64, 128, 64)  # widths of the branch's hidden layers
    features: int = 50  # functions of the trunk, shared by x and y
    width: int = 64  # of the trunk's hidden layers
    depth: int = 3
    waves: int = 6  # frequencies of xi and eta that the trunk sees
    modes: int = 0  # of the training grids' differences in place of a trained trunk; 0 for the trunk
    within: bool = False  # sensors are seen no further out than those of the training shapes
    periodic: bool = False  # in xi (an O grid)

    @property
    def native(self) -> bool:  # type: ignore[override]
        return self.modes > 0

    def shapes(self, frame: Frame) -> Shapes:
        branch = dense_shapes("branch", (2 * self.sensors, *self.hidden, 2 * (self.modes or self.features)))
        if self.modes:
            return branch
        seen = 4 * self.waves + (1 if self.periodic else 2)
        return {**branch, **dense_shapes("trunk", (seen, *[self.width] * self.depth, self.features))}

    def fixed(self, samples: Samples, targets: Floats) -> Arrays:
        seen = np.array([sensors(boundary, self.sensors) for boundary in samples.boundaries()])
        spread = seen.std(axis=0)
        size = np.sqrt((targets**2).mean())
        fixed = {
            "fixed/mean": seen.mean(axis=0),
            "fixed/spread": np.maximum(spread, 0.02 * spread.max() + 1e-9),
            "fixed/size": np.array([size or 1.0]),
        }
        if self.within:
            fixed |= {"fixed/least": seen.min(axis=0), "fixed/most": seen.max(axis=0)}
        return {**fixed, "fixed/modes": _modes(targets, self.modes)} if self.modes else fixed

    def seen(self, xp: Any, points: Any) -> Any:
        if self.modes:
            return points
        xi, eta = points[:, :1], points[:, 1:]
        bubble = 4.0 * eta * (1.0 - eta)
        if not self.periodic:
            bubble = bubble * (4.0 * xi * (1.0 - xi))
        return xp.concatenate([self._lifted(xp, points), bubble], -1)

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        seen = inputs["sensors"]
        if self.within:
            seen = xp.clip(seen, w["fixed/least"], w["fixed/most"])
        seen = (seen - w["fixed/mean"]) / w["fixed/spread"]
        c = dense(xp, w, "branch", seen.reshape(len(seen), -1))
        if self.modes:
            trunk = w["fixed/modes"][index]
        else:
            trunk = dense(xp, w, "trunk", places[:, :-1]) * places[:, -1:]
        return products(trunk, c.reshape(len(c), 2, trunk.shape[1])) * w["fixed/size"]

    def _lifted(self, xp: Any, points: Any) -> Any:
        turn = 2.0 if self.periodic else 1.0
        angles = [np.pi * k * points for k in range(1, self.waves + 1)]
        pairs = [(f(turn * a[:, :1]), f(a[:, 1:])) for a in angles for f in (xp.sin, xp.cos)]
        waves = [wave for pair in pairs for wave in pair]
        linear = points[:, 1:] if self.periodic else points
        return xp.concatenate([linear, *waves], -1)


def _modes(targets: Floats, count: int) -> Floats:
    """Return modes (nodes, count) of x and y of `targets` (n, ni, nj, 2), scaled as they occur in them."""
    rows = np.moveaxis(targets, -1, 0).reshape(2 * len(targets), -1)
    _, size, vectors = np.linalg.svd(rows, full_matrices=False)
    largest = vectors[:count] * (size[:count, None] / (size[0] or 1.0)) * np.sqrt(rows.shape[1])
    modes: Floats = np.zeros((rows.shape[1], count))
    modes[:, : len(largest)] = largest.T
    return modes
