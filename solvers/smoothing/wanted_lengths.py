"""Target lengths of the edges of a given grid: its own, with jumps evened out."""

import math

import numpy as np

from meshonet.geometry.arrays import Bools, Floats
from meshonet.geometry.elementary import exp, log
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.kernels._native import line_neighbours

THIN = 3.0  # aspect ratio above which a boundary cell belongs to layers, whose heights are kept

_ROUNDS = 200  # of diffusion, at the most

_SHARE = 0.17
"""Fraction of the excess ratio of two of up to four neighbouring edges by which each changes in a round."""


def wanted_lengths(mesh: QuadMesh, most: float, *, slide: bool) -> Floats:
    """Return target lengths (e,) of `mesh.edges`; the ratio of neighbours is at most about `most`.

    Edges across thin cells at the boundary keep their lengths. So do edges along the boundary, unless
    boundary nodes `slide`. Only ratios of the lengths matter.
    """
    own = log(mesh.edge_lengths)
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


def thin_heights(mesh: QuadMesh) -> Bools:
    """Return a mask (e,) of the edges that are heights of thin boundary cells (aspect ratio above `THIN`)."""
    cell, side = np.nonzero(mesh.on_wall[mesh.edge_of])
    ratio = mesh.aspects(mesh.edge_lengths)[cell]
    thin = np.where(side % 2 == 0, ratio < 1.0 / THIN, ratio > THIN)
    beside = mesh.edge_of[cell[:, None], (side[:, None] + [1, 3]) % 4][thin]
    heights = np.zeros(len(mesh.edges), dtype=bool)
    heights[beside.ravel()] = True
    return np.asarray(heights & (mesh.wall_nodes[mesh.edges].sum(axis=1) == 1))
