"""A boundary: four edges of nodes that meet, and the curves they were sampled from.

::

                north (ni nodes)
            d ----->------ c        south and north run along xi, west and east along eta;
            |              |        the four corners a, b, c, d are shared bitwise.
       west ^              ^ east   o: south is the body, north the far field, both closed;
            |              |           west equals east and is only the starting cut.
            |              |        c: south is wake, body, wake; the two wakes coincide bitwise.
            a ----->------ b
                south (ni nodes)
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from meshonet.geometry.arrays import SIDES, TOPOLOGIES, Floats, Topology
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.metadata import UNKNOWN, Origin
from meshonet.geometry.blocks.patches import Patch, check_patches, known_patches, wake_nodes
from meshonet.geometry.curves.curve import Curve, resample_like
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import Indices, find_corners
from meshonet.geometry.spacing.sampling import Sampling


@dataclass(frozen=True, eq=False)
class Boundary:
    """Four edges of nodes; validates itself.

    Parameters
    ----------
    south, north : (ni, 2) nodes along xi.
    west, east : (nj, 2) nodes along eta.
    topology : ``quad``, ``o`` or ``c``.
    patches : named stretches of the sides; empty means the defaults.
    name : what the input called this shape.
    wall : the curve that `south` was sampled from, when there is one. It lets the operator see the
        body between the nodes.
    chord : the length that spacings are given in: the chord of an airfoil, the largest extent of another
        body. 0 stands for the distance of the first node of `south`, a wake left out, from the one farthest
        from it.
    sensors : (m, 2) nodes that an operator's branches read (`with_sensors`), when asked for.
    notes : sentences a user should read, such as that an outline was changed.
    origin : the numbers that made it and what it is kept for, of a sample of a dataset.
    sampled : whether the nodes were chosen here, on curves, and may be chosen otherwise.

    Raises
    ------
    InputError
        an edge of the wrong shape, with a node that is not finite or repeated, edges that do not
        meet, a left-handed outline.
    """

    south: Floats
    north: Floats
    west: Floats
    east: Floats
    topology: Topology = "quad"
    patches: tuple[Patch, ...] = ()
    name: str = ""
    wall: Curve | None = None
    chord: float = 0.0
    sensors: Floats | None = None
    notes: tuple[str, ...] = ()
    origin: Origin = UNKNOWN
    sampled: bool = False

    def __post_init__(self) -> None:
        if self.topology not in TOPOLOGIES:
            raise InputError(f"topology {self.topology!r} is not known", "use " + "/".join(TOPOLOGIES))
        for side in SIDES:
            object.__setattr__(self, side, _edge(side, getattr(self, side)))
        for one, other in (("south", "north"), ("west", "east")):
            n, m = len(getattr(self, one)), len(getattr(self, other))
            if n != m:
                raise InputError(
                    f"{one} has {n} nodes and {other} has {m}", "opposite edges need equal counts"
                )
        if not self.chord:
            behind = max(wake_nodes(self.south) - 1, 0) if self.topology == "c" else 0
            body = self.south[behind : self.ni - behind]
            farthest = np.hypot(*(body - body[0]).T).max()
            object.__setattr__(self, "chord", float(farthest))
        self._check_corners()
        object.__setattr__(
            self, "patches", tuple(self.patches) or known_patches(self.topology, self.south, self.nj)
        )
        check_patches(self.patches, self.ni, self.nj)
        self._check_orientation()

    @property
    def ni(self) -> int:
        """Nodes along xi."""
        return len(self.south)

    @property
    def nj(self) -> int:
        """Nodes along eta."""
        return len(self.west)

    @cached_property
    def corners(self) -> Mapping[str, Indices]:
        """Indices of the corners of each edge, its ends left out (`meshonet.geometry.polygon.corners`)."""
        return {side: find_corners(getattr(self, side)) for side in SIDES}

    def grid(
        self, nodes: Floats, provenance: Mapping[str, Any] | None = None, *, finite: bool = False
    ) -> Grid:
        """Return the grid of `nodes` (ni, nj, 2) inside this boundary."""
        return Grid.from_nodes(nodes, self.topology, self.patches, self.name, provenance or {}, finite=finite)

    def outline(self) -> Floats:
        """Return the closed outline (n, 2) south, east, north, west, first node not repeated."""
        return np.concatenate([self.south[:-1], self.east[:-1], self.north[:0:-1], self.west[:0:-1]])

    def with_sensors(self, count: int) -> Boundary:
        """Return the boundary with `count` sensors: nodes at equal steps of their number.

        Around a quad they start at the south-west corner and run counter-clockwise; of an O, the first half
        (the odd one included) is on the body and the rest on the far field. Fixed places of the computational
        domain, as an operator needs them: Xiao et al., arXiv 2501.11937, section III.

        Raises
        ------
        InputError
            fewer than 2 sensors, or more than there are nodes.
        """
        rings = [self.outline()] if self.topology == "quad" else [self.south[:-1], self.north[:-1]]
        most = len(rings) * len(rings[0])
        if not 2 <= count <= most:
            raise InputError(f"{count} sensors", f"use 2 to {most}, the number of boundary nodes")
        shares = [count] if len(rings) == 1 else [count - count // 2, count // 2]
        chosen = [ring[np.arange(n) * len(ring) // n] for ring, n in zip(rings, shares, strict=True)]
        return replace(self, sensors=np.concatenate(chosen))

    def boundary(self, sampling: Sampling) -> Boundary:
        """Return this boundary with the node counts of `sampling`.

        Given nodes are used as they are when the counts are absent or equal; others resample the
        curves through the nodes, corners kept.

        Raises
        ------
        InputError
            `sampling` asks for anything else: another topology, a spacing, a far field ...
        """
        self._check_asked(sampling)
        ni, nj = sampling.ni or self.ni, sampling.nj or self.nj
        if (ni, nj) == (self.ni, self.nj):
            return self
        if self.topology == "c":
            from meshonet.geometry.shapes.wake import resampled

            return resampled(self, ni, nj)
        periodic = self.topology == "o"
        if periodic and ni < 4:
            raise InputError(f"{ni} nodes around a body", "use at least 4")
        edges: dict[str, Any] = {
            side: resample_like(getattr(self, side), n, closed=periodic and side in ("south", "north"))
            for side, n in (("south", ni), ("north", ni), ("west", nj), ("east", nj))
        }
        parts = tuple(_rescaled(part, self, ni, nj) for part in self.patches)
        return replace(self, **edges, patches=parts, sensors=None, sampled=True)

    def _check_asked(self, sampling: Sampling) -> None:
        """Raise InputError when `sampling` asks for what given edges do not leave open."""
        if sampling.topology not in ("auto", self.topology):
            raise InputError(
                f"edges of topology {self.topology} do not make topology {sampling.topology}",
                "leave --topology out, or give the shape instead of its edges",
                source=self.name,
            )
        implied = "curvature" if sampling.viscous else "auto"  # thin cells ask for that law by themselves
        asked = {
            "--spacing": sampling.spacing not in ("auto", implied),
            "--le-spacing": sampling.le_spacing is not None,
            "--te-spacing": sampling.te_spacing is not None,
            "--far-field": sampling.far_field is not None,
            "--corners": sampling.corners is not None,
            "--te": sampling.te != "auto",
            "--wake": sampling.wake is not None,
            "--wake-nodes": sampling.wake_nodes is not None,
            "--normalise": sampling.normalise,
        }
        for option, given in asked.items():
            if given:
                raise InputError(
                    f"{option} says how a shape becomes edges, and these are edges already",
                    f"leave {option} out, or give the shape",
                    source=self.name,
                )

    def _check_corners(self) -> None:
        corners = (
            ("south", 0, "west", 0),
            ("south", -1, "east", 0),
            ("north", 0, "west", -1),
            ("north", -1, "east", -1),
        )
        for one, k, other, m in corners:
            p, q = getattr(self, one)[k], getattr(self, other)[m]
            if p[0] != q[0] or p[1] != q[1]:
                raise InputError(
                    f"{one} ends at ({p[0]:.6g}, {p[1]:.6g}) and {other} at ({q[0]:.6g}, {q[1]:.6g})",
                    "neighbouring edges must share their corner",
                )
        if self.topology == "o":
            for side in ("south", "north"):
                edge = getattr(self, side)
                if not np.array_equal(edge[0], edge[-1]):
                    raise InputError(f"{side} of an O grid is not closed", "repeat its first node at the end")

    def _check_orientation(self) -> None:
        with np.errstate(over="ignore", invalid="ignore"):  # told of in `_check_outline`
            if self.topology != "o":
                if not 0.0 < polygon_area(self.outline()) < np.inf:
                    self._check_outline()
                    raise InputError(
                        "the outline south, east, north, west runs clockwise or has no area",
                        "swap south and north or reverse the edges",
                    )
                return
            inner, outer = polygon_area(self.south[:-1]), polygon_area(self.north[:-1])
        if not (-np.inf < inner < 0 and -np.inf < outer < 0):
            self._check_outline()
            raise InputError("an O grid's edges must run clockwise", "reverse south and north")
        if abs(inner) >= abs(outer):
            self._check_outline()
            raise InputError("the far field does not enclose the body", "use a larger far field")

    def _check_outline(self) -> None:
        """Raise InputError for what makes the sign of an area say nothing: its size, edges that cross."""
        from meshonet.geometry.blocks.validate import check_edges  # which looks at boundaries
        from meshonet.geometry.shapes.airfoil.clean import check_extent

        check_extent(float(np.hypot(*np.ptp(self.outline(), axis=0))))
        check_edges(self)


def polygon_area(points: Floats) -> float:
    """Return the signed area of a closed polygon (n, 2), positive when counter-clockwise.

    Examples
    --------
    >>> polygon_area(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]))
    2.0
    """
    x, y = (points - points[0]).T
    return float(0.5 * (x[:-1] @ y[1:] - x[1:] @ y[:-1]))  # the first point, now 0, closes it with nothing


def _edge(side: str, points: Floats) -> Floats:
    edge = np.ascontiguousarray(points, dtype=np.float64)
    if edge.ndim != 2 or edge.shape[1] != 2 or len(edge) < 2:
        raise InputError(f"{side} has shape {edge.shape}", "give (n, 2) with n at least 2")
    with np.errstate(invalid="ignore", over="ignore"):  # infinity less infinity
        steps = np.abs(edge[1:] - edge[:-1]).sum(axis=1)
    if steps.min() > 0 and steps.max() < np.inf:  # neither is so with a node that is not a number
        return edge
    bad = np.flatnonzero(~np.isfinite(edge).all(axis=1))
    if bad.size:
        raise InputError(f"{side} node {bad[0]} is not finite", "check the input for NaN or infinity")
    same = np.flatnonzero((np.diff(edge, axis=0) == 0).all(axis=1))
    if same.size:
        x, y = edge[same[0]]
        raise InputError(
            f"{side} nodes {same[0]} and {same[0] + 1} are the same point ({x:.6g}, {y:.6g})", "remove one"
        )
    return edge


def _rescaled(part: Patch, old: Boundary, ni: int, nj: int) -> Patch:
    had, has = (old.ni, ni) if part.side in ("south", "north") else (old.nj, nj)
    scale = (has - 1) / (had - 1)
    start = min(round(part.start * scale), has - 2)
    return replace(part, start=start, stop=max(round(part.stop * scale), start + 1))
