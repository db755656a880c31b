"""Sweeps a planar grid along a curve in space.

Planes of nodes are normal to the path, with axes in frames that do not rotate about it. k runs along the
path.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats, norms
from meshonet.geometry.blocks.extrude import thickened
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.patches import Patch
from meshonet.geometry.curves.frames import STEPS, frames_along, turned
from meshonet.geometry.curves.path import Path
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.reach import check_reach

TURN_DEG = 4.0  # largest turning angle of the path within a cell, unless the number of planes is given
_LONG = 3.0  # mean edges of the section's cells that a cell is long along the path, at the most
_LOOKED_AT = 1025  # places along the path where it is asked how much it bends
_UNNAMED = (*SIDES, "outer")


@dataclass(frozen=True)
class Sweep:
    """Options for sweeping a section along a path.

    Parameters
    ----------
    planes : int, optional
        Number of planes of nodes. By default, cells turn by at most 4 degrees, and are at most three mean
        cell widths long.
    up : tuple of 3 float, optional
        Direction of the section's y axis at the start, as closely as possible; by default z, or y for a path
        along z.
    twist : float, optional
        Additional rotation of the section from start to end, in degrees.
    scale : float, optional
        Size of the section at the end relative to its size at the start.

    Raises
    ------
    InputError
        If a value is out of its range.
    """

    planes: int | None = None
    up: tuple[float, float, float] | None = None
    twist: float = 0.0
    scale: float = 1.0

    def __post_init__(self) -> None:
        if self.planes is not None and not 2 <= self.planes <= 1_000_000:
            raise InputError(f"{self.planes} planes", "use 2 to 1000000", parameter="planes")
        if not 1e-6 < self.scale < 1e6:
            raise InputError(f"{self.scale:g}", "use a number above 0", parameter="scale")
        if not abs(self.twist) < 1e6:
            raise InputError(f"{self.twist:g} degrees", "use fewer", parameter="twist")


def sweep(section: Grid, path: Path, settings: Sweep | None = None) -> Grid:
    """Return the volume grid of a planar section swept along a path.

    The first plane is the patch ``inlet``, the last ``outlet``; a closed path has neither. Outer patches
    without a name are called ``wall``, and outer patches without a kind are walls.

    Raises InputError as `frames_along`, and if the section is not planar or is periodic, if a bend is too
    tight for the section, or if the path needs too many planes.
    """
    settings = settings or Sweep()
    check_planes(section, settings.planes)
    section = walled(section)
    if path.closed and (settings.scale != 1.0 or settings.twist % 360.0):
        problem = "the path is closed and the section does not come back to itself"
        raise InputError(problem, "leave {scale} out, and give whole turns of {twist}")
    s = np.linspace(0.0, path.length, settings.planes or _planes(section, path))
    looked = np.linspace(0.0, path.length, max(_LOOKED_AT, len(s)))
    outline = np.concatenate([section.face(p.block, p.side)[p.start : p.stop + 1] for p in section.patches])
    _check_bends(outline, path, looked, _axes(path, looked, settings, 1), settings)
    size = _sizes(path, s, settings)[:, None]
    x, y = (size * axis for axis in _axes(path, s, settings))
    points = path.at(s).points
    if path.closed:
        for each in (x, y, points):
            each[-1] = each[0]
    nodes = [_carried(block.nodes, points, x, y) for block in section.blocks]
    return thickened(section, nodes, None if path.closed else (("inlet", "inlet"), ("outlet", "outlet")))


def check_planes(section: Grid, planes: int | None) -> None:
    """Raise InputError if a section swept in this number of `planes` has too many cells."""
    if planes is not None:
        check_reach(
            section.cells * (planes - 1.0),
            "cells",
            f"a section in {planes} planes",
            "give fewer",
            parameter="planes",
        )


def _carried(plane: Floats, points: Floats, x: Floats, y: Floats) -> Floats:
    """Return nodes (ni, nj, nk, 3) of a plane (ni, nj, 2) at points (nk, 3) with these axes."""
    ni, nj = plane.shape[:2]
    nodes = np.empty((3, ni, nj, len(points)))
    for d in range(3):
        np.multiply(plane[..., 0, None], x[:, d], out=nodes[d])
        nodes[d] += plane[..., 1, None] * y[:, d]
        nodes[d] += points[:, d]
    return np.moveaxis(nodes, 0, -1)


def _axes(path: Path, s: Floats, settings: Sweep, steps: int = STEPS) -> tuple[Floats, Floats]:
    """Return x and y axes (n, 3) of the twisted section at arc lengths."""
    up = None if settings.up is None else np.array(settings.up, dtype=np.float64)
    x, y = frames_along(path, s, up, steps=steps)
    if settings.twist:
        tangents = path.at(s).tangents
        y = turned(y, tangents, math.radians(settings.twist) * s / path.length)
        x = np.cross(y, tangents)
    return x, y


def _sizes(path: Path, s: Floats, settings: Sweep) -> Floats:
    return np.asarray(1.0 + (settings.scale - 1.0) * s / path.length)


def _planes(section: Grid, path: Path) -> int:
    places = path.at(np.linspace(0.0, path.length, _LOOKED_AT))
    bend = float(norms(places.curvature).max())
    area = cells = 0.0
    for block in section.blocks:
        x, y = block.nodes[..., 0], block.nodes[..., 1]
        u, v = x[1:, 1:] - x[:-1, :-1], y[1:, 1:] - y[:-1, :-1]
        area += 0.5 * float(np.abs(u * (y[:-1, 1:] - y[1:, :-1]) - v * (x[:-1, 1:] - x[1:, :-1])).sum())
        cells += u.size
    step = _LONG * math.sqrt(area / cells)
    step = min(step, math.radians(TURN_DEG) / bend) if bend else step
    check_reach(
        path.length / step * cells, "cells", f"a path of length {path.length:.4g} that bends with a radius "
        f"of {1.0 / bend if bend else math.inf:.3g}", "smooth the path, or give {planes}",
    )  # fmt: skip
    return max(2, math.ceil(path.length / step - 1e-9) + 1)


def _check_bends(
    outline: Floats, path: Path, s: Floats, axes: tuple[Floats, Floats], settings: Sweep
) -> None:
    """Raise InputError if the section reaches beyond the centre of curvature of the path."""
    points, _, curvature = path.at(s)
    size = _sizes(path, s, settings)
    inwards = np.stack([(curvature * axis).sum(axis=1) for axis in axes], axis=1) * size[:, None]
    worst = np.array([float(product(outline, way).max()) for way in inwards])
    k = int(np.argmax(worst))
    if worst[k] < 1.0:
        return
    radius = 1.0 / float(norms(curvature[k]))
    x, y, z = points[k]
    raise InputError(
        f"the path bends with a radius of {radius:.4g} at ({x:.4g}, {y:.4g}, {z:.4g}), "
        f"{s[k]:.4g} from its start, where the section reaches {worst[k] * radius:.4g} to the inside",
        "use a wider bend or a smaller section",
    )


def walled(section: Grid) -> Grid:
    """Return `section`; patches without a kind and those on a body become walls. InputError if periodic."""
    if any(connection.transform for connection in section.connections):
        raise InputError("the section is periodic", "leave its periodic connections out")
    patches: list[Patch] = []
    for patch in section.outer_patches():
        if patch.kind == "other" or (patch.side == "south" and section.around_body):
            name = "wall" if patch.name in _UNNAMED else patch.name
            patch = replace(patch, name=name, kind="wall")
        patches.append(patch)
    return replace(section, patches=tuple(patches))


def self_crossing(path: Path, reach: float) -> tuple[float, float, float] | None:
    """Return a point where a section of extent `reach`, moved along a path, meets itself, or None.

    It meets itself where two points of the path are closer than twice `reach`, but farther apart along the
    path than half a circle of the radius `reach`.
    """
    count = int(min(1500, max(64, 4 * path.length / max(reach, 1e-300))))
    s = np.linspace(0.0, path.length, count)
    points = path.at(s).points
    apart = np.abs(s[:, None] - s[None, :])
    if path.closed:
        apart = np.minimum(apart, path.length - apart)
    near = norms(points[:, None] - points[None, :]) < 2.0 * reach
    both = np.argwhere(near & (apart > math.pi * reach + 2.0 * path.length / count))
    if len(both) == 0:
        return None
    x, y, z = 0.5 * (points[both[0, 0]] + points[both[0, 1]])
    return float(x), float(y), float(z)


def reach_of(section: Grid) -> float:
    """Return the largest distance of the nodes of a section from its origin."""
    corners: Sequence[Floats] = [block.nodes.reshape(-1, 2) for block in section.blocks]
    return max(float(np.hypot(*each.T).max()) for each in corners)
