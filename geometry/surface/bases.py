"""Open trailing edges of a surface, whose upper and lower sides end apart, closed by base patches.

::

    upper side ------+ a      a and b: open sides of the same number of nodes, close to each other, from
                     : base   which both patches go the same way; the base joins their nodes by straight
    lower side ------+ b      lines, with the nodes of a tip patch where that is open there too
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import NamedTuple, Self

import numpy as np

from meshonet.geometry.arrays import Floats, Indices, arc_parts, extent_of, norms
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.surface.half_edges import open_sides, paired
from meshonet.geometry.surface.merge import TOLERANCE, merged
from meshonet.geometry.surface.planes import FLAT, planes_of
from meshonet.geometry.surface.poles import TURNS

_THICK = 0.1  # largest thickness of an open trailing edge, divided by the length of the patches before it
_ALIKE = 0.5  # smallest cosine of the angle between the two sides of a trailing edge
_THIN = 0.02  # largest thickness over length of a trailing edge in a plane at an end of the surface
_CELLS = (2, 16)  # smallest and largest number of cells across a base whose ends are not given


@dataclass(frozen=True)
class _OpenSide:
    """A side of a patch along which all edges are open.

    `line` (n,) are its nodes, `inward` (n, m, 3) those of the patch from there; `axis` is that of a plane at
    an end of the surface with the side, or None.
    """

    patch: int
    name: str
    line: Indices
    inward: Floats
    axis: int | None

    def reversed(self) -> Self:
        return replace(self, line=self.line[::-1], inward=self.inward[::-1])


class _Edge(NamedTuple):
    """An open trailing edge: its two sides, node by node, and its largest thickness over its length."""

    upper: _OpenSide
    lower: _OpenSide
    thickness: float


def with_bases(patches: Sequence[Floats]) -> tuple[list[Floats], list[int], tuple[str, ...]]:
    """Return `patches` (ni, nj, 3), followed by further patches (bases) that close open trailing edges.

    Also return the index of a patch beside each base, and notes. Raises InputError: a trailing edge that has
    different numbers of cells across its thickness at its two spanwise ends.
    """
    nodes, lattices = merged(patches)
    sides = _open_sides(patches, nodes, lattices)
    out, above, notes = list(patches), [], []
    for upper, lower, _ in _trailing_edges(nodes, sides):
        base = _base(nodes, upper, lower.line, sides)
        notes.append(
            f"the open trailing edge between the {upper.name} side of patch {upper.patch} and the "
            f"{lower.name} side of patch {lower.patch}, at {place_of(base[0, 0])}, was closed by a "
            f"base of {base.shape[1] - 1} cells across, patch {len(out)}"
        )
        out.append(base)
        above.append(upper.patch)
    return out, above, tuple(notes)


def _open_sides(patches: Sequence[Floats], nodes: Floats, lattices: tuple[Indices, ...]) -> list[_OpenSide]:
    quads = lattice_quads(lattices)
    twin, _ = paired(quads, len(nodes))
    opened = open_sides(quads, twin)
    edges = {tuple(sorted(edge)) for edge in opened[:, :2].tolist()}
    planes = planes_of(nodes, opened)
    slack = FLAT * extent_of(nodes)
    sides = []
    for number, (patch, lattice) in enumerate(zip(patches, lattices, strict=True)):
        for name, turns in TURNS.items():
            line = np.rot90(lattice, turns)[:, 0]
            pairs = zip(line[:-1].tolist(), line[1:].tolist(), strict=True)
            if all(tuple(sorted(pair)) in edges for pair in pairs):
                inside = (p.axis for p in planes if (np.abs(nodes[line, p.axis] - p.value) <= slack).all())
                inward = np.rot90(patch, turns, (0, 1))
                sides.append(_OpenSide(number, name, line, inward, next(inside, None)))
    return sides


def _trailing_edges(nodes: Floats, sides: list[_OpenSide]) -> list[_Edge]:
    """Return the open trailing edges between sides.

    Sides of a wing in a plane of symmetry look like one; an edge in a plane at an end of the surface must
    therefore be thin, and thinner than pairs in planes normal to another axis.
    """
    size = extent_of(nodes)
    pairs = [
        _Edge(one, lower, _thickness(nodes, one, lower))
        for one, other in combinations(sides, 2)
        for lower in (other, other.reversed())
        if one.axis == other.axis and _alike(nodes, one, lower, size)
    ]
    others = {side.axis: np.inf for side in sides if side.axis is not None}
    for edge in pairs:
        if edge.upper.axis is not None:
            others[edge.upper.axis] = min(others[edge.upper.axis], edge.thickness)
    return [
        edge
        for edge in pairs
        if (axis := edge.upper.axis) is None
        or any(edge.thickness < min(_THIN, thick) for across, thick in others.items() if across != axis)
    ]


def _alike(nodes: Floats, one: _OpenSide, other: _OpenSide, size: float) -> bool:
    """Return whether two sides have as many nodes, and are close, with patches in one direction."""
    if len(one.line) != len(other.line):
        return False
    gap = norms(nodes[one.line] - nodes[other.line])
    length = min(float(norms(side.inward[:, -1] - side.inward[:, 0]).min()) for side in (one, other))
    if gap.min() <= TOLERANCE * size or gap.max() > _THICK * length:
        return False
    first, second = (side.inward[:, 1] - side.inward[:, 0] for side in (one, other))
    return bool(((first * second).sum(axis=1) > _ALIKE * norms(first) * norms(second)).all())


def _thickness(nodes: Floats, one: _OpenSide, other: _OpenSide) -> float:
    length = norms(np.diff(nodes[one.line], axis=0)).sum()
    return float(norms(nodes[one.line] - nodes[other.line]).max() / length)


def _base(nodes: Floats, one: _OpenSide, line: Indices, sides: list[_OpenSide]) -> Floats:
    """Return the base (n, m, 3) from a side to `line`, with nodes of open sides across its ends."""
    upper, lower = nodes[one.line], nodes[line]
    ends = [_across(nodes, int(one.line[k]), int(line[k]), sides) for k in (0, -1)]
    counts = {len(end) for end in ends if end is not None}
    if len(counts) > 1:
        few, many = sorted(counts)
        ends_differ = f"has {few} nodes across one end, {many} across the other"
        problem = f"the open trailing edge of patch {one.patch} {ends_differ}"
        raise InputError(problem, "give both ends as many", place=place_of(upper[0]))
    length = float(norms(one.inward[:, 1] - one.inward[:, 0]).mean())
    cells = round(float(norms(upper - lower).mean()) / length)
    count = counts.pop() if counts else min(max(cells, _CELLS[0]), _CELLS[1]) + 1
    known = next((end for end in ends if end is not None), None)
    part = np.linspace(0.0, 1.0, count) if known is None else arc_parts(known)
    base = upper[:, None] + part[:, None] * (lower - upper)[:, None]
    along = arc_parts(upper)
    for end, at, weight in zip(ends, (0, -1), (1.0 - along, along), strict=True):
        if end is not None:
            base += weight[:, None, None] * (end - base[at])
            base[at] = end
    base[:, 0], base[:, -1] = upper, lower
    return np.asarray(base)


def _across(nodes: Floats, start: int, stop: int, sides: list[_OpenSide]) -> Floats | None:
    """Return the nodes of the open side between two nodes, None if there is none."""
    for side in sides:
        for line in (side.line, side.line[::-1]):
            if line[0] == start and line[-1] == stop:
                return np.asarray(nodes[line])
    return None
