r"""Planar grids revolved about an axis in their plane: wedges, sectors and full revolutions.

::

         y ^     .------.           Planes of nodes are at angles about the axis; the first is `bottom`, the
           |    / grid /|           last `top`. Nodes on the axis stay there: a side on it collapses to a
           |   '------' |           line, the patch ``axis``. A wedge is one cell thick, half on each side of
     axis -+----------------> x     the plane of the grid; a sector begins in that plane.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import Floats, as_planar, extent_of
from meshonet.geometry.blocks.across import planar
from meshonet.geometry.blocks.block import face_of
from meshonet.geometry.blocks.extrude import End, thickened
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError

WEDGE_DEG = 10.0  # largest angle of a wedge, which is one cell thick, in degrees
CELL_DEG = 4.0  # largest angle of a cell of a sector if the number of planes is not given, in degrees
AXIS = "axis"  # patch of sides that lie on the axis
FLOWS: tuple[End, End] = (("inlet", "inlet"), ("outlet", "outlet"))
"""Name and kind of the two ends of a sector through which the fluid flows about the axis."""
_ON_AXIS = 1e-12  # over the size of the grid: nodes nearer to the axis are on it
_MOST_PLANES = 10_000  # more is taken for a typing error
_LEAST_DEG = 1e-3  # thinner cells lose their digits beside the radius


class AxisLine(NamedTuple):
    """A line in the plane: a point (x, y) on it, and its direction."""

    x: float = 0.0
    y: float = 0.0
    along_x: float = 1.0
    along_y: float = 0.0


X_AXIS = AxisLine()


@dataclass(frozen=True)
class Revolution:
    """Options for revolving a planar grid about an axis.

    Parameters
    ----------
    degrees : float
        Angle from the first plane to the last, up to 360.
    planes : int, optional
        Number of planes of nodes, at least 2. If None: 2 planes (one cell) for an angle of up to 10 degrees,
        otherwise enough planes for cells of at most 4 degrees.
    axis : AxisLine, optional
        Axis in the plane of the grid; by default the x axis.

    Raises
    ------
    InputError
        A value out of its range.
    """

    degrees: float
    planes: int | None = None
    axis: AxisLine = X_AXIS

    def __post_init__(self) -> None:
        if not _LEAST_DEG <= self.degrees <= 360.0:
            remedy = f"use {_LEAST_DEG:g} to 360"
            raise InputError(f"{self.degrees:g} degrees", remedy, parameter="revolve")
        if self.planes is not None and not 2 <= self.planes <= _MOST_PLANES:
            raise InputError(f"{self.planes} planes", f"use 2 to {_MOST_PLANES}", parameter="planes")
        if self.closed and self.count < 4:
            raise InputError(f"{self.planes} planes of a whole turn", "use 4 or more", parameter="planes")
        if not all(map(math.isfinite, self.axis)) or not math.hypot(*self.axis[2:]) > 0.0:
            raise InputError("a line without direction", "use x, y or X,Y,DX,DY", parameter="axis")

    @property
    def closed(self) -> bool:
        """Whether this is a full revolution, in which the last plane coincides with the first."""
        return self.degrees == 360.0

    @property
    def count(self) -> int:
        """Number of planes of nodes."""
        if self.planes is not None:
            return self.planes
        return 2 if self.degrees <= WEDGE_DEG else math.ceil(self.degrees / CELL_DEG - 1e-9) + 1

    @property
    def wedge(self) -> bool:
        """Whether this is a wedge: a single cell around the axis, of at most 10 degrees."""
        return self.count == 2 and self.degrees <= WEDGE_DEG

    @property
    def angles(self) -> Floats:
        """Angles (planes,) of the planes, in radians."""
        part = np.linspace(0.0, 1.0, self.count) - (0.5 if self.wedge else 0.0)
        return np.asarray(math.radians(self.degrees) * part)


def revolution(degrees: float | None, planes: int | None, axis: AxisLine | None) -> Revolution | None:
    """Return the revolution with these settings, or None if `degrees` is None.

    Raises InputError: an axis without an angle; the errors of `Revolution`.
    """
    if degrees is None:
        if axis is not None:
            raise InputError("nothing is turned", "give {revolve} as well", parameter="axis")
        return None
    return Revolution(degrees, planes, axis or X_AXIS)


class AxisFrame(NamedTuple):
    """Coordinates about an axis in the plane of a grid, with three attributes (2,).

    `point` is on the axis, `along` is its direction, `away` is the direction from the axis to the grid.
    """

    point: Floats
    along: Floats
    away: Floats
    slack: float = 0.0
    """Largest distance of nodes that count as on the axis."""

    def places(self, nodes: Floats, angles: Floats) -> Floats:
        """Return planar nodes (..., 2) rotated about the axis by `angles` in radians, as nodes (..., 3).

        The shape of `angles` broadcasts with the leading axes of `nodes`.
        """
        s, r = (((nodes - self.point) * way).sum(axis=-1) for way in (self.along, self.away))
        r = np.where(np.abs(r) <= self.slack, 0.0, r)
        flat = self.point + self.along * s[..., None] + self.away * (r * cos(angles))[..., None]
        return np.concatenate([flat, (r * sin(angles))[..., None]], axis=-1)

    def motion(self, angle: float) -> Motion:
        """Return the rotation about the axis by an angle in radians."""
        along, away = np.append(self.along, 0.0), np.append(self.away, 0.0)
        up, c, s = np.array([0.0, 0.0, 1.0]), math.cos(angle), math.sin(angle)
        turn = (
            np.outer(along, along)
            + c * (np.outer(away, away) + np.outer(up, up))
            + s * (np.outer(up, away) - np.outer(away, up))
        )
        centre = np.append(self.point, 0.0)
        shift = centre - (turn * centre).sum(axis=1)
        shift[np.abs(shift) <= _ON_AXIS * np.abs(centre).max()] = 0.0
        return Motion(tuple(shift.tolist()) if shift.any() else (), tuple(map(tuple, turn.tolist())))


def frame_of(points: Floats, axis: AxisLine) -> AxisFrame:
    """Return the frame of an axis; all `points` (n, 2) must lie on one side of it.

    Raises InputError: points on both sides of the axis, or all on it.
    """
    along = np.array(axis[2:]) / math.hypot(*axis[2:])
    slack = _ON_AXIS * max(extent_of(points), float(np.abs(points).max()))
    frame = AxisFrame(np.array(axis[:2]), along + 0.0, np.array([-along[1], along[0]]) + 0.0, slack)
    r = ((points - frame.point) * frame.away).sum(axis=1)
    low, high = float(r.min()), float(r.max())
    if low < -slack and high > slack:
        problem = (
            f"the axis runs through the grid, from {-low:.4g} to one side of it to {high:.4g} to the other"
        )
        raise InputError(problem, "move it to one side", parameter="axis")
    if max(-low, high) <= slack:
        raise InputError("the grid lies on the axis", "choose another one", parameter="axis")
    return frame if high > slack else frame._replace(away=-frame.away)


def revolved(grid: Grid, turn: Revolution, ends: tuple[End, End] | None = None) -> Grid:
    """Return a planar grid revolved about the axis of `turn`.

    If there is one cell over an angle of at most 10 degrees (a wedge), the first and last plane become the
    patches ``wedge1`` and ``wedge2``. Otherwise they become patches with the names and kinds `ends`, or are
    periodic if `ends` is None. In a full revolution, they coincide and are connected. Raises InputError:
    blocks that are not planar; periodic connections; nodes on both sides of the axis, or all on the axis.
    """
    planar(grid)
    if any(each.transform for each in grid.connections):
        raise InputError("the grid is periodic", "leave its periodic connections out")
    frame = frame_of(np.concatenate([block.nodes.reshape(-1, 2) for block in grid.blocks]), turn.axis)
    nodes = [_turned(block.nodes, frame, turn) for block in grid.blocks]
    if turn.wedge:
        ends = (("wedge1", "wedge"), ("wedge2", "wedge"))
    motion = None
    if not turn.closed and ends is None:
        motion = frame.motion(math.radians(turn.degrees))
        for each in nodes:
            each[:, :, -1] = motion(each[:, :, 0])
    return thickened(_with_axis(grid, frame), nodes, None if turn.closed else ends, motion)


def _turned(plane: Floats, frame: AxisFrame, turn: Revolution) -> Floats:
    """Return nodes (ni, nj, nk, 3), in planar layout, from a plane of nodes (ni, nj, 2)."""
    nodes = frame.places(plane[:, :, None], turn.angles)
    if turn.closed:
        nodes[:, :, -1] = nodes[:, :, 0]
    return as_planar(nodes)


def _with_axis(grid: Grid, frame: AxisFrame) -> Grid:
    """Return the grid with its outer patches on the axis renamed ``axis``."""
    patches = []
    for patch in grid.outer_patches():
        line = face_of(grid.blocks[patch.block].nodes, patch.side)[patch.start : patch.stop + 1]
        r = ((line - frame.point) * frame.away).sum(axis=1)
        on_axis = np.abs(r).max() <= frame.slack
        patches.append(replace(patch, name=AXIS, kind="other") if on_axis else patch)
    return replace(grid, patches=tuple(patches))


def bent(nodes: Sequence[Floats], turn: Revolution) -> list[Floats]:
    """Return volumes (ni, nj, nk, 3) bent about the axis of `turn`: z becomes an angle, 0 to `turn.degrees`.

    The lowest z of all `nodes` gets the angle 0. Raises InputError: nodes on both sides of the axis.
    """
    flat = np.concatenate([each[..., :2].reshape(-1, 2) for each in nodes])
    frame = frame_of(flat, turn.axis)
    low = min(float(each[..., 2].min()) for each in nodes)
    angle = math.radians(turn.degrees) / (max(float(each[..., 2].max()) for each in nodes) - low)
    return [as_planar(frame.places(each[..., :2], angle * (each[..., 2] - low))) for each in nodes]
