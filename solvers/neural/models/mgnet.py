"""MGNet (Chen et al., Engineering with Computers 38 (2022) 4409) and MeshNet: one network per geometry."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes
from meshonet.solvers.neural.models.sensors import sensors
from meshonet.solvers.neural.samples import Samples

SAME = 1e-4  # largest distance of a sensor, over the geometry's size, at which two geometries are one


@dataclass(frozen=True)
class MGNet(Architecture):
    """One network N_g for each geometry g; all are trained together on Winslow's equations and the boundary.

    ::

        X    = (x, y) = N_g(phi(xi, eta))    phi = (2 xi - 1, 2 eta - 1), or for O grids
                                             (sin 2 pi xi, cos 2 pi xi, 2 eta - 1)
        loss = mean |alpha X_11 - 2 beta X_12 + gamma X_22|^2 + rim * mean |X - U|^2

    Subscripts 1 and 2 are derivatives by xi and eta. U are the given boundary nodes, with the weight `rim`.
    Lengths are relative to the size of each geometry.
    """

    physics: ClassVar[bool] = True

    width: int = 40  # of the hidden layers
    depth: int = 4
    rim: float = 1000.0  # weight of the boundary in the loss
    data: float = 1000.0  # weight of known nodes in the loss, where there are any
    finite: float = 0.0  # step of central differences; 0 for exact derivatives
    lines: int = 0  # auxiliary lines per direction with nodes of the solved grids (arXiv 2210.09546)
    coarse: int = 0  # nodes a direction of a coarse grid whose nodes are known from the solved grids
    periodic: bool = False  # in xi (an O grid)

    def shapes(self, frame: Frame) -> Shapes:
        sizes = (3 if self.periodic else 2, *[self.width] * self.depth, 2)
        return dense_shapes("net", sizes, stacked=frame.count)

    def fixed(self, samples: Samples, targets: Floats) -> Arrays:
        """Return boundary points (count, s, 2), centre (count, 2) and size (count, 1) of the geometries."""
        edges = samples.boundaries()
        outlines = [np.concatenate([b.south, b.north, b.west, b.east]) for b in edges]
        centre = np.array([0.5 * (o.min(axis=0) + o.max(axis=0)) for o in outlines])
        size = np.array([0.5 * np.ptp(o, axis=0).max() for o in outlines])
        seen = np.array([sensors(b, self.sensors) for b in edges])
        return {"fixed/sensors": seen, "fixed/centre": centre, "fixed/size": size[:, None]}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        which = self.which(w, inputs["sensors"])
        net = {key: value[which] for key, value in w.items()}
        scaled = dense(xp, net, "net", self.features(xp, places)[None])
        return scaled * net["fixed/size"][:, None] + net["fixed/centre"][:, None]

    def which(self, w: Weights, seen: Any) -> Any:
        """Return the index of the training geometry nearest to each set of boundary points in `seen`."""
        return ((seen[:, None] - w["fixed/sensors"][None]) ** 2).sum(-1).sum(-1).argmin(1)

    def check(self, w: Weights, inputs: Weights) -> None:
        """Raise InputError for a geometry that the model was not trained on."""
        seen = inputs["sensors"]
        k = self.which(w, seen)
        away = np.sqrt(((seen - w["fixed/sensors"][k]) ** 2).sum(-1)).max(axis=1) / w["fixed/size"][k, 0]
        if away.max() > SAME:
            problem = f"the model knows {len(w['fixed/sensors'])} geometries"
            problem += f", and this one is off the nearest by {away.max():.1e}"
            raise InputError(problem, "train it on this one too: it has a network for each geometry")

    def features(self, xp: Any, points: Any) -> Any:
        """Return the inputs phi (p, features) of the networks at `points` (p, 2), given as (xi, eta)."""
        xi, eta = points[..., :1], points[..., 1:]
        if not self.periodic:
            return 2.0 * points - 1.0
        turn = 2.0 * np.pi
        return xp.concatenate([xp.sin(turn * xi), xp.cos(turn * xi), 2.0 * eta - 1.0], -1)

    def slopes(self, xp: Any, points: Any) -> Sequence[Any]:
        """Return features (p, features) at `points`, and their first and second derivatives by xi and eta."""
        f = self.features(xp, points)
        zero, two = 0.0 * f[:, :1], 0.0 * f[:, :1] + 2.0
        if not self.periodic:
            none = 0.0 * f
            first = (xp.concatenate([two, zero], -1), xp.concatenate([zero, two], -1))
            return (f, *first, none, none, none)
        s, c, turn = f[:, :1], f[:, 1:2], 2.0 * np.pi
        along = xp.concatenate([turn * c, -turn * s, zero], -1)
        bend = xp.concatenate([-(turn**2) * s, -(turn**2) * c, zero], -1)
        return (f, along, xp.concatenate([zero, zero, two], -1), bend, 0.0 * f, 0.0 * f)


@dataclass(frozen=True)
class MeshNet(MGNet):
    """MGNet with a further term in its loss: the difference from the nodes of a coarse solved grid.

    Chen et al., Developing a novel structured mesh generation method based on deep neural networks, Physics
    of Fluids 35 (2023) 097151.
    """

    coarse: int = 11
