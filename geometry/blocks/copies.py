"""Copies of a periodic grid beside each other: several passages of a blade row, or all of them.

::

    +------+------+------+      The second periodic side of a copy has the nodes of the first side of the
    |  0   |  1   |  2   |      next one. Copies that fill a whole turn are joined to a ring; otherwise the
    +------+------+------+      outer sides are periodic, by the motion of all copies together.
    first           second

With several periods, shifts in different directions, copies are made along one after the other.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.blocks.screw import Screw, by_period, period_of
from meshonet.geometry.blocks.shared_nodes import node_table, with_equal_nodes
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError

MOST_COPIES = 10_000


def copied(grid: Grid, copies: int | Sequence[int]) -> Grid:
    """Return copies of a periodic grid, each joined to the next; all copies have the same patch names.

    The period of `grid` is a rotation, a translation, or several translations. `copies` gives the number of
    copies along each period. Rotated copies fill at most a whole turn.

    Raises InputError: a grid that is not periodic; too few or too many numbers; a number out of range.
    """
    counts = (copies,) if isinstance(copies, int) else tuple(copies)
    if counts == (1,):
        return grid
    periods = _periods(grid)
    if len(periods) != len(counts):
        raise _unlike(periods, len(counts))
    if len(counts) > 1 and math.prod(counts) > MOST_COPIES:
        problem = f"{'x'.join(map(str, counts))} copies"
        raise InputError(problem, f"use at most {MOST_COPIES} in all", parameter="copies")
    for count in counts:  # the period of the copies made last becomes the last one
        grid = _along(grid, *_periods(grid)[0], count)
    if len(counts) > 1:  # shifted in another order, corners differ by rounding
        grid = replace(grid, blocks=with_equal_nodes(grid.blocks, grid.connections))
    return grid.with_provenance(copies=math.prod(counts))


def _along(grid: Grid, motion: Motion, periodic: Sequence[Connection], copies: int) -> Grid:
    """Return copies of a grid along the period of its connections `periodic`, a `motion`."""
    screw, turn = period_of(motion)
    most = int(turn) or MOST_COPIES
    if not 1 <= copies <= most:
        problem = f"{copies} copies of {math.degrees(abs(screw.angle)):.6g} degrees" if turn else f"{copies}"
        raise InputError(problem, f"use 1 to {most}", parameter="copies")
    dimension, step = grid.blocks[0].nodes.shape[-1], len(grid.blocks)
    motions = [_repeated(screw, k, dimension) for k in range(copies + 1)]
    if copies == turn:
        motions[-1] = Motion()
    nodes, numbers = node_table(grid.blocks, grid.connections)
    pairs = [replace(each, transform=None).pairs(numbers) for each in periodic]
    first, second = (np.concatenate([pair[end].ravel() for pair in pairs]) for end in (0, 1))
    blocks: list[Block] = []
    for k in range(copies):
        table = motions[k](nodes).copy()
        table[second] = motions[k + 1](nodes[first])
        blocks += [Block(table[number], finite=True) for number in numbers]
    patches = [replace(each, block=each.block + k * step) for k in range(copies) for each in grid.patches]
    taken = [ends for other in periodic for ends in (other.ends, other.ends[::-1])]
    own = [each for each in grid.connections if each.ends not in taken]
    inside = (
        replace(each, block=each.block + k * step, donor=each.donor + k * step)
        for k in range(copies)
        for each in own
    )
    connections = (*inside, *_between(periodic, step, copies, motions[-1]))
    facts = {name: fact for name, fact in grid.provenance.items() if name != "zones"}
    return replace(
        grid, blocks=tuple(blocks), patches=tuple(patches), connections=connections, provenance=facts
    )


def _periods(grid: Grid) -> list[tuple[Motion, list[Connection]]]:
    periods = by_period(grid.connections)
    if not periods:
        remedy = "copy one with periodic sides, such as a passage between blades"
        raise InputError("the grid is not periodic", remedy, parameter="copies")
    if len(periods) > 1 and any(motion.turn for motion, _ in periods):
        remedy = "copy a grid with one period, or with shifts only"
        raise InputError("the grid is periodic in several ways", remedy, parameter="copies")
    return periods


def _unlike(periods: Sequence[tuple[Motion, list[Connection]]], numbers: int) -> InputError:
    if len(periods) == 1:
        return InputError(f"{numbers} numbers for a grid with one period", "give one", parameter="copies")
    ways = " and ".join(f"({', '.join(f'{x:.6g}' for x in motion.shift)})" for motion, _ in periods)
    problem = f"the grid is periodic by shifts of {ways}"
    counts = "x".join(["3", *["2"] * (len(periods) - 1)])
    return InputError(problem, f"give a number for each, such as {counts}", parameter="copies")


def _repeated(screw: Screw, times: int, dimension: int) -> Motion:
    """Return the motion of a screw repeated `times` times (Rodrigues' formula)."""
    shift = times * screw.shift
    if not screw.angle or not times:
        return Motion(tuple(shift[:dimension].tolist()) if times else ())
    angle = times * screw.angle
    a, c, s = screw.axis, math.cos(angle), math.sin(angle)
    cross = np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])
    along = np.outer(a, a)
    turn = along + c * (np.eye(3) - along) + s * cross
    shift = shift + screw.centre - product(turn, screw.centre)
    rows = tuple(map(tuple, turn[:dimension, :dimension].tolist()))
    return Motion(tuple(shift[:dimension].tolist()) if shift.any() else (), rows)


def _between(periodic: Sequence[Connection], step: int, copies: int, whole: Motion) -> Iterator[Connection]:
    """Yield the connections of each copy to the one before, and of the first to the last."""
    for each in periodic:
        for k in range(1, copies):
            block, donor = each.block + k * step, each.donor + (k - 1) * step
            yield replace(each, block=block, donor=donor, transform=None)
        last = each.donor + (copies - 1) * step
        yield replace(each, donor=last, transform=whole if whole.shift or whole.turn else None)
