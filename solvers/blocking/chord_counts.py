"""How many cells go along each chord of a layout: whole numbers from wanted sizes, turning, layers, a total.

A chord is the class of all block sides that must have equally many cells, since they are opposite in some
block. In a layout every chord's number is free, so no programme is needed unless sums of some are coupled,
as where the sides of a period are of several blocks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.arc_counts import nearest_whole

TURN_DEG = 25.0
"""A wall turns by at most so much in one cell, unless asked otherwise."""
FEWEST = 2
"""Cells along a chord, at least."""


@dataclass(frozen=True, eq=False)
class ChordWishes:
    """What the sides of blocks want, and what couples chords.

    Parameters
    ----------
    chord : (e,) number of the chord of each side, 0 to c - 1.
    wanted : (e,) cells along each side, any positive numbers; a chord takes their geometric mean.
    least : (e,) cells along each side, at least.
    exact : numbers that chords must have, as those across layers; they go before all other wishes.
    equal : pairs of runs of chords whose numbers have the same sum, as both sides of a period.
    blocks : (b, 2) both chords of each block, of which the total of cells is counted.
    """

    chord: Indices
    wanted: Floats
    least: Floats
    exact: Mapping[int, int] = field(default_factory=dict)
    equal: Sequence[tuple[Sequence[int], Sequence[int]]] = ()
    blocks: Indices = field(default_factory=lambda: np.zeros((0, 2), dtype=np.intp))


def chord_counts(wishes: ChordWishes, cells: int = 0, multiple: int = 1) -> Indices:
    """Return the number of cells (c,) along each chord.

    Parameters
    ----------
    wishes : of the sides.
    cells : total to come near, all wanted numbers scaled alike; 0 for no total.
    multiple : each number is a multiple of it, so that a family of grids 2^k times coarser is nested.

    Raises InputError: an exact number that is no multiple. BlockingError: sums that cannot be equal.
    """
    for chord, number in wishes.exact.items():
        if number % multiple:
            raise InputError(
                f"{number} cells across layers of chord {chord} are no multiple of {multiple}",
                "ask for another number of layers, or for fewer levels",
            )
    mean = _means(wishes)
    least = np.full(len(mean), float(FEWEST))
    np.maximum.at(least, wishes.chord, wishes.least)
    if not cells or not len(wishes.blocks):
        return _whole(wishes, mean, least, multiple)
    return _with_total(wishes, mean, least, cells, multiple)


def _means(wishes: ChordWishes) -> Floats:
    """Return the geometric mean (c,) of what the sides of each chord want, weighted by what they want."""
    chords = int(wishes.chord.max(initial=-1)) + 1
    wanted = np.maximum(wishes.wanted, 1e-9)
    weight = np.bincount(wishes.chord, wanted, minlength=chords)
    logs = np.bincount(wishes.chord, wanted * np.log(wanted), minlength=chords)
    return np.exp(np.divide(logs, weight, out=np.zeros(chords), where=weight > 0))


def _whole(wishes: ChordWishes, mean: Floats, least: Floats, multiple: int) -> Indices:
    """Return multiples near the means that keep what couples chords."""
    fewest, wanted = np.ceil(least / multiple - 1e-9), mean / multiple
    for chord, number in wishes.exact.items():
        fewest[chord] = wanted[chord] = number // multiple
    rows = []
    for first, second in wishes.equal:
        row: dict[int, float] = {}
        for run, sign in ((first, 1.0), (second, -1.0)):
            for chord in run:
                row[chord] = row.get(chord, 0.0) + sign
        row = {chord: value for chord, value in row.items() if value}
        if row:
            rows.append((row, 0.0, 0.0))
    if not rows:
        return np.asarray(multiple * np.maximum(fewest, np.round(wanted)), dtype=np.intp)
    exact = [({chord: 1.0}, number / multiple, number / multiple) for chord, number in wishes.exact.items()]
    return np.asarray(multiple * nearest_whole(wanted, fewest, [*rows, *exact]), dtype=np.intp)


def _with_total(wishes: ChordWishes, mean: Floats, least: Floats, cells: int, multiple: int) -> Indices:
    """Return the numbers of that scale of the means whose total comes nearest, by bisection."""

    def total(numbers: Indices) -> int:
        return int(np.prod(numbers[wishes.blocks], axis=1).sum())

    low, high = 1e-3, 1e3
    best = _whole(wishes, mean, least, multiple)
    for _ in range(40 if not wishes.equal else 12):
        scale = np.sqrt(low * high)
        tried = _whole(wishes, mean * scale, least, multiple)
        now = total(tried)
        if abs(np.log(now / cells)) < abs(np.log(total(best) / cells)):
            best = tried
        low, high = (low, scale) if now > cells else (scale, high)
    return best


def turning_least(loop: Loop, start: float, stop: float, turn_deg: float = TURN_DEG) -> int:
    """Return the cells that a stretch of a loop needs so that none turns by more than `turn_deg`.

    `start` and `stop` are arc lengths, `stop` further along. Corners do not count: nodes stand there.
    """
    steps = 8 * max(4, int(np.ceil(len(loop.curve.points) * (stop - start) / loop.length)))
    arcs = np.linspace(start, stop, min(steps, 4000) + 1)
    inner = (loop.corner_arcs - start) % loop.length
    ends = [0.0, *sorted(inner[(inner > 0) & (inner < stop - start)].tolist()), stop - start]
    turned = 0.0
    tiny = 1e-7 * loop.length
    for a, b in pairwise(ends):
        own = arcs[(arcs - start > a + tiny) & (arcs - start < b - tiny)]
        tangent = loop.tangent(np.concatenate([[start + a + tiny], own, [start + b - tiny]]))
        z = tangent[:, 0] + 1j * tangent[:, 1]
        turned += float(np.abs(np.angle(z[1:] * z[:-1].conj())).sum())
    return int(np.ceil(np.degrees(turned) / turn_deg - 1e-6))


def layer_rows(thickness: float, first: float, growth: float) -> int:
    """Return how many rows of cells, the first `first` high and each `growth` times the last, fill layers.

    >>> layer_rows(0.7, 0.1, 2.0)
    3
    """
    if growth <= 1.0 + 1e-12:
        return max(int(np.ceil(thickness / first - 1e-9)), 1)
    rows = np.log1p((growth - 1.0) * thickness / first) / np.log(growth)
    return max(int(np.ceil(rows - 1e-9)), 1)
