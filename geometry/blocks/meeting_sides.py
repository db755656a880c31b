"""Finds the sides on which blocks touch each other or themselves, from the positions of nodes.

::

    +-------+-------+      A cell of a side (a quadrilateral of a volume, an edge of a surface patch) meets a
    |   0   |   1   |      cell of another side if their corners coincide in one of the eight (or two)
    +---+---+-------+      orientations in which one array of nodes can lie on the other. Neighbouring cells
        | 2 |              that meet in the same orientation form a connection, of whole sides or of parts
        +---+              of sides, as between blocks 0 and 2.

Volumes that touch lie on different sides of their common face. Planar blocks lie on the left of their
boundary, and so run along a common side in opposite directions: a copy of a block is not joined to it. A side
collapsed to a line, or an edge collapsed to a point, joins nothing. A side may be joined to itself, as at the
wake of a C grid.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import permutations, product

import numpy as np

from meshonet.geometry import elementary
from meshonet.geometry.arrays import Bools, Floats, Indices, Side, norms
from meshonet.geometry.blocks.block import PLACES, Block, Range, form_of, sides_of
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.outer_patches import JOINED, rectangles

AROUND: Mapping[Side, int] = {"west": -1, "east": 1, "south": 1, "north": -1}
"""Whether the nodes of a side of a planar block run counter-clockwise around it."""
_DIRECTION = np.array([0.5403023, 0.6710117, 0.5076571])
"""Direction along which cells are sorted; as it is oblique, few cells have equal positions."""
_MOST = 0.25  # nodes farther apart than this fraction of an edge are different, whatever their rounding
_FLAT = 1e-12  # largest area of a cell that counts as a line, divided by the square of its longest edge

_DECIMALS = range(3, 13)  # decimal places that numbers may have been written with
_DIGITS = range(5, 14)  # significant digits that numbers may have been written with
_COUNTED = 400  # largest number of values whose digits are counted


def meeting_sides(
    blocks: Sequence[Block], tolerance: float, without: Iterable[tuple[int, Side, Range]]
) -> list[Connection]:
    """Return the connections of planar blocks, surface patches or volumes, as `find_connections` does."""
    known = list(without)
    joined: list[Connection] = []
    for form in ("plane", "volume", "surface"):
        numbers = [number for number, block in enumerate(blocks) if form_of(block.nodes) == form]
        own = [(numbers.index(part[0]), *part[1:]) for part in known if part[0] in numbers]
        for each in _meeting([blocks[number] for number in numbers], tolerance, own) if numbers else ():
            joined.append(replace(each, block=numbers[each.block], donor=numbers[each.donor]))
    return joined


def _meeting(
    blocks: Sequence[Block], tolerance: float, without: Sequence[tuple[int, Side, Range]]
) -> list[Connection]:
    cells = _cells(blocks, without)
    if not len(cells.block):  # all is known
        return []
    own, donor = _near(cells, tolerance)
    groups = list(_groups(cells, own, donor, tolerance))
    free = np.ones(len(cells.block), dtype=bool)
    joined = []
    for group in sorted(groups, key=lambda group: group.rank(cells)):
        open_ = free[group.own] & free[group.donor]
        for part in _rectangles(cells, group, open_):
            free[group.own[part]] = free[group.donor[part]] = False
            joined.append(_connection(cells, group, part))
    return joined


@dataclass(frozen=True)
class _SideCells:
    """Cells (n) of the sides of all blocks."""

    corners: Floats
    """(n, 2, 2 or 3) of edges, (n, 2, 2, 3) of quadrilaterals."""
    block: Indices
    side: Indices
    """Number of the side in `PLACES`."""
    place: Indices
    """(n, 1) or (n, 2) cell along each direction of the side."""
    inwards: Floats | None
    """(n, 3) vector from the centre of the cell to that of the opposite face; None except for volumes."""
    slack: Floats
    """Smallest tolerance for the distance of two nodes that coincide, because of rounding."""

    @property
    def flat(self) -> Floats:
        """Corners of the sides: (n, 2, 2) for lines in the plane, (n, 2, 3) in space, (n, 4, 3) for faces."""
        return self.corners.reshape(len(self.block), -1, self.corners.shape[-1])

    def reach(self, tolerance: float) -> Floats:
        """Return the distance (n,) up to which nodes count as equal."""
        lengths = _edges(self.corners)
        length = np.where(lengths > 0, lengths, np.inf).min(axis=1)
        return np.minimum(np.maximum(tolerance * length, self.slack), _MOST * length)


def _cells(blocks: Sequence[Block], known: Sequence[tuple[int, Side, Range]]) -> _SideCells:
    corners, numbers, sides, places, inwards = [], [], [], [], []
    for number, block in enumerate(blocks):
        for turn, side in enumerate(sides_of(block.counts)):
            own = _corners(block.face(side))
            keep = _extended(own)
            for span in (part[2] for part in known if part[:2] == (number, side)):
                keep[tuple(slice(*ends) for ends in span)] = False
            at = np.argwhere(keep)
            axis, end = PLACES[side]
            if len(block.counts) == len(PLACES) // 2:
                layers = np.moveaxis(block.nodes, axis, 0)
                beyond = _corners(layers[1 if end == 0 else -2])
                inwards.append((beyond - own).mean(axis=(-2, -3))[keep])
            corners.append(own[keep])
            numbers.append(np.full(len(at), number))
            sides.append(np.full(len(at), turn))
            places.append(at)
    every = np.concatenate(corners)
    slack = 2.0 * rounding(every.reshape(-1))(
        np.abs(every).max(axis=tuple(range(1, every.ndim)), initial=0.0)
    )
    place, away = np.concatenate(places), np.concatenate(inwards) if inwards else None
    return _SideCells(every, np.concatenate(numbers), np.concatenate(sides), place, away, slack)


def _corners(face: Floats) -> Floats:
    """Return the corners (n-1, 2, 3) or (n-1, m-1, 2, 2, 3) of the cells of a side."""
    if face.ndim == 2:
        return np.stack([face[:-1], face[1:]], axis=1)
    rows = [np.stack([part[:, :-1], part[:, 1:]], axis=2) for part in (face[:-1], face[1:])]
    return np.stack(rows, axis=2)


def _edges(corners: Floats) -> Floats:
    """Return the lengths (n, 1 or 4) of the edges of cells."""
    ring = corners.reshape(len(corners), -1, corners.shape[-1])
    ring = ring[:, [0, 2, 3, 1]] if ring.shape[1] == 4 else ring
    steps = (np.roll(ring, -1, axis=1) - ring)[:, : 1 if ring.shape[1] == 2 else 4]
    return norms(steps)


def _extended(corners: Floats) -> Bools:
    """Return whether each cell of a side has an extent: a length of edges, an area of quadrilaterals."""
    shape = corners.shape[: (corners.ndim - 1) // 2]
    flat = corners.reshape(-1, *corners.shape[len(shape) :])
    longest = _edges(flat).max(axis=1)
    if len(shape) == 1:
        return np.asarray(longest > 0)
    first, second = flat[:, 1, 1] - flat[:, 0, 0], flat[:, 1, 0] - flat[:, 0, 1]
    area = np.sqrt((np.cross(first, second) ** 2).sum(axis=-1))
    return np.asarray(area > _FLAT * longest**2).reshape(shape)


def _near(cells: _SideCells, tolerance: float) -> tuple[Indices, Indices]:
    """Return pairs of cells whose centres coincide, the cell of the lower number first."""
    reach, centre = cells.reach(tolerance), cells.flat.mean(axis=1)
    place = elementary.product(centre, _DIRECTION[: centre.shape[1]])
    row = np.argsort(place, kind="stable")
    ordered = place[row]
    stop = np.searchsorted(ordered, ordered + reach[row], side="right")
    count = np.maximum(stop - np.arange(len(row)) - 1, 0)
    first = np.repeat(np.arange(len(row)), count)
    second = first + 1 + np.arange(len(first)) - np.repeat(np.cumsum(count) - count, count)
    a, b = np.minimum(row[first], row[second]), np.maximum(row[first], row[second])
    same = np.sqrt(((centre[a] - centre[b]) ** 2).sum(axis=-1)) <= np.minimum(reach[a], reach[b])
    if cells.inwards is not None:
        corners = cells.flat[a]
        normal = np.cross(corners[:, 3] - corners[:, 0], corners[:, 2] - corners[:, 1])
        ways = [(normal * cells.inwards[number]).sum(axis=-1) for number in (a, b)]
        same &= ways[0] * ways[1] <= 0
    return a[same], b[same]


@dataclass(frozen=True)
class _Group:
    """Pairs of cells of one side and one donor side, all of one orientation and offset."""

    own: Indices
    donor: Indices
    orientation: tuple[int, ...]

    def rank(self, cells: _SideCells) -> tuple[bool, int, int, int]:
        """Return the sort key of a group of cells; groups within one block come before the others."""
        a, b = self.own[0], self.donor[0]
        return bool(cells.block[a] != cells.block[b]), -len(self.own), int(a), int(b)


def _groups(cells: _SideCells, own: Indices, donor: Indices, tolerance: float) -> Iterator[_Group]:
    """Yield the pairs with the same corners, grouped by sides, orientation and offset."""
    reach = cells.reach(tolerance)
    near = np.minimum(reach[own], reach[donor])
    directions, turns = cells.place.shape[1], np.array(list(AROUND.values()))
    for axes in permutations(range(directions)):
        for ways in product((1, -1), repeat=directions):
            turned = cells.corners[donor].transpose(0, *(axis + 1 for axis in axes), directions + 1)
            turned = turned[(slice(None), *(slice(None, None, way) for way in ways))]
            away = np.sqrt(((turned - cells.corners[own]) ** 2).sum(axis=-1))
            same = away.max(axis=tuple(range(1, away.ndim))) <= near
            if cells.corners.shape[-1] == 2:  # planar blocks
                same &= turns[cells.side[own]] * turns[cells.side[donor]] == -ways[0]
            pairs = np.flatnonzero(same)
            a, b = own[pairs], donor[pairs]
            offset = cells.place[b][:, list(axes)] - cells.place[a] * ways
            sides = [cells.block[a], cells.side[a], cells.block[b], cells.side[b]]
            key = np.stack([*sides, *offset.T], axis=1)
            order = np.lexsort(key.T)
            starts = np.flatnonzero((np.diff(key[order], axis=0) != 0).any(axis=1)) + 1
            orientation = tuple(way * (axis + 1) for axis, way in zip(axes, ways, strict=True))
            for part in np.split(order, starts) if len(order) else []:
                inside = np.sort(part)
                yield _Group(a[inside], b[inside], orientation)


def _rectangles(cells: _SideCells, group: _Group, open_: Bools) -> Iterator[Indices]:
    """Yield the pairs of a group that are still `open_`, one rectangle of them at a time."""
    if not open_.any():
        return
    place = cells.place[group.own]
    low = place.min(axis=0)
    number = np.full(np.ptp(place, axis=0) + 1, -1)
    number[tuple((place[open_] - low).T)] = np.flatnonzero(open_)
    for _, spans in rectangles(np.where(number < 0, JOINED, 0)):
        yield number[tuple(slice(*span) for span in spans)].ravel()


def _connection(cells: _SideCells, group: _Group, part: Indices) -> Connection:
    """Return the connection of pairs of cells; its own side is the first by block and `PLACES`."""
    ends = []
    for numbers in (group.own[part], group.donor[part]):
        place = cells.place[numbers]
        low, high = place.min(axis=0).tolist(), (place.max(axis=0) + 1).tolist()
        side = list(PLACES)[int(cells.side[numbers[0]])]
        ends.append((int(cells.block[numbers[0]]), side, tuple(zip(low, high, strict=True))))
    joined = Connection(*ends[0], *ends[1], group.orientation)
    first, second = ((number, list(PLACES).index(side), span) for number, side, span in ends)
    return joined if first <= second else joined.reversed()


def rounding(values: Floats) -> Callable[[Floats], Floats]:
    """Return a function that maps magnitudes (n,) of coordinates to the units (n,) of their last digits.

    The units are estimated from `values` (m,), the coordinates of a file. These may have single precision, a
    fixed number of digits, or a fixed number of decimals. Two copies of a point may differ by one such unit,
    which next to walls can be a large part of a cell.

    >>> unit = rounding(np.array([0.123457, 12.345679, 3.0]))  # written by %.6f
    >>> unit(np.array([1.0, 2.0])).tolist()
    [1e-06, 1e-06]
    """
    with np.errstate(over="ignore"):
        odd = values[values != values.astype(np.float32)]
    if not len(odd):
        return lambda size: np.asarray(size * 2**-23)
    numbers = odd[:: max(1, len(odd) // _COUNTED)].tolist()
    fixed = (10**-k for k in _DECIMALS if (values == np.round(values, k)).all())
    relative = (10 ** (1 - k) for k in _DIGITS if all(v == float(f"{v:.{k - 1}e}") for v in numbers))
    unit, part = next(fixed, 0.0), next(relative, 2**-50)
    return lambda size: np.maximum(unit, size * part)
