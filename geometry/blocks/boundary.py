"""The boundary of a block: four edges of nodes that share corners, and the curves they were sampled from.

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

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np

from meshonet.geometry.arrays import SIDES, TOPOLOGIES, Floats, Indices, Side, Topology, read_only
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connected, Connection, connections_of
from meshonet.geometry.blocks.grid import UNKNOWN, Grid, Origin
from meshonet.geometry.blocks.patches import Patch, check_patches, default_patches
from meshonet.geometry.blocks.validate import check_edges
from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import check_extent, polygon_area
from meshonet.geometry.polygon.corners import find_corners
from meshonet.geometry.spacing.sampling import Sampling

_CORNERS = (  # side and end, twice: where neighbouring sides meet
    ("south", 0, "west", 0),
    ("south", -1, "east", 0),
    ("north", 0, "west", -1),
    ("north", -1, "east", -1),
)


@dataclass(frozen=True, eq=False)
class Boundary(Connected):
    """The four sides of a block, with common corner nodes; values are checked on construction.

    Parameters
    ----------
    south, north : array
        (ni, 2) nodes along xi.
    west, east : array
        (nj, 2) nodes along eta.
    topology : {'quad', 'o', 'c'}, optional
        Kind of grid. The south side of a ``c`` boundary runs along the wake to the body, around the body, and
        back along the wake; the nodes of the two wake parts coincide.
    patches : tuple of Patch, optional
        Named parts of the sides; if empty, the patches of `default_patches`.
    name : str, optional
        Name of the shape in the input.
    wall : Curve, optional
        The curve on which the nodes of `south` lie. From it, neural operators know the shape between nodes.
    chord : float, optional
        Unit of spacings: the chord of an airfoil, or the largest extent of another body. If 0, it is the
        distance from the first node of the body to the farthest other node.
    sensors : array, optional
        Nodes (m, 2) that are the input of the branch networks of an operator (see `with_sensors`).
    notes : tuple of str, optional
        Sentences for users, for example that an outline was changed.
    origin : Origin, optional
        For a sample of a dataset: its parameters, and whether it is for training or for tests.
    sampled : bool, optional
        Whether meshonet has placed the nodes on curves, so that it may move them along these curves.

    Raises
    ------
    InputError
        A side of the wrong array shape, or with a node that is repeated or not finite; sides that do not
        meet; a left-handed outline; a ``c`` boundary without a wake.
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
    connections: tuple[Connection, ...] = field(default=(), init=False)

    def __post_init__(self) -> None:
        if self.topology not in TOPOLOGIES:
            raise InputError(f"topology {self.topology!r} is not known", "use " + "/".join(TOPOLOGIES))
        for side in SIDES:
            object.__setattr__(self, side, _edge(side, getattr(self, side)))
        for side, opposite in (("south", "north"), ("west", "east")):
            n, m = len(getattr(self, side)), len(getattr(self, opposite))
            if n != m:
                counts = f"{side} has {n} nodes and {opposite} has {m}"
                raise InputError(counts, "opposite edges need equal counts")
        self._check_corners()
        object.__setattr__(self, "connections", connections_of(self.topology, self.south, self.nj))
        if not self.chord:
            body = self.south[self.wake : self.ni - self.wake]
            farthest = np.hypot(*(body - body[0]).T).max()
            object.__setattr__(self, "chord", float(farthest))
        patches = tuple(self.patches) or default_patches(self.topology, self.ni, self.nj, self.wake)
        object.__setattr__(self, "patches", patches)
        check_patches(self.patches, [(self.ni, self.nj)])
        self._check_orientation()

    @property
    def ni(self) -> int:
        """Number of nodes along xi."""
        return len(self.south)

    @property
    def nj(self) -> int:
        """Number of nodes along eta."""
        return len(self.west)

    @cached_property
    def corners(self) -> Mapping[str, Indices]:
        """For each side, the indices of its corners other than its two ends (see `polygon.corners`)."""
        return {side: read_only(find_corners(getattr(self, side))) for side in SIDES}

    def grid(
        self, nodes: Floats, provenance: Mapping[str, Any] | None = None, *, finite: bool = False
    ) -> Grid:
        """Return the grid with `nodes` (ni, nj, 2), and with the patches and connections of this boundary.

        With `finite`, the nodes are known to be finite and are not checked.
        """
        block = Block(nodes, finite)
        return Grid((block,), self.patches, self.connections, self.name, provenance or {})

    def outline(self) -> Floats:
        """Return the closed outline (n, 2): south, east, north, west; the first node is not repeated."""
        return np.concatenate([self.south[:-1], self.east[:-1], self.north[:0:-1], self.west[:0:-1]])

    def with_sensors(self, count: int) -> Self:
        """Return the boundary with `count` sensors, which are nodes with equally spaced indices.

        In a quad boundary the sensors start at the south-west corner and follow the boundary
        counter-clockwise. In an O grid, half of them (rounded up) are on the body and the others on the far
        field. Sensors have fixed computational coordinates, as neural operators need them: Xiao et al., arXiv
        2501.11937, section III.

        Raises InputError: fewer than 2 sensors, or more than there are nodes.
        """
        rings = [self.south[:-1], self.north[:-1]] if self.around_body else [self.outline()]
        most = len(rings) * len(rings[0])
        if not 2 <= count <= most:
            raise InputError(f"{count} sensors", f"use 2 to {most}, the number of boundary nodes")
        shares = [count] if len(rings) == 1 else [count - count // 2, count // 2]
        chosen = [ring[np.arange(n) * len(ring) // n] for ring, n in zip(rings, shares, strict=True)]
        return replace(self, sensors=np.concatenate(chosen))

    def boundary(self, sampling: Sampling) -> Self:
        """Return this boundary resampled to the node counts of `sampling`; corners stay nodes.

        Raises InputError: `sampling` sets anything else, such as another topology, a spacing or a far field.
        """
        self._check_sampling(sampling)
        ni, nj = sampling.ni or self.ni, sampling.nj or self.nj
        if (ni, nj) == (self.ni, self.nj):
            return self
        from meshonet.geometry.blocks.resample import resample_edges, resample_patches

        sides: dict[Side, Floats] = {side: getattr(self, side) for side in SIDES}
        edges: Any = resample_edges(sides, ni, nj, closed=self.periodic, wake=self.wake)
        patches = resample_patches(self.patches, (self.ni, self.nj), (ni, nj), self.wake)
        return replace(self, **edges, patches=patches, sensors=None, sampled=not self.wake or self.sampled)

    def _check_sampling(self, sampling: Sampling) -> None:
        """Raise InputError if `sampling` sets what the given edges determine."""
        if sampling.topology not in ("auto", self.topology):
            raise InputError(
                f"edges of topology {self.topology} do not make topology {sampling.topology}",
                "leave {topology} out, or give the shape instead of its edges",
                source=self.name,
            )
        thin = sampling.viscous and sampling.spacing == "curvature"  # thin cells imply that law
        law = "curvature" if thin else "auto"
        settled = Sampling(sampling.ni, sampling.nj, sampling.topology, law, viscous=sampling.viscous)
        for name, value in vars(settled).items():
            if getattr(sampling, name) != value:
                raise InputError(
                    f"{{{name}}} says how a shape becomes edges, and these are edges already",
                    f"leave {{{name}}} out, or give the shape",
                    source=self.name,
                )

    def _check_corners(self) -> None:
        for side, k, neighbour, m in _CORNERS:
            p, q = getattr(self, side)[k], getattr(self, neighbour)[m]
            if p[0] != q[0] or p[1] != q[1]:
                raise InputError(
                    f"{side} ends at ({p[0]:.6g}, {p[1]:.6g}) and {neighbour} at ({q[0]:.6g}, {q[1]:.6g})",
                    "neighbouring edges must share their corner",
                )
        if self.periodic:
            for side in ("south", "north"):
                edge = getattr(self, side)
                if not np.array_equal(edge[0], edge[-1]):
                    raise InputError(f"{side} of an O grid is not closed", "repeat its first node at the end")

    def _check_orientation(self) -> None:
        with np.errstate(over="ignore", invalid="ignore"):  # `_check_outline` reports it
            if not self.periodic:
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
        """Raise InputError if the sign of the area has no meaning: extent out of range, edges that cross."""
        check_extent(float(np.hypot(*np.ptp(self.outline(), axis=0))))
        check_edges(self)


def _edge(side: str, points: Floats) -> Floats:
    edge = np.ascontiguousarray(points, dtype=np.float64)
    if edge.ndim != 2 or edge.shape[1] != 2 or len(edge) < 2:
        raise InputError(f"{side} has shape {edge.shape}", "give (n, 2) with n at least 2")
    with np.errstate(invalid="ignore", over="ignore"):  # infinity minus infinity
        steps = np.abs(edge[1:] - edge[:-1]).sum(axis=1)
    if steps.min() > 0 and steps.max() < np.inf:  # neither holds if a node is NaN
        return edge
    bad = np.flatnonzero(~np.isfinite(edge).all(axis=1))
    if bad.size:
        raise InputError(f"{side} node {bad[0]} is not finite", "check the input for NaN or infinity")
    same = np.flatnonzero((np.diff(edge, axis=0) == 0).all(axis=1))
    if same.size:
        x, y = edge[same[0]]
        nodes = f"{side} nodes {same[0]} and {same[0] + 1}"
        raise InputError(f"{nodes} are the same point ({x:.6g}, {y:.6g})", "remove one")
    return edge
