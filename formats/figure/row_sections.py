"""Sections of a blade row between its patches `hub` and `shroud`: at a span, and meridional.

At a span, the surface is unrolled to m' and theta times its mean radius, so that angles are true.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshonet.formats.figure.slices import Cut, cut_where
from meshonet.geometry.arrays import Floats, arc_lengths, cross2, norms
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.screw import screw_of
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.linear import symmetric_eigen

_POINTS = 200  # number of points of the curves of hub and shroud
_STEP = 8  # number of points of a curve between two of its first, coarse points
_NEWTON = 8
_BALANCED = 1e-6  # largest relative difference of moments of inertia about the two axes across a full ring
_ALONG = 1.0 - 1e-9  # smallest component, along a coordinate axis, of a direction that counts as parallel
_AT_ONCE = 1 << 13  # number of nodes that are looked up together


@dataclass(frozen=True, eq=False)
class RowSections:
    """Sections of the volume grid of a blade row.

    The axis of rotation is found from periodic sides or from a full ring; otherwise it is the x axis. Raises
    InputError if `grid` is no volume with patches `hub` and `shroud`.
    """

    grid: Grid

    def __post_init__(self) -> None:
        names = {patch.name for patch in self.grid.patches}
        if self.grid.form != "volume" or not {"hub", "shroud"} <= names:
            problem = "the grid is no blade row with patches hub and shroud"
            raise InputError(problem, "use {slice}")

    @cached_property
    def pitch(self) -> float:
        """Angle in radians between the periodic sides; 2 pi without periodic sides."""
        return self._axis[0]

    @cached_property
    def _axis(self) -> tuple[float, Floats, Floats]:
        """Pitch, a point of the axis and its direction."""
        motions = (each.transform for each in self.grid.connections if each.transform)
        screws = (screw_of(motion) for motion in motions)
        screw = next((each for each in screws if each.angle), None)
        if screw is None:
            return 2.0 * math.pi, *self._axis_of_ring()
        return abs(screw.angle), screw.centre, screw.axis

    @property
    def axis_name(self) -> str:
        """Name of the axis: ``x``, ``y`` or ``z`` if it is parallel to one of them, else ``axis``."""
        direction = np.abs(self._axis[2])
        k = int(direction.argmax())
        return "xyz"[k] if direction[k] > _ALONG else "axis"

    def _axis_of_ring(self) -> tuple[Floats, Floats]:
        """Return a point and the direction of a full ring's axis, by its inertia; else of the x axis."""
        parts = [self.grid.at(p).reshape(-1, 3) for p in self.grid.patches if p.name == "shroud"]
        points = np.concatenate(parts)
        centre = points.mean(axis=0)
        moments, axes = symmetric_eigen(product((points - centre).T, points - centre))
        gaps = np.diff(moments)
        if gaps.min() > _BALANCED * moments[-1]:  # part of a ring
            return np.zeros(3), np.array([1.0, 0.0, 0.0])
        axis = axes[:, 0 if gaps[0] > gaps[1] else 2]
        axis = axis * np.sign(axis[int(np.abs(axis).argmax())])
        return centre - (centre * axis).sum() * axis, axis

    @cached_property
    def places(self) -> list[Floats]:
        """Axial position, radius and angle (ni, nj, nk, 3) of the nodes, an array for each block."""
        return [self._cylindrical(block.nodes) for block in self.grid.blocks]

    def _cylindrical(self, nodes: Floats) -> Floats:
        _, centre, axis = self._axis
        up = np.eye(3)[2 if abs(axis[2]) < 0.9 else 1]
        up = up - (up * axis).sum() * axis
        up /= norms(up)
        off = nodes - centre
        x, a, b = ((off * way).sum(axis=-1) for way in (axis, up, np.cross(up, axis)))
        middle = np.arctan2(b.mean(), a.mean())  # a block does not reach around the axis
        c, s = np.cos(middle), np.sin(middle)
        theta = middle + np.arctan2(c * b - s * a, c * a + s * b)
        return np.stack([x, np.hypot(a, b), theta], axis=-1)

    @cached_property
    def _curves(self) -> tuple[Floats, Floats]:
        """Points (n, 2) of hub and shroud, from one end to the other, at equal parts of their lengths."""
        return self._curve("hub"), self._curve("shroud")

    def _curve(self, name: str) -> Floats:
        """Return hub or shroud: nodes ordered from the inlet, each the nearest to the one before."""
        cloud = self._nodes(name)
        size = float(np.ptp(cloud, axis=0).max())
        _, first = np.unique(np.round(cloud * (_POINTS / size)), axis=0, return_index=True)
        rest = cloud[first]
        inlet = self._nodes("inlet") if any(p.name == "inlet" for p in self.grid.patches) else rest[:1]
        here = rest[int(_nearest(rest, inlet).argmin())]
        ordered = []
        while len(rest):
            k = int(norms(rest - here).argmin())
            here = rest[k]
            ordered.append(here)
            rest = np.delete(rest, k, axis=0)
        line = np.array(ordered)
        arc = arc_lengths(line) / size
        at = np.linspace(0.0, arc[-1], _POINTS)
        return np.stack([np.interp(at, arc, line[:, k]) for k in (0, 1)], axis=1)

    def _nodes(self, name: str) -> Floats:
        """Return x and r (n, 2) of the nodes of a patch."""
        parts = [self._cylindrical(self.grid.at(p)) for p in self.grid.patches if p.name == name]
        return np.concatenate([part[..., :2].reshape(-1, 2) for part in parts])

    @cached_property
    def _spans(self) -> list[tuple[Floats, Floats]]:
        """For each block the parts of the ways from hub to shroud and from inlet to outlet."""
        sections = []
        for nodes in self.places:
            flat = nodes[..., :2].reshape(-1, 2)
            part, along = _ruled(flat, *self._curves)
            sections.append((part.reshape(nodes.shape[:-1]), along.reshape(nodes.shape[:-1])))
        return sections

    def at(self, span: float, values: list[Floats] | None) -> Cut:
        """Return the section at the fraction `span` of the distance from hub to shroud.

        `values` has the cell values of each block. Raises InputError if no cell is at this fraction.
        """
        hub, shroud = self._curves
        line = hub + span * (shroud - hub)
        steps = norms(np.diff(line, axis=0)) / (0.5 * (line[1:, 1] + line[:-1, 1]))
        m, mean = np.concatenate([[0.0], np.cumsum(steps)]), float(line[:, 1].mean())
        knots = np.linspace(0.0, 1.0, _POINTS)
        flat = [
            mean * np.stack([np.interp(along, knots, m), nodes[..., 2]], axis=-1)
            for nodes, (_, along) in zip(self.places, self._spans, strict=True)
        ]
        cuts = []
        for number, ((part, _), plane) in enumerate(zip(self._spans, flat, strict=True)):
            own = values[number] if values else None
            quads = _between_lines(part - span, plane, own)
            cuts.append(quads or cut_where([part - span], [plane], None if own is None else [own]))
        made = _together(cuts)
        if not len(made.polygons):
            raise InputError(f"no cell is at {span:g} of the span", "use 0 to 1", parameter="span")
        return made

    def meridional(self, values: list[Floats] | None) -> Cut:
        """Return the section by a half-plane through the axis and the blade, in axial position and radius."""
        blades = {patch.block for patch in self.grid.patches if patch.name == "blade"}
        theta = [nodes[..., 2] for nodes in self.places]
        middle = float(np.mean([theta[k].mean() for k in sorted(blades) or range(len(theta))]))
        low, high = min(each.min() for each in theta), max(each.max() for each in theta)
        first, last = ((end - middle) / self.pitch for end in (low, high))
        flat = [nodes[..., :2] for nodes in self.places]
        cuts = [
            cut_where([each - middle - k * self.pitch for each in theta], flat, values)
            for k in range(math.ceil(first), math.floor(last) + 1)
        ]
        return _together(cuts)


