"""Painting of surfaces in space, from back to front: shaded quadrilaterals and block outlines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from meshonet.formats.figure.layers import INK, Colouring, reduced
from meshonet.formats.figure.slices import CellSheet
from meshonet.geometry.arrays import Bools, Floats, extent_of, norms, ring_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes


_GAP = 5.0  # approximate distance between drawn lines in pixels
_LIGHT = np.array([-0.36, 0.48, 0.8])  # direction towards the light: right, up, towards the viewer
_FORWARD = 0.004  # shift of outlines towards the viewer, relative to the size of the picture


def steps_of(sheet: CellSheet, axes: Floats, pixels: float, every: int | None) -> tuple[int, int]:
    """Return how many cells, along each direction of the surface `sheet`, are drawn as one quadrilateral."""
    if every:
        return every, every
    flat = sheet.nodes @ axes[:2].T * pixels
    steps = []
    for axis in (0, 1):
        length = norms(np.diff(flat, axis=axis))
        typical = float(np.sqrt((length**2).mean()))
        steps.append(int(min(max(1, np.ceil(_GAP / max(typical, 1e-12))), length.shape[axis])))
    return steps[0], steps[1]


@dataclass(frozen=True, eq=False)
class Painted:
    """Projected quadrilaterals (n, 4, 2) with colours (n, 4), outlines (m, 2, 2), and the depths of both."""

    quads: Floats
    depth: Floats
    colours: Floats
    outline: Floats
    outline_depth: Floats


def painted(
    sheet: CellSheet, mask: Bools, steps: tuple[int, int], axes: Floats, colouring: Colouring | None,
    limits: tuple[float, float],
) -> Painted:  # fmt: skip
    """Return the cells in `mask` (n-1, m-1), merged by `steps` in each direction, projected onto `axes`."""
    import matplotlib as mpl

    marks = [
        np.append(np.arange(0, count - 1, step), count - 1)
        for count, step in zip(sheet.nodes.shape[:2], steps, strict=True)
    ]
    nodes = sheet.nodes[np.ix_(*marks)]
    keep = reduced(np.logical_or, mask, *marks)
    ring = np.moveaxis(ring_of(nodes), 0, 2)[keep]
    normal = np.cross(ring[:, 2] - ring[:, 0], ring[:, 3] - ring[:, 1])
    normal /= np.maximum(norms(normal), 1e-300)[:, None]
    facing = normal @ axes.T
    light = 0.7 + 0.3 * np.abs(facing @ _LIGHT)
    if colouring and sheet.values is not None:
        values = reduced(colouring.worst, sheet.values, *marks)[keep]
        colours = mpl.colormaps[colouring.scale](
            np.clip((values - limits[0]) / (limits[1] - limits[0]), 0.0, 1.0)
        )
    else:
        colours = np.tile([0.88, 0.9, 0.92, 1.0], (len(ring), 1))
    colours[:, :3] *= np.minimum(light, 1.0)[:, None]
    flat = ring @ axes.T
    border = [sheet.nodes[0], sheet.nodes[-1], sheet.nodes[:, 0], sheet.nodes[:, -1]]
    beside = [mask[0], mask[-1], mask[:, 0], mask[:, -1]]
    edges = [np.stack([line[:-1], line[1:]], axis=1)[own] for line, own in zip(border, beside, strict=True)]
    outline = np.concatenate(edges) @ axes.T
    hidden = sheet.outside * facing[:, 2] < 0.0  # behind a wall whose thickness may be less than their extent
    depth = flat[..., 2].mean(axis=1) - np.where(hidden, np.ptp(flat[..., 2], axis=1), 0.0)
    return Painted(flat[..., :2], depth, colours, outline[..., :2], outline[..., 2].mean(axis=1))


def paint(ax: Axes, painted: Sequence[Painted]) -> None:
    """Draw quadrilaterals and block outlines from back to front."""
    from matplotlib.collections import PolyCollection

    quads, colours, depth, outline, front = (
        np.concatenate([getattr(part, name) for part in painted])
        for name in ("quads", "colours", "depth", "outline", "outline_depth")
    )
    lines = outline[:, [0, 1, 1, 0]]
    size = extent_of(quads.reshape(-1, 2)) or 1.0
    order = np.argsort(np.concatenate([depth, front + _FORWARD * size]), kind="stable")
    faint, strong = faint_ink(0.45), faint_ink(1.0)
    widths = np.concatenate([np.full(len(quads), 0.25), np.full(len(lines), 0.9)])
    rims = np.concatenate([np.tile(faint, (len(quads), 1)), np.tile(strong, (len(lines), 1))])
    faces = np.concatenate([colours, np.zeros((len(lines), 4))])
    ax.add_collection(
        PolyCollection(
            list(np.concatenate([quads, lines])[order]), facecolors=faces[order], edgecolors=rims[order],
            linewidths=widths[order], rasterized=True, zorder=1,
        )
    )  # fmt: skip


def faint_ink(alpha: float) -> tuple[float, ...]:
    """Return the RGBA colour of lines with the opacity `alpha`, from 0 to 1."""
    return (*(int(INK[k : k + 2], 16) / 255 for k in (1, 3, 5)), alpha)
