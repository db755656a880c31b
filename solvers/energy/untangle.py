"""Untangles a folded grid as a whole, by minimising the functional with regularised Jacobians."""

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.polygon.area import polygon_area
from meshonet.solvers.energy.functional import Weights, value
from meshonet.solvers.energy.preconditioner import Descent

STILL = 1e-3  # move of a node, in its own cells, below which minimising with one regularisation stops
ITERATIONS = 60  # with one regularisation, at the most

REGULARISATIONS = 30  # at the most
WITHOUT_GAIN = 3  # regularisations without gain after which unfolding is given up


def unfold(
    nodes: Floats, weights: Weights, *, periodic: bool = False, aspect: float | None = None,
    iterations: int = ITERATIONS,
) -> tuple[bool, int]:  # fmt: skip
    """Untangle planar `nodes` (ni, nj, 2) in place; return whether no cell is folded, and the iterations.

    Jacobians are regularised by a positive number, which is at least halved after each minimisation. A
    minimisation has up to `iterations` iterations. `periodic` and `aspect` are as in `Descent`.
    """
    descent = Descent(nodes, weights, periodic, aspect)
    cell = _cell_area(nodes)
    epsilon, best, idle, spent = cell, -np.inf, 0, 0
    for _ in range(REGULARISATIONS):
        _, smallest, done = descent.run(STILL, iterations, epsilon=epsilon)
        spent += done
        if smallest > 0:
            return True, spent
        idle = 0 if smallest > 0.9 * best else idle + 1
        if idle == WITHOUT_GAIN:
            break
        best = max(best, smallest)
        epsilon = min(0.5 * epsilon, max(0.2 * abs(smallest), 1e-6 * cell))
    return False, spent


NARROW = 0.3, 1e-6  # of regularisations that widen cells: each one over that before, the last over a cell
LONG = 300  # iterations with each of them


def widen(nodes: Floats, weights: Weights) -> None:
    """Open the nearly folded cells of planar `nodes` (ni, nj, 2) in place; no cell may be folded before.

    Regularised Jacobians make the barrier of the functional less steep at first. If cells are folded at the
    end, or the functional is not lower than before, the nodes are not changed.
    """
    trial = nodes.copy(order="K")
    descent, before = Descent(trial, weights), value(nodes, weights)
    epsilon = cell = _cell_area(nodes)
    while epsilon > NARROW[1] * cell:
        _, smallest, _ = descent.run(STILL, LONG, epsilon=epsilon)
        epsilon *= NARROW[0]
    if smallest > 0.0 and value(trial, weights) < before:
        nodes[:] = trial


def _cell_area(nodes: Floats) -> float:
    rim = [nodes[:-1, 0], nodes[-1, :-1], nodes[:0:-1, -1], nodes[0, :0:-1]]
    return abs(polygon_area(np.concatenate(rim))) / ((nodes.shape[0] - 1) * (nodes.shape[1] - 1))