def _together(cuts: list[Cut]) -> Cut:
    shown = [each.values for each in cuts if each.values is not None]
    return Cut(np.concatenate([each.polygons for each in cuts]), np.concatenate(shown) if shown else None)


def _between_lines(distance: Floats, plane: Floats, values: Floats | None) -> Cut | None:
    """Return quadrilaterals between the points where lines along k cross a surface, if each does once.

    Polygons of cut cells would have another edge wherever the surface passes to the next layer of cells.
    """
    if distance[..., 0].mean() > distance[..., -1].mean():
        distance = -distance
    crossed = (distance[..., :-1] <= 0.0) & (distance[..., 1:] > 0.0)
    if not (crossed.sum(axis=-1) == 1).all():
        return None
    k = crossed.argmax(axis=-1)[..., None]
    low, high = (np.take_along_axis(distance, each, axis=-1) for each in (k, k + 1))
    below, above = (np.take_along_axis(plane, each[..., None], axis=2)[:, :, 0] for each in (k, k + 1))
    points = below + (low / (low - high)) * (above - below)
    corners = points[:-1, :-1], points[1:, :-1], points[1:, 1:], *9 * [points[:-1, 1:]]
    shown = None if values is None else np.take_along_axis(values, k[:-1, :-1], axis=2).ravel()
    return Cut(np.stack(corners, axis=2).reshape(-1, len(corners), 2), shown)


def _nearest(points: Floats, cloud: Floats) -> Floats:
    """Return the distances (n,) of points (n, 2) from the nearest of a cloud (m, 2)."""
    step = max(1, len(cloud) // _POINTS)
    return np.asarray(norms(points[:, None] - cloud[::step]).min(axis=1))


def _ruled(points: Floats, hub: Floats, shroud: Floats) -> tuple[Floats, Floats]:
    """Return, for points (n, 2), the parts of the way from hub to shroud (n,) and along them (n,)."""
    lines = np.concatenate([hub, shroud - hub], axis=1)
    slopes = (len(lines) - 1) * np.diff(lines, axis=0)
    rough = [curve[::_STEP] for curve in (hub, shroud)]
    across, along = np.empty(len(points)), np.empty(len(points))
    for first in range(0, len(points), _AT_ONCE):
        own = points[first : first + _AT_ONCE]
        near = [((own[:, None] - each) ** 2).sum(axis=-1).argmin(axis=1) for each in rough]
        t = 0.5 * (near[0] + near[1]) * _STEP / (len(lines) - 1)
        for _ in range(_NEWTON):
            k = np.clip((t * (len(lines) - 1)).astype(np.intp), 0, len(slopes) - 1)
            slope = slopes[k]
            here = lines[k] + (t - k / (len(lines) - 1))[:, None] * slope
            off, way = own - here[:, :2], here[:, 2:]
            change = cross2(off, slope[:, 2:]) - cross2(slope[:, :2], way)
            t = t - cross2(off, way) / change
        across[first : first + _AT_ONCE] = (off * way).sum(axis=1) / (way**2).sum(axis=1)
        along[first : first + _AT_ONCE] = t
    return across, along
