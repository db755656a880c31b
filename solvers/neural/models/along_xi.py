"""Operators on functions of xi: the nodes of a grid line along eta are channels."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.solvers.neural.models.architecture import Architecture, Frame
from meshonet.solvers.neural.models.layers import Arrays, Shapes, Weights, dense, dense_shapes

SIDE = 5  # nodes of west and of east that are seen at every xi
SEEN = 4 + 4 * SIDE + 1  # input channels
PROJECT = 128  # width of the hidden layer that leads to the nodes


@dataclass(frozen=True)
class AlongXi(Architecture):
    """An operator from functions of xi to functions of xi, evaluated on the nodes of the training grids.

    ::

        in    at every xi: x and y of south and north, of west and east at a few eta (the same for all), xi
        out   x and y at every eta, for every xi
    """

    width: int = 48  # channels of the hidden state

    @property
    def native(self) -> bool:
        return True

    def shapes(self, frame: Frame) -> Shapes:
        lift = dense_shapes("lift", (SEEN, self.width))
        return lift | self.layer_shapes(frame) | dense_shapes("project", (self.width, PROJECT, 2 * frame.nj))

    def encode(self, boundaries: Sequence[Boundary]) -> Arrays:
        """Return the input channels at every xi (batch, ni, channels)."""
        rows = []
        for boundary in boundaries:
            chosen = np.linspace(0, boundary.nj - 1, SIDE).round().astype(int)
            sides = np.concatenate([boundary.west[chosen], boundary.east[chosen]]).reshape(-1)
            xi = np.linspace(0.0, 1.0, boundary.ni)[:, None]
            rows.append(np.hstack([boundary.south, boundary.north, np.tile(sides, (boundary.ni, 1)), xi]))
        return {"edges": np.array(rows)}

    def answer(self, xp: Any, w: Weights, inputs: Weights, places: Any, index: Any) -> Any:
        h = self.hidden(xp, w, dense(xp, w, "lift", inputs["edges"]))
        out = dense(xp, w, "project", h)
        return out.reshape(len(out), -1, 2)[:, index]

    def layer_shapes(self, frame: Frame) -> Shapes:
        """Return the array shapes of the trained parameters of `hidden`, by name."""
        raise NotImplementedError

    def hidden(self, xp: Any, w: Weights, h: Any) -> Any:
        """Return the hidden state (batch, ni, width) after all layers."""
        raise NotImplementedError
