"""A grid moved to unit size: unit chord around a body, unit length otherwise."""

from __future__ import annotations

import numpy as np

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError


def normalised(grid: Grid) -> Grid:
    """Return `grid` moved, scaled and, around a body, turned to unit size.

    Of an O or C grid the trailing edge, where xi begins on the body, comes to (1, 0), and the body's farthest
    node from it to (0, 0). Of a four-sided grid the lower left corner of its box comes to (0, 0) and the
    longer side of the box becomes 1.

    Raises InputError: the body has no length.

    >>> x, y = np.meshgrid([2.0, 4.0], [1.0, 2.0], indexing="ij")
    >>> normalised(Grid.from_nodes(np.stack([x, y], axis=-1))).nodes[1, 1].tolist()
    [1.0, 0.5]
    """
    if not grid.around_body:
        corner = grid.nodes.min(axis=(0, 1))
        return grid.with_nodes((grid.nodes - corner) / np.ptp(grid.nodes, axis=(0, 1)).max())
    body = grid.nodes[grid.wake : grid.ni - grid.wake, 0]
    trailing = body[0]
    leading = body[np.hypot(*(body - trailing).T).argmax()]
    ax, ay = trailing - leading
    square = ax * ax + ay * ay
    if not square > 0:
        raise InputError("the body has no length", "check that its side is the south one")
    # written out, not as a matrix product: nodes that coincide have to go on doing so bitwise
    x, y = grid.x - leading[0], grid.y - leading[1]
    nodes = np.stack([(x * ax + y * ay) / square, (y * ax - x * ay) / square], axis=-1)
    return grid.with_nodes(nodes)
