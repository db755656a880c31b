"""One-to-one interfaces of CGNS zones as they are written: ranges, transforms, periodic properties."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from meshonet.formats.cgns.nodes import NAME_LENGTH, Node, child
from meshonet.formats.mesh.names import words
from meshonet.formats.mesh.periodic import donor_range, patch_on
from meshonet.geometry.arrays import Side
from meshonet.geometry.blocks.block import PLACES, Range
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.screw import screw_of

Integers = NDArray[np.int32]


def range_of(side: Side, span: Range, counts: tuple[int, ...]) -> Integers:
    """Return the first and last node (2, d) of the part `span` of a side of a zone, counted from 1."""
    axis, end = PLACES[side]
    place = [0 if end == 0 else counts[axis] - 1] * 2
    rows = [*span[:axis], tuple(place), *span[axis:]]
    return np.array(rows, np.int32).T + np.int32(1)


def write_connections(zones: Sequence[Node], names: Sequence[str], grid: Grid) -> None:
    """Write each connection of `grid` as an interface into both zones that it connects.

    `zones` and `names` are the CGNS nodes and the names of the zones, one per block. The transform of an
    interface states, for each direction of the zone, the corresponding direction of the donor; a step out of
    the zone is a step into the donor. https://cgns.github.io/standard/SIDS/multizone_interface.html
    """
    groups: dict[int, Node] = {}
    taken: dict[int, set[str]] = {}
    counts = [block.counts for block in grid.blocks]
    for each in grid.connections:
        for way in (each, each.reversed()):
            if way.block not in groups:
                group = child(zones[way.block], "ZoneGridConnectivity", "ZoneGridConnectivity_t")
                groups[way.block], taken[way.block] = group, set()
            group = groups[way.block]
            title = patch_on(grid, way) or ("Cut" if way.block == way.donor else f"to_{names[way.donor]}")
            word = words([title], NAME_LENGTH, taken[way.block])[title]
            taken[way.block].add(word)
            joint = child(group, word, "GridConnectivity1to1_t", names[way.donor])
            own = range_of(way.side, way.range, counts[way.block])
            donor = range_of(way.donor_side, donor_range(way), counts[way.donor])
            child(joint, "PointRange", "IndexRange_t", own)
            child(joint, "PointRangeDonor", "IndexRange_t", donor)
            child(joint, "Transform", '"int[IndexDimension]"', _transform(way))
            if way.transform is not None:
                _write_motion(joint, way.transform, grid.blocks[way.block].nodes.shape[-1])


def _transform(each: Connection) -> Integers:
    """Return the donor's index direction for each of the zone's, from 1, negative if it is opposed."""
    (axis, end), (other, donor_end) = PLACES[each.side], PLACES[each.donor_side]
    dimension = len(each.orientation) + 1
    donor_axes = [index for index in range(dimension) if index != other]
    transform = np.zeros(dimension, np.int32)
    transform[axis] = (1 + other) * (-1 if end == donor_end else 1)
    own_axes = [index for index in range(dimension) if index != axis]
    for index, way in zip(own_axes, each.orientation, strict=True):
        transform[index] = (1 + donor_axes[abs(way) - 1]) * (1 if way > 0 else -1)
    return transform


def _write_motion(joint: Node, motion: Motion, dimension: int) -> None:
    """Add the rotation (radians) and translation to the donor; planar zones have one angle."""
    screw = screw_of(motion)
    outer = child(joint, "GridConnectivityProperty", "GridConnectivityProperty_t")
    node = child(outer, "Periodic", "Periodic_t")
    values = {"RotationCenter": screw.centre, "RotationAngle": screw.angles, "Translation": screw.shift}
    for name, numbers in values.items():
        turns = name == "RotationAngle"
        kept = numbers[3 - dimension :] if turns else numbers[:dimension]
        array = child(node, name, "DataArray_t", np.array(kept, np.float32) + np.float32(0))
        exponents = np.array([0, not turns, 0, 0, turns], np.float64)
        child(array, "DimensionalExponents", "DimensionalExponents_t", exponents)
