"""Domains given by separate sides: four edges that meet, or the two walls of a channel."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from meshonet.geometry.arrays import SIDES, Floats, extent_of
from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.patches import may_be_wall
from meshonet.geometry.domain.loop import turns_sharply
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import turning
from meshonet.geometry.polygon.self_intersection import check_outline
from meshonet.geometry.shapes.domain_shape import DomainShape, itself
from meshonet.geometry.shapes.named_edges import Labelled, runs
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.shapes.polygon_shape import PolygonRing, polygon_shape

_JOIN = 1e-6  # largest distance between the ends of two edges that meet, divided by the extent
_PARTS = 16  # number of straight pieces per interval of a curve that are searched for names
_STRAIGHT = 0.5  # a curve is a wall, not a closed outline, if its ends are this part of its length apart


class DrawnEdge(NamedTuple):
    """A side of a domain: points (n, 2), the place of each in the file (as ``line 3``), and a name or ""."""

    points: Floats
    places: Sequence[str]
    name: str = ""

    def reversed(self) -> "DrawnEdge":
        """Return the side with its points in reverse order."""
        return DrawnEdge(self.points[::-1], self.places[::-1], self.name)

    @property
    def is_wall(self) -> bool:
        """Whether the ends are more than half the curve's length apart, as those of a channel's wall are."""
        length = float(np.hypot(*np.diff(self.points, axis=0).T).sum())
        return float(np.hypot(*(self.points[-1] - self.points[0]))) > _STRAIGHT * length


def channel(walls: Sequence[DrawnEdge], name: str, notes: tuple[str, ...] = ()) -> DomainShape | Outline:
    """Return the domain between two walls, whose ends are joined by straight lines; the first wall is south.

    Walls are called ``wall`` by default and have the kind ``wall`` unless their name implies another. The
    line between the first points is ``inlet``, the line between the last points ``outlet``. Raises
    InputError: walls that cross; a point that repeats its neighbour.
    """
    south, north = (_checked(wall)._replace(name=wall.name or "wall") for wall in walls)
    a, b, c, d = south.points[0], south.points[-1], north.points[0], north.points[-1]
    if np.hypot(*(a - d)) + np.hypot(*(b - c)) < np.hypot(*(a - c)) + np.hypot(*(b - d)):
        north = north.reversed()
    ends = [DrawnEdge(np.stack([p.points[k], q.points[k]]), [p.places[k], q.places[k]], called)
            for p, q, k, called in ((south, north, -1, "outlet"), (north, south, 0, "inlet"))]  # fmt: skip
    names = tuple(filter(may_be_wall, (south.name, north.name)))
    return _sampled([south, ends[0], north.reversed(), ends[1]], name, notes, walls=names)


def four_edges(
    edges: Sequence[DrawnEdge], name: str, notes: tuple[str, ...] = ()
) -> Boundary | DomainShape | Outline:
    """Return the domain of four edges, joined end to end from the first edge, which is south.

    If opposite edges have equal numbers of points, at least three, the points become nodes. Raises
    InputError: edges that do not meet, or that cross; a point that repeats its neighbour.
    """
    chain = _directed(_chained([_checked(edge) for edge in edges]))
    counts = [len(edge.points) for edge in chain]
    if counts[0] != counts[2] or counts[1] != counts[3] or min(counts) == 2:  # ends alone are no nodes
        return _sampled(chain, name, notes)
    sides = [chain[0], chain[1], chain[2].reversed(), chain[3].reversed()]
    south, east, north, west = (edge.points for edge in sides)
    named = zip(SIDES, sides, strict=True) if any(edge.name for edge in sides) else ()
    patches = tuple(run for side, edge in named for run in runs(side, [edge.name] * (len(edge.points) - 1)))
    return Boundary(south, north, west, east, patches=patches, name=name, notes=notes)


def _sampled(
    chain: Sequence[DrawnEdge], name: str, notes: tuple[str, ...], walls: Sequence[str] = ()
) -> DomainShape | Outline:
    """Return the domain of a closed chain of four edges, to be sampled."""
    chain = _directed(chain)
    ring = np.concatenate([edge.points[:-1] for edge in chain])
    places = [place for edge in chain for place in edge.places[:-1]]
    counts = [len(edge.points) - 1 for edge in chain]
    a, b, c = np.cumsum(counts[:3]).tolist()
    outline = Outline(ring, name, (0, a, b, c), places)
    outline.notes = notes
    if not any(edge.name for edge in chain):
        return outline
    fine = outline.curve.polyline(np.linspace(0.0, 1.0, _PARTS, endpoint=False))
    names = [edge.name or "outer" for edge in chain]
    cells = [called for called, count in zip(names, counts, strict=True) for _ in range(_PARTS * count)]
    labelled = Labelled(outline, np.stack([fine, np.roll(fine, -1, axis=0)], axis=1), cells, walls)
    # blocks follow the points: where these turn sharply within an edge there is a corner, too
    sharp = np.flatnonzero(turns_sharply(turning(ring, closed=True))).tolist()
    corners = sorted({0, a, b, c, *sharp})
    owners = [names[sum(start <= k for start in (a, b, c))] for k in corners]
    shape = polygon_shape([PolygonRing(ring, corners, owners, places)], name, notes)
    return replace(shape, many=False, one=partial(itself, labelled))


def _checked(edge: DrawnEdge) -> DrawnEdge:
    same = np.flatnonzero((np.diff(edge.points, axis=0) == 0).all(axis=1))
    if len(same) == len(edge.points) - 1:
        raise InputError(
            "an edge is one point", "give two or more points of every edge", place=edge.places[0]
        )
    if same.size:
        x, y = edge.points[same[0]]
        problem = f"repeats the point ({x:.6g}, {y:.6g}) of the line before"
        raise InputError(problem, "remove it", place=edge.places[same[0] + 1])
    return edge


def _directed(chain: Sequence[DrawnEdge]) -> list[DrawnEdge]:
    """Return a closed chain counter-clockwise from the first edge."""
    ring = np.concatenate([edge.points[:-1] for edge in chain])
    check_outline(ring, [place for edge in chain for place in edge.places[:-1]])
    if polygon_area(ring) >= 0:
        return list(chain)
    return [chain[0].reversed(), *(edge.reversed() for edge in chain[:0:-1])]


def _chained(edges: Sequence[DrawnEdge]) -> list[DrawnEdge]:
    """Return four edges so that each begins where the previous one ends."""
    reach = _JOIN * extent_of(np.concatenate([edge.points for edge in edges]))
    chain, left = [edges[0]], [way for edge in edges[1:] for way in (edge, edge.reversed())]
    while left:
        end = chain[-1].points[-1]
        gaps = [float(np.hypot(*(edge.points[0] - end))) for edge in left]
        k = int(np.argmin(gaps))
        if gaps[k] > reach:
            problem = (
                f"no other edge starts or ends at ({end[0]:g}, {end[1]:g}); the nearest is {gaps[k]:.3g} away"
            )
            raise InputError(problem, "make the four edges meet", place=left[k].places[0])
        chain.append(left[k]._replace(points=np.concatenate([end[None], left[k].points[1:]])))
        left = [edge for m, edge in enumerate(left) if m // 2 != k // 2]
    first, last = chain[0].points[0], chain[-1].points
    gap = float(np.hypot(*(last[-1] - first)))
    if gap > reach:
        raise InputError(f"the four edges do not close: {gap:.3g} are left open", "make the four edges meet")
    chain[-1] = chain[-1]._replace(points=np.concatenate([last[:-1], first[None]]))
    return chain
