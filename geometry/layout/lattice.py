"""Quadrilaterals of lattices of nodes."""

from collections.abc import Sequence

import numpy as np

from meshonet.geometry.polygon.corners import Indices


def lattice_quads(blocks: Sequence[Indices]) -> Indices:
    """Return the quads (m, 4), counter-clockwise, of blocks (ni, nj) of node numbers, j fastest in each."""
    quads = [
        np.stack([block[:-1, :-1], block[1:, :-1], block[1:, 1:], block[:-1, 1:]], axis=-1).reshape(-1, 4)
        for block in blocks
    ]
    return np.concatenate(quads)
