"""Training of physics-informed networks, all geometries of a dataset at once."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor

from meshonet.geometry.errors import InputError
from meshonet.solvers.elliptic.winslow import left_side
from meshonet.solvers.neural.fit.model_task import ModelTask, tensor
from meshonet.solvers.neural.models.mgnet import MGNet
from meshonet.solvers.neural.samples import Samples


class PhysicsTask(ModelTask):
    """Training of the networks of `MGNet` or `MeshNet` on the geometries of `samples`.

    `points` has the numbers of points drawn in each step, inside and on the boundary; None takes all nodes.
    """

    model: MGNet
    parts: tuple[str, ...] = ("winslow", "boundary", "data")

    def __init__(
        self, model: MGNet, samples: Samples, points: tuple[int, int] | None, seed: int, device: torch.device
    ) -> None:
        super().__init__(model, samples, samples.nodes, points, seed, device)
        fixed = model.fixed(samples, samples.nodes)
        centre, size = (fixed[f"fixed/{name}"][:, None] for name in ("centre", "size"))
        self.nodes = tensor((samples.nodes.reshape(len(samples), -1, 2) - centre) / size).to(device)
        known = _known(model, samples.ni, samples.nj)
        known[self.outside] = False
        self.known = torch.from_numpy(np.flatnonzero(known)).to(device)
        self.to(device)

    def forward(self, rows: Tensor, step: int) -> Tensor:
        """Return the weighted terms of the loss over the geometries with indices `rows`."""
        net = {name: value[rows] for name, value in self.named_parameters()}
        inner, outer = self._drawn(step)
        answer = self._plain(net, self.places[outer])
        boundary = ((answer - self.nodes[rows][:, outer]) ** 2).sum(-1).mean()
        winslow = (self._residual(net, inner) ** 2).sum(-1).mean()
        data = 0.0 * boundary
        if len(self.known):
            answer = self._plain(net, self.places[self.known])
            data = ((answer - self.nodes[rows][:, self.known]) ** 2).sum(-1).mean()
        return torch.stack([winslow, self.model.rim * boundary, self.model.data * data])

    def _drawn(self, step: int) -> tuple[Tensor, Tensor]:
        """Return points inside (p, 2), in (xi, eta), and indices of nodes on the boundary."""
        device = self.places.device
        if self.points is None:
            inside, outside = (torch.from_numpy(k).to(device) for k in (self.inside, self.outside))
            return self.places[inside], outside
        rng = np.random.default_rng([self.seed, 1, step])
        inner = tensor(rng.random((self.points[0], 2))).to(device)
        outer = self.outside[rng.integers(0, len(self.outside), self.points[1])]
        return inner, torch.from_numpy(outer).to(device)

    def _plain(self, net: dict[str, Tensor], points: Tensor) -> Tensor:
        h = self.model.features(torch, points)[None]
        return _layers(net, [h])[0]

    def _residual(self, net: dict[str, Tensor], points: Tensor) -> Tensor:
        h = self.model.finite
        if h > 0:
            X: Sequence[Tensor] = self._differences(net, points, h)
        else:
            X = _layers(net, [f[None] for f in self.model.slopes(torch, points)])[1:]
        return left_side(X, lambda a, b: (a * b).sum(-1, keepdim=True))[0]

    def _differences(self, net: dict[str, Tensor], points: Tensor, h: float) -> Sequence[Tensor]:
        steps = [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]
        at = torch.cat(
            [points + h * torch.tensor(s, dtype=points.dtype, device=points.device) for s in steps]
        )
        o, e, w, n, s, ne, se, nw, sw = self._plain(net, at).chunk(9, dim=1)
        first = ((e - w) / (2 * h), (n - s) / (2 * h))
        return (*first, (e - 2 * o + w) / h**2, (ne - se - nw + sw) / (4 * h**2), (n - 2 * o + s) / h**2)


def _layers(net: dict[str, Tensor], h: list[Tensor]) -> list[Tensor]:
    """Return the network's output (batch, p, 2), and its derivatives when `h` has those of the features.

    With z = h W + b and t = tanh z: t_a = (1 - t^2) z_a, t_ab = (1 - t^2) z_ab - 2 t (1 - t^2) z_a z_b.
    """
    depth = sum(name.endswith("weight") for name in net)
    for k in range(depth):
        weight, bias = net[f"net/{k}/weight"], net[f"net/{k}/bias"]
        z = [part @ weight for part in h]
        z[0] = z[0] + bias
        if k == depth - 1:
            return z
        t = torch.tanh(z[0])
        if len(z) == 1:
            h = [t]
            continue
        slope = 1.0 - t * t
        bend = -2.0 * t * slope
        _, a, b, aa, ab, bb = z
        second = [slope * aa + bend * a * a, slope * ab + bend * a * b, slope * bb + bend * b * b]
        h = [t, slope * a, slope * b, *second]
    return h


def _known(model: MGNet, ni: int, nj: int) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return a mask (ni * nj,) of the known nodes: those of auxiliary lines and of a coarse grid."""
    known = np.zeros((ni, nj), dtype=bool)
    for axis, n in ((0, ni), (1, nj)):
        if model.lines:
            lines = np.round(np.linspace(0, n - 1, model.lines + 2)).astype(int)[1:-1]
            known[lines if axis == 0 else slice(None), lines if axis == 1 else slice(None)] = True
    if model.coarse:
        if not 3 <= model.coarse <= min(ni, nj):
            raise InputError(f"coarse={model.coarse}", f"use 3 to {min(ni, nj)}", parameter="set")
        rows, columns = (np.round(np.linspace(0, n - 1, model.coarse)).astype(int) for n in (ni, nj))
        known[np.ix_(rows, columns)] = True
    return known.reshape(-1)
