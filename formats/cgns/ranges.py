"""Ranges of nodes on the sides of zones, as CGNS counts them: from 1, first and last node of every index."""

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES, Range
from meshonet.geometry.blocks.connection import Connection

Integers = NDArray[np.int32]


def range_of(side: Side, span: Range, counts: tuple[int, ...]) -> Integers:
    """Return the first and the last node (2, d) of a part of a side of a zone of `counts` nodes."""
    axis, end = PLACES[side]
    place = [0 if end == 0 else counts[axis] - 1] * 2
    rows = [*span[:axis], tuple(place), *span[axis:]]
    return np.array(rows, np.int32).T + np.int32(1)


def donor_range(each: Connection, counts: tuple[int, ...]) -> Integers:
    """Return the first and the last node of the donor's part, at those of the connection's own one."""
    span = list(each.donor_range)
    for way in each.orientation:
        if way < 0:
            span[-way - 1] = span[-way - 1][::-1]
    return range_of(each.donor_side, tuple(span), counts)


def transform_of(each: Connection) -> Integers:
    """Return the donor's index along each index of the zone, counted from 1, negative where opposed."""
    (axis, end), (other, donor_end) = PLACES[each.side], PLACES[each.donor_side]
    dimension = len(each.orientation) + 1
    donor_axes = [index for index in range(dimension) if index != other]
    transform = np.zeros(dimension, np.int32)
    transform[axis] = (1 + other) * (-1 if end == donor_end else 1)
    own_axes = [index for index in range(dimension) if index != axis]
    for index, way in zip(own_axes, each.orientation, strict=True):
        transform[index] = (1 + donor_axes[abs(way) - 1]) * (1 if way > 0 else -1)
    return transform
