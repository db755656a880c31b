"""Index directions of a single block that closes around a body, as in an O grid: south is the body."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.layout.layout import Layout


def around_body(layout: Layout) -> Layout:
    """Return the layout of one ring-shaped block with i around the hole and j away from it; others unchanged.

    The block stays right-handed, so i runs clockwise.
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
