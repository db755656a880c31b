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
    """Topology, node counts and number of the training grids."""

    topology: Topology
    ni: int
    nj: int
    count: int = 0


@dataclass(frozen=True)
class Architecture:
    """Base class of models that make grids from boundaries; the model file stores their fields."""

    base: ClassVar[Literal["none", "harmonic"]] = "none"  # grid to which the network's output is added
    physics: ClassVar[bool] = False  # whether it is trained on Winslow's equations, one network per geometry
    interior: ClassVar[float] = 1.0  # weights of interior and boundary in the loss
    boundary: ClassVar[float] = 1.0
    native: ClassVar[bool] = False  # whether its output is known only at the nodes of its training grids

    sensors: int = 50  # points of the boundary that the branches read, m in the paper

    def shapes(self, frame: Frame) -> Shapes:
        """Return the array shapes of the trained parameters, by name; `frame`: size of the training grids."""
        raise NotImplementedError

    def fixed(self, samples: Samples, targets: Floats) -> Arrays:
        """Return arrays by name that are computed from the training set and not trained.

        `targets` (n, ni, nj, 2) are the training grids minus the base grids (see `base`).
        """
        return {}

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return the network's inputs for a batch of boundaries, by name; the first axis is the batch."""
        return {"sensors": np.array([sensors(boundary, self.sensors) for boundary in boundaries])}

    def check(self, w: Weights, inputs: Weights) -> None:
        """Raise InputError if the model does not apply to `inputs`; by default it always applies."""

    def penalty(self, xp: Any, w: Weights, inputs: Weights) -> Any:
        """Return a further term of the loss, a scalar; None, the default, if there is none."""
        return None

    def seen(self, xp: Any, points: Any) -> Any:
        """Return the network's input (p, features) at `points` (p, 2), given as (xi, eta)."""
        return points

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return the model's corrections (batch, p, 2) to an initial grid, the base grid, at p points.

        `xp` is numpy or torch, `w` has all arrays of the model by name. `inputs` is what the method `encode`
        returns for the boundaries, `places` what the method `seen` returns for the points. For models that
        are defined only at the nodes of training grids, `index` (p,) has the points' indices among them.
        """
        raise NotImplementedError
