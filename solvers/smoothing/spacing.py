"""What lengths the edges of a given grid should have: its own, but for jumps from one to the next.

::

    given    o---o---o---o---o-o-o-o-o-o      where neighbours differ by more than a factor,
    wanted   o---o---o--o--o-o-o-o-o-o-o      that of both is diffused along grid lines and across

Only ratios of neighbours count. Edges that are not to change stay as they are: those that leave thin first
cells at the boundary, and those of a boundary whose nodes are fixed.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import line_neighbours

THIN = 3.0
"""Ratio of sides from which a cell at the boundary is one of layers, whose height is meant."""
_ROUNDS = 200
_SHARE = 0.17
"""Of what is too much between two edges, that each gives way by in a round; four neighbours at the most."""


def lengths(mesh: QuadMesh) -> Floats:
    """Return the lengths (e,) of `mesh.edges`."""
    ends = mesh.nodes[mesh.edges]
    return np.asarray(np.hypot(*(ends[:, 1] - ends[:, 0]).T))


def wanted_lengths(mesh: QuadMesh, most: float, *, slide: bool) -> Floats:
    """Return lengths (e,) of `mesh.edges` of which no neighbours differ by much more than a factor `most`.

    Nodes of the boundary are fixed unless they `slide`.
    """
    own = log(lengths(mesh))
    cap, stays = math.log(most), thin_heights(mesh)
    if not slide:
        stays |= mesh.on_wall
    numbers = np.arange(len(mesh.nodes)), np.arange(len(mesh.edges))
    beside, _ = line_neighbours(
        np.ascontiguousarray(mesh.quads), np.ascontiguousarray(mesh.edge_of), *numbers
    )
    moving = np.flatnonzero(~stays)
    beside = beside[moving]
    for _ in range(_ROUNDS):
        step = own[beside] - own[moving, None]
        excess = step - np.clip(step, -cap, cap)
        if not excess.any():
            break
        own[moving] += _SHARE * excess.sum(axis=1)
    return exp(own)


def thin_heights(mesh: QuadMesh) -> NDArray[np.bool_]:
    """Say of each edge (e,) whether it leaves the boundary beside a cell that is thin along it."""
    cell, side = np.nonzero(mesh.on_wall[mesh.edge_of])
    ratio = mesh.aspects(lengths(mesh))[cell]
    thin = np.where(side % 2 == 0, ratio < 1.0 / THIN, ratio > THIN)
    beside = mesh.edge_of[cell[:, None], (side[:, None] + [1, 3]) % 4][thin]
    heights = np.zeros(len(mesh.edges), dtype=bool)
    heights[beside.ravel()] = True
    return np.asarray(heights & (mesh.wall_nodes[mesh.edges].sum(axis=1) == 1))
