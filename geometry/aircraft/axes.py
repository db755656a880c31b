"""Axes of a file and those of an aircraft: x along the body, y up, z along the span."""

from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.halves import with_i_reversed

_NAMES = "xyz"
FLAT = 1e-6  # tolerance for nodes in the plane of symmetry or at an end of the body, in sizes of the surface


@dataclass(frozen=True)
class AircraftAxes:
    """Which axes of a file point upwards and along the span; x is always along the body."""

    # up, span: 1 for y, 2 for z
    up: int = 1
    span: int = 2
    sign: int = 1  # -1 if the file has the half with negative span coordinates, else 1

    @property
    def description(self) -> str:
        """Description of the axes, as text for notes."""
        half = ">=" if self.sign > 0 else "<="
        return f"{_NAMES[self.up]} points up, and the half is that of {_NAMES[self.span]} {half} 0"

    def to_aircraft(self, points: Floats) -> Floats:
        """Convert `points` (..., 3) from the axes of the file to the axes of the aircraft."""
        return np.stack([points[..., 0], points[..., self.up], self.sign * points[..., self.span]], axis=-1)

    def to_file(self, grid: Grid) -> Grid:
        """Return an aircraft's `grid` in the axes of the file; i is reversed if this mirrors the grid."""
        if self == AircraftAxes():
            return grid
        if (self.sign > 0) != (self.up == 1):  # the other handedness
            grid = with_i_reversed(grid)
        blocks = []
        for block in grid.blocks:
            nodes = np.empty_like(block.nodes)
            nodes[..., 0], nodes[..., self.up] = block.nodes[..., 0], block.nodes[..., 1]
            nodes[..., self.span] = self.sign * block.nodes[..., 2] + 0.0
            blocks.append(Block(nodes, finite=True))
        return replace(grid, blocks=tuple(blocks))


FILE_AXES = AircraftAxes()  # the axes of a file that already has the axes of an aircraft


def axes_of(points: Floats) -> AircraftAxes | None:
    """Return which axes point up and along the span, if `points` (n, 3) are half an aircraft; else None."""
    flat = FLAT * float(np.ptp(points, axis=0).max())
    for span in (2, 1):
        for sign in (1, -1):
            if (sign * points[:, span]).min() >= -flat:
                return AircraftAxes(3 - span, span, sign)
    return None
