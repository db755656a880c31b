"""The interface of the models that are trained on solved grids."""

from __future__ import annotations

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
    """An operator from boundaries to grids; its fields are its settings, kept in the header of its file."""

    base: ClassVar[Literal["none", "harmonic"]] = "none"  # what the answer is added to
    physics: ClassVar[bool] = False  # it learns from Winslow's equations, a network for each geometry
    interior: ClassVar[float] = 1.0  # weights of the two parts of its loss
    boundary: ClassVar[float] = 1.0

    sensors: int = 50  # points of the boundary that the branches read, m in the paper

    @property
    def native(self) -> bool:
        """Whether it answers on the nodes of its training grids only; other grids are splined from those."""
        return False

    def shapes(self, frame: Frame) -> Shapes:
        """Return the shapes of what is trained."""
        raise NotImplementedError

    def fixed(self, samples: Samples, targets: Floats) -> Arrays:
        """Return arrays that are computed from the training set once, and not trained.

        `targets` (n, ni, nj, 2) are the grids less the base.
        """
        return {}

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return the inputs of a batch of boundaries, each array with the batch first."""
        return {"sensors": np.array([sensors(boundary, self.sensors) for boundary in boundaries])}

    def check(self, w: Weights, inputs: Weights) -> None:
        """Raise InputError for boundaries that the model cannot answer; there are none."""

    def seen(self, xp: Any, points: Any) -> Any:
        """Return what the network sees of places (p, 2): themselves, or what they are lifted to (p, any).

        Nothing that is trained takes part, so that training computes it for all nodes once.
        """
        return points

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        """Return coordinates (batch, p, 2) less the base.

        `xp`: numpy or torch; `w`: trained and fixed arrays by name; `inputs`: of `encode`; `places`: what
        `seen` returned of p places (xi, eta); `index`: (p,) their numbers among the nodes of the training
        grids; only native models use it.
        """
        raise NotImplementedError
