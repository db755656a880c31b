"""Angles of cells, in a quad network's loss and in its figures beside the grids that it was trained on."""

import math
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from meshonet.geometry.arrays import Bools, Floats
from meshonet.solvers.neural.quad.encoding import HEADS

NARROW, WIDE = math.radians(2.0), math.radians(172.0)  # angles beyond which a cell is taken to begin to fold
SLIGHT = 0.05  # radians beyond: with less, a cell counts in proportion, with more, by its logarithm
TINY = 1e-20  # area added where an edge is a point, so that its angle has a derivative

Grids = NDArray[np.complexfloating[Any, Any]]


def held_out_figures(answers: Grids, base: Grids, winslow: Grids, variational: Grids) -> dict[str, Any]:
    """Return error measures, by name, of the grids that a network predicts for m domains.

    Nodes are complex numbers. `answers` (m, 2, n, n) are the network's Winslow and variational grids, made
    from the grids `base` (m, n, n). The solvers' grids are `winslow` and `variational`. In the names, ``max``
    is the largest cell angle of a grid, and ``mean`` the mean of the largest angles of its cells. A ``gain``
    is sum(W - P) / sum(W - V): W is such an angle in `winslow`, P in the network's variational grids, V in
    `variational`. The sums leave out domains for which `winslow` or the network's grid has folded cells.
    """
    solved, best = angles(winslow), angles(variational)
    valid = solved[0] < 360.0
    figures: dict[str, Any] = {"domains": len(answers), "winslow_valid": _share(valid)}
    for k, (name, goal) in enumerate(zip(HEADS, (winslow, variational), strict=True)):
        own = angles(answers[:, k])
        error = _norm(answers[:, k] - goal) / _norm(goal)
        quantiles = {"median": np.quantile(error, 0.5), "p90": np.quantile(error, 0.9)}
        figures[name] = {
            "relative_l2": {key: _rounded(value) for key, value in quantiles.items()},
            "base": _rounded(np.median(_norm(base - goal) / _norm(goal))),
            "fold_free": _share(own[0] < 360.0),
        }
    both = valid & (own[0] < 360.0)
    for which, label in enumerate(("max", "mean")):
        gain = (solved[which] - own[which])[both].sum() / (solved[which] - best[which])[both].sum()
        figures["variational"][f"{label}_not_above_winslow"] = _share(own[which] <= solved[which] + 1e-2)
        figures["variational"][f"{label}_gain"] = _rounded(gain)
    return figures


def angles(z: Grids) -> tuple[Floats, Floats]:
    """Return maximum and mean (m,) of the greatest angles of the cells in each of the grids `z` (m, n, n).

    Angles are in degrees. Both numbers are 360 for a grid with folded cells.
    """
    least, most = (np.degrees(value.numpy()) for value in extremes(torch.from_numpy(z)))
    folded = (least <= 0.0).any((1, 2)) | (most >= 180.0).any((1, 2))
    return np.where(folded, 360.0, most.max((1, 2))), np.where(folded, 360.0, most.mean((1, 2)))


def _norm(z: Grids) -> Floats:
    return np.asarray(np.sqrt((np.abs(z) ** 2).sum(axis=(1, 2))))


def _rounded(value: Any) -> float:
    return float(f"{float(value):.3e}")


def _share(values: Bools) -> float:
    return _rounded(values.mean())


def excess(z: Tensor, goal: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Return three measures (batch,) of how much worse angles in grids `z` are than in grids `goal`.

    Both grids have complex nodes (batch, m, n). The first two measures are the increases, in radians,
    of the mean and of the maximum of the cells' greatest angles, from `goal` to `z`; decreases count as
    0. The third grows with cells that are folded, or nearly so, and worse than in
    `goal`: the greatest angle is larger than in `goal` and above 172 degrees (`WIDE`), or the least is
    smaller than in `goal` and below 2 degrees (`NARROW`).
    """
    least, most = extremes(z)
    with torch.no_grad():
        low, high = extremes(goal)
    mean = torch.relu((most - high).mean((1, 2)))
    widest = torch.relu(most.amax((1, 2)) - high.amax((1, 2)))
    folded = torch.relu(most - high.clamp(min=WIDE)) + torch.relu(low.clamp(max=NARROW) - least)
    return mean, widest, torch.log1p(folded.sum((1, 2)) / SLIGHT)


def extremes(z: Tensor) -> tuple[Tensor, Tensor]:
    """Return the smallest and the greatest corner angle of each cell (batch, m - 1, n - 1), in radians.

    Angles of folded corners are negative or above π, so that the loss has a gradient there.
    """
    u, v = z.diff(dim=1), z.diff(dim=2)
    south, north, west, east = u[:, :, :-1], u[:, :, 1:], v[:, :-1], v[:, 1:]
    corners = ((south, west), (east, -south), (-north, -east), (-west, north))
    angles = torch.stack([_angle(p, q) for p, q in corners])
    return angles.amin(0), angles.amax(0)


def _angle(u: Tensor, v: Tensor) -> Tensor:
    """Return the angle from u to v, from -90 to 270 degrees."""
    product = u.conj() * v
    angle = torch.atan2(product.imag, product.real + TINY)
    return torch.where(angle < -0.5 * math.pi, angle + 2.0 * math.pi, angle)
