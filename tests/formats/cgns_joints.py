"""One-to-one interfaces of a CGNS file, followed by the standard's rule."""

from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid


def joined_nodes(path: Path, grid: Grid) -> Iterator[tuple[h5py.Group, Floats, Floats]]:
    """Yield each interface of a file, its nodes in `grid` (n, d) and those of the donor (n, d).

    The donor's index is begin + T (here - begin), T of the short form; the ends of the ranges must be so too.
    """
    with h5py.File(path) as file:
        zones = [node for node in file["Base"].values() if node.attrs.get("label") == b"Zone_t"]
        names = [zone.name.rpartition("/")[2] for zone in zones]
        for k, zone in enumerate(zones):
            for joint in zone.get("ZoneGridConnectivity", {}).values():
                own, donor, short = (
                    joint[f"{name}/ data"][()] for name in ("PointRange", "PointRangeDonor", "Transform")
                )
                matrix = np.zeros((len(short), len(short)), int)
                for axis, target in enumerate(short):
                    matrix[abs(target) - 1, axis] = np.sign(target)
                assert round(np.linalg.det(matrix)) == 1  # of right-handed zones
                np.testing.assert_array_equal(matrix @ (own[1] - own[0]), donor[1] - donor[0])
                ways = [np.arange(abs(b - a) + 1) * np.sign(b - a) for a, b in own.T]
                steps = np.stack(np.meshgrid(*ways, indexing="ij"), axis=-1).reshape(-1, len(short))
                here, there = own[0] + steps, donor[0] + steps @ matrix.T
                other = names.index(joint[" data"][()].tobytes().decode())
                nodes, theirs = (
                    grid.blocks[number].nodes[tuple(index.T - 1)]
                    for number, index in ((k, here), (other, there))
                )
                yield joint, nodes, theirs
