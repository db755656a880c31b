"""Quadrilaterals and index directions of structured arrays of nodes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, cross2, ring_of
from meshonet.kernels._native import smallest_corners

if TYPE_CHECKING:
    from meshonet.geometry.layout.layout import Layout


def corner_jacobians(corners: Floats) -> Floats:
    """Return the Jacobians (m, 4) at the four corners of planar quadrilaterals `corners` (m, 4, 2)."""
    return cross2(np.roll(corners, -1, axis=1) - corners, np.roll(corners, 1, axis=1) - corners)


def smallest_jacobians(nodes: Floats, quads: Indices) -> Floats:
    """Return the smallest corner Jacobian (m,) of each of the `quads` (m, 4), indices of `nodes` (n, 2)."""
    return smallest_corners(np.ascontiguousarray(nodes), np.ascontiguousarray(quads, dtype=np.intp))


def lattice_quads(blocks: Sequence[Indices]) -> Indices:
    """Return the quads (m, 4), counter-clockwise and with j fastest, of `blocks` (ni, nj) of node indices."""
    return np.concatenate([ring_of(block).reshape(4, -1).T for block in blocks])


def around_body(layout: Layout) -> Layout:
    """Return a layout of one ring-shaped block, turned so that i runs around the hole and j outwards from it.

    The block stays right-handed, so i runs clockwise. A layout that is no single ring is returned unchanged.
    """
    if len(layout.blocks) != 1:
        return layout
    block = layout.blocks[0]
    if np.array_equal(block[:, 0], block[:, -1]):  # the ring closes along j
        block = np.swapaxes(block, 0, 1)[:, ::-1]
    if not np.array_equal(block[0], block[-1]):
        return layout
    if layout.mesh.places.loop[block[0, 0]] == 0:
        block = block[::-1, ::-1]
    return replace(layout, blocks=(block,), layers={})
