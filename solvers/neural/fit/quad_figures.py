"""Held-out figures of a quad network: its grids beside those that it was trained on."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.solvers.neural.quad.encoding import HEADS

Grids = NDArray[np.complexfloating[Any, Any]]


def held_out_figures(found: Grids, base: Grids, winslow: Grids, variational: Grids) -> dict[str, Any]:
    """Return what the network's grids `found` (m, heads, n, n) are like beside their targets (m, n, n).

    Angles are those of cells' corners, degrees: the largest of a grid and the mean over cells of the largest
    of each. A gain is what a grid's figure improves on Winslow's, over what the variational grid does;
    Winslow's grid may fold where its equations do, and such domains are left out of gains.
    """
    goals = dict(zip(HEADS, (winslow, variational), strict=True))
    solved = {name: angles(goal) for name, goal in goals.items()}
    valid = solved["winslow"][0] < 360.0
    figures: dict[str, Any] = {"domains": len(found), "winslow_valid": _share(valid)}
    for k, (name, goal) in enumerate(goals.items()):
        own = angles(found[:, k])
        error = _norm(found[:, k] - goal) / _norm(goal)
        told = {
            "relative_l2": {
                key: _rounded(np.quantile(error, q)) for key, q in (("median", 0.5), ("p90", 0.9))
            },
            "base": _rounded(np.median(_norm(base - goal) / _norm(goal))),
            "fold_free": _share(own[0] < 360.0),
        }
        if name == "variational":
            for which, label in ((0, "max"), (1, "mean")):
                before, best = solved["winslow"][which], solved["variational"][which]
                told[f"{label}_not_above_winslow"] = _share(own[which] <= before + 1e-2)
                both = valid & (own[0] < 360.0)
                gain = (before - own[which])[both].sum() / (before - best)[both].sum()
                told[f"{label}_gain"] = _rounded(gain)
        figures[name] = told
    return figures


def angles(z: Grids) -> tuple[Floats, Floats]:
    """Return the largest angle and the mean of cells' largest (m,) of grids (m, n, n); 360 if folded."""
    u, v = np.diff(z, axis=1), np.diff(z, axis=2)
    south, north, west, east = u[:, :, :-1], u[:, :, 1:], v[:, :-1], v[:, 1:]
    turns = [np.angle(p.conj() * q) for p, q in ((south, west), (south, east), (north, east), (north, west))]
    opening = np.stack([turns[0], np.pi - turns[1], turns[2], np.pi - turns[3]])
    largest = np.degrees(opening.max(axis=0))
    folded = (np.stack(turns) <= 0).any(axis=(0, 2, 3)) | (np.stack(turns) >= np.pi).any(axis=(0, 2, 3))
    return tuple(np.where(folded, 360.0, value) for value in (largest.max((1, 2)), largest.mean((1, 2))))  # type: ignore[return-value]


def _norm(z: Grids) -> Floats:
    return np.asarray(np.sqrt((np.abs(z) ** 2).sum(axis=(1, 2))))


def _rounded(value: Any) -> float:
    return float(f"{float(value):.3e}")


def _share(values: NDArray[np.bool_]) -> float:
    return _rounded(values.mean())
