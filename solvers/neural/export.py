"""A trained network to a model file, with its recipe and its held-out figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from meshonet.geometry.arrays import Complexes, Floats
from meshonet.solvers.conformal.strip import across, harmonic, picard
from meshonet.solvers.neural.encoding import VERSION
from meshonet.solvers.neural.strip_dataset import Strips
from meshonet.solvers.neural.weights import KIND, write_tensors

QUANTILES = {"median": 0.5, "p90": 0.9, "worst": 1.0}


def distance(found: Complexes, goal: Complexes) -> float:
    """Return the root mean square of |found - goal| (radians) over the strip, from modes (.., LEVELS)."""
    return float(np.sqrt((np.abs(found - goal) ** 2).sum(axis=0).mean()))


def held_out_figures(answer: Callable[[int], Complexes], test: Strips) -> dict[str, Any]:
    """Return quantiles of the distance to R over held-out strips: the network's beside those without it.

    `answer(m)` is the network's R for strip m, (2 MODES + 1, LEVELS).
    """
    misses: dict[str, list[float]] = {}
    for m in range(len(test)):
        goal, start = test.residual[m], harmonic(test.wall[m], test.far[m], across().eta)
        found = answer(m)
        for way, residual in (
            ("base", np.zeros_like(goal)),
            ("base + 1 Picard", picard(start, 1)[0] - start),
            ("base + 2 Picard", picard(start, 2)[0] - start),
            ("network", found),
            ("network + 1 Picard", picard(start + found, 1)[0] - start),
        ):
            misses.setdefault(way, []).append(distance(residual, goal))
    figures: dict[str, Any] = {
        "strips": len(test),
        "error": "root mean square distance to the Winslow solution in the strip, radians",
    }
    for way, values in misses.items():
        figures[way] = {key: float(f"{np.quantile(values, q):.3e}") for key, q in QUANTILES.items()}
    return figures


def write_model(
    path: Path,
    state: Mapping[str, Floats],
    basis: Floats,
    scale: float,
    *,
    name: str,
    recipe: Mapping[str, Any],
    figures: Mapping[str, Any],
) -> None:
    """Write a model file: float16 weights, the basis in float32, the header that `weights` checks."""
    arrays: dict[str, Any] = {key: value.astype(np.float16) for key, value in state.items()}
    arrays["basis"] = basis.astype(np.float32)
    header = {
        "kind": KIND,
        "encoding": VERSION,
        "name": name,
        "topology": "o",
        "scale": scale,
        "recipe": dict(recipe),
        "figures": dict(figures),
    }
    write_tensors(path, arrays, header)
