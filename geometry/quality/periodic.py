"""Mismatch of periodic sides, compared in cylindrical coordinates and not by the matrix that made them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.screw import Screw, by_period, period_of
from meshonet.geometry.elementary import arctan2


@dataclass(frozen=True)
class Period:
    """The rotation or translation from one side of a periodic pair to the other."""

    angle: float  # angle of the rotation in degrees, 0 for a translation
    shift: float  # length of the translation, 0 for a rotation
    mismatch: float  # largest distance of nodes after the motion, divided by radius or the shift's length
    along: tuple[float, ...] = ()  # unit vector (x, y, z) of the translation, empty for a rotation


def periods(grid: Grid) -> tuple[Period, ...]:
    """Return the different rotations and translations between periodic sides of a grid."""
    groups = by_period(grid.connections)
    return tuple(_period(motion, [_sides(grid, each) for each in own]) for motion, own in groups)


def _sides(grid: Grid, each: Connection) -> tuple[Floats, Floats]:
    """Return the nodes (n, 3) of both sides of a connection in one order."""
    pair = replace(each, transform=None).nodes(grid.face)
    flat = (nodes.reshape(-1, nodes.shape[-1]) for nodes in pair)
    own, donor = (np.pad(nodes, ((0, 0), (0, 3 - nodes.shape[1]))) for nodes in flat)
    return own, donor


def _period(motion: Motion, sides: Sequence[tuple[Floats, Floats]]) -> Period:
    screw, _ = period_of(motion)
    own, donor = (np.concatenate(nodes) for nodes in zip(*sides, strict=True))
    if not screw.angle:
        length = float(norms(screw.shift))
        apart = float(norms(donor - own - screw.shift).max()) / length
        return Period(0.0, length, apart, tuple((screw.shift / length + 0.0).tolist()))
    (x, r, a), (x2, r2, b) = (_cylindrical(nodes, screw) for nodes in (own, donor))
    across = np.cross(a, b)
    around = arctan2((across * screw.axis).sum(axis=1), (a * b).sum(axis=1)) - screw.angle
    off = np.stack([x2 - x - (screw.shift * screw.axis).sum(), r2 - r, r * around])
    return Period(math.degrees(abs(screw.angle)), 0.0, float((norms(off.T) / np.maximum(r, 1e-300)).max()))


def _cylindrical(nodes: Floats, screw: Screw) -> tuple[Floats, Floats, Floats]:
    """Return places along the axis, distances from it, and the ways (n, 3) from it to nodes."""
    off = nodes - screw.centre
    x = (off * screw.axis).sum(axis=1)
    way = off - x[:, None] * screw.axis
    return x, norms(way), way
