"""A single block that closes around a body, as an O grid has it: south the body, west joined to east."""

from dataclasses import replace

import numpy as np

from meshonet.geometry.layout.layout import Layout


def around_body(layout: Layout) -> Layout:
    """Return a layout of one ring-shaped block with i around the hole, j away from it; others unchanged.

    The block stays right-handed: i runs clockwise.
    """
    if len(layout.blocks) != 1:
        return layout
    block = layout.blocks[0]
    if np.array_equal(block[:, 0], block[:, -1]):  # a ring along j
        block = np.swapaxes(block, 0, 1)[:, ::-1]
    if not np.array_equal(block[0], block[-1]):
        return layout
    if layout.mesh.places.loop[block[0, 0]] == 0:
        block = block[::-1, ::-1]
    return replace(layout, blocks=(block,), layers={})
