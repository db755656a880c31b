"""Held-out figures of a quad network: its grids beside those that it was trained on."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.solvers.neural.fit.angles import extremes
from meshonet.solvers.neural.quad.encoding import HEADS

Grids = NDArray[np.complexfloating[Any, Any]]


def held_out_figures(answers: Grids, base: Grids, winslow: Grids, variational: Grids) -> dict[str, Any]:
    """Return what the network's grids `answers` (m, heads, n, n) are like beside their targets (m, n, n).

    Angles are those of cells' corners: the largest of a grid and the mean over cells of the largest of each.
    A gain is what a grid's figure improves on Winslow's, over what the variational grid does; Winslow's grid
    may fold where its equations do, and such domains are left out of gains.
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
    """Return largest angles and means of cells' largest (m,), degrees, of grids (m, n, n); 360 if folded."""
    least, most = (np.degrees(value.numpy()) for value in extremes(torch.from_numpy(z)))
    folded = (least <= 0.0).any((1, 2)) | (most >= 180.0).any((1, 2))
    return np.where(folded, 360.0, most.max((1, 2))), np.where(folded, 360.0, most.mean((1, 2)))


def _norm(z: Grids) -> Floats:
    return np.asarray(np.sqrt((np.abs(z) ** 2).sum(axis=(1, 2))))


def _rounded(value: Any) -> float:
    return float(f"{float(value):.3e}")


def _share(values: NDArray[np.bool_]) -> float:
    return _rounded(values.mean())
