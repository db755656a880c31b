"""The interface of the models that are trained on solved grids."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from meshonet.geometry.arrays import Floats, Topology
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights
from meshonet.solvers.neural.models.sensors import sensors
from meshonet.solvers.neural.samples import Samples


@dataclass(frozen=True)
class Frame:
    """Topology, node counts `ni` and `nj`, and number `count` of the training grids."""

    topology: Topology
    ni: int
    nj: int
    count: int = 0


@dataclass(frozen=True)
class Architecture:
    """An operator from boundaries to grids; its fields are its settings, kept in the header of its file."""

    base: ClassVar[Literal["none", "harmonic"]] = "none"  # grid to which the network's output is added
    physics: ClassVar[bool] = False  # whether it is trained on Winslow's equations, one network per geometry
    interior: ClassVar[float] = 1.0  # weights of interior and boundary in the loss
    boundary: ClassVar[float] = 1.0
    native: ClassVar[bool] = False  # whether its output is known only at the nodes of its training grids

    sensors: int = 50  # points of the boundary that the branches read, m in the paper

    def shapes(self, frame: Frame) -> Shapes:
        """Return the array shapes of the trained parameters, by name, for training grids of `frame`."""
        raise NotImplementedError

    def fixed(self, samples: Samples, targets: Floats) -> Arrays:
        """Return constant arrays, by name, computed from the training set and not trained.

        `targets` (n, ni, nj, 2) are the training grids minus their base grids (`base`).
        """
        return {}

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return the network's inputs for a batch of boundaries, by name; the first axis is the batch."""
        return {"sensors": np.array([sensors(boundary, self.sensors) for boundary in boundaries])}

    def check(self, w: Weights, inputs: Weights) -> None:
        """Raise InputError for `inputs` outside of the model's scope; the default accepts all inputs."""

    def penalty(self, xp: Any, w: Weights, inputs: Weights) -> Any:
        """Return a further part of the loss, a scalar; None, the default, if there is none."""
        return None

    def seen(self, xp: Any, points: Any) -> Any:
        """Return the trunk's input (p, features) at `points` (p, 2) in (xi, eta)."""
        return points

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return the coordinates (batch, p, 2) of p points, minus those of the base grid.

        `xp`: numpy or torch; `w`: trained and fixed arrays by name; `inputs`: from `encode`; `places`: from
        `seen`; `index`: (p,) indices of the points among the nodes of the training grids, for models defined
        only there.
        """
        raise NotImplementedError
