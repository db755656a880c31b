"""One-to-one interfaces of CGNS zones as they are written: ranges, transforms, periodic properties.

The transform says which index of the donor each index of the zone runs along. Along the interface that is
what the connection says; across it, a step out of the zone is one into the donor.
https://cgns.github.io/standard/SIDS/multizone_interface.html
"""

from collections.abc import Sequence

import numpy as np

from meshonet.formats.cgns.nodes import NAME_LENGTH, Node, child
from meshonet.formats.cgns.ranges import donor_range, range_of, transform_of
from meshonet.formats.mesh.names import words
from meshonet.formats.mesh.periodic import patch_on
from meshonet.geometry.blocks.connection import Connection, Motion
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.screw import screw_of


def write_connections(zones: Sequence[Node], names: Sequence[str], grid: Grid) -> None:
    """Join the two sides of each connection of `grid`, once from each, in the `zones` of its blocks."""
    groups: dict[int, Node] = {}
    taken: dict[int, set[str]] = {}
    counts = [block.counts for block in grid.blocks]
    for each in grid.connections:
        for way in (each, each.reversed()):
            if way.block not in groups:
                group = child(zones[way.block], "ZoneGridConnectivity", "ZoneGridConnectivity_t")
                groups[way.block], taken[way.block] = group, set()
            group = groups[way.block]
            title = _title(grid, way, names)
            word = words([title], NAME_LENGTH, taken[way.block])[title]
            taken[way.block].add(word)
            joint = child(group, word, "GridConnectivity1to1_t", names[way.donor])
            own = range_of(way.side, way.range, counts[way.block])
            child(joint, "PointRange", "IndexRange_t", own)
            child(joint, "PointRangeDonor", "IndexRange_t", donor_range(way, counts[way.donor]))
            child(joint, "Transform", '"int[IndexDimension]"', transform_of(way))
            if way.transform is not None:
                _write_motion(joint, way.transform, grid.blocks[way.block].nodes.shape[-1])


def _title(grid: Grid, connection: Connection, names: Sequence[str]) -> str:
    """Return what to call an interface: as the patch that lies on it, if any."""
    own = "Cut" if connection.block == connection.donor else f"to_{names[connection.donor]}"
    return patch_on(grid, connection) or own


def _write_motion(joint: Node, motion: Motion, dimension: int) -> None:
    """Add the rotation in radians and the shift that carry the nodes of an interface to the donor's.

    Of two dimensions there is no axis to turn about; the angle is written as the last number all the same.
    """
    screw = screw_of(motion)
    node = child(
        child(joint, "GridConnectivityProperty", "GridConnectivityProperty_t"), "Periodic", "Periodic_t"
    )
    values = {"RotationCenter": screw.centre, "RotationAngle": screw.angles, "Translation": screw.shift}
    for name, numbers in values.items():
        turns = name == "RotationAngle"
        kept = numbers[3 - dimension :] if turns else numbers[:dimension]
        array = child(node, name, "DataArray_t", np.array(kept, np.float32) + np.float32(0))
        exponents = np.array([0, not turns, 0, 0, turns], np.float64)
        child(array, "DimensionalExponents", "DimensionalExponents_t", exponents)
