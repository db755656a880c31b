"""The Koopman neural operator, along xi.

An encoder lifts the input at every xi to observables g, which evolve `steps` times by the same linear
operator: one matrix K that multiplies the observables of each of the lowest Fourier modes. ::

    h <- h + K h    `steps` times, from h = tanh(g)
    g <- tanh(h + W g + b)    W adds what the modes left out

A second decoder must reconstruct the inputs from the observables (weight `reconstruction` in the loss), so
that these hold the whole boundary. Xiong et al., Koopman neural operator as a mesh-free solver of non-linear
partial differential equations, Journal of Computational Physics 513 (2024) 113194.
"""

from dataclasses import dataclass
from typing import Any

from meshonet.solvers.neural.models.along_xi import SEEN, AlongXi
from meshonet.solvers.neural.models.architecture import Frame
from meshonet.solvers.neural.models.fourier import mix_modes
from meshonet.solvers.neural.models.layers import Shapes, Weights, dense, dense_shapes


@dataclass(frozen=True)
class KNO(AlongXi):
    """Koopman neural operator along xi; `width` is the number of observables."""

    modes: int = 16  # on which the operator acts
    steps: int = 4  # applications of the operator
    padding: int = 9  # nodes of zeros before the transform
    reconstruction: float = 0.1  # weight of the reconstructed inputs in the loss

    def layer_shapes(self, frame: Frame) -> Shapes:
        return {
            "operator/spectral": (self.width, self.width, 2),
            **dense_shapes("local", (self.width, self.width)),
            **dense_shapes("inputs", (self.width, SEEN)),
        }

    def hidden(self, xp: Any, w: Weights, h: Any) -> Any:
        g = h = xp.tanh(h)
        for _ in range(self.steps):
            h = h + mix_modes(xp, w["operator/spectral"], h, self.modes, self.padding)
        return xp.tanh(h + dense(xp, w, "local", g))

    def penalty(self, xp: Any, w: Weights, inputs: Weights) -> Any:
        """Return the weighted mean square error of the inputs that are decoded from the observables."""
        edges = inputs["edges"]
        observables = xp.tanh(dense(xp, w, "lift", edges))
        return self.reconstruction * ((dense(xp, w, "inputs", observables) - edges) ** 2).mean()
