"""Counts of cells along chords with given numbers of cells along sides of a domain, by their names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import combinations, pairwise
from types import MappingProxyType

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.periodic_sides import following, sides_of
from meshonet.geometry.reach import check_reach
from meshonet.solvers.blocking.decomposition.errors import BlockingError
from meshonet.solvers.blocking.decomposition.periodic_counts import rows_of
from meshonet.solvers.blocking.decomposition.quads.arc_counts import nearest_whole
from meshonet.solvers.blocking.sizes.chords import Chords
from meshonet.solvers.blocking.sizes.wall_turning import corners_between

Sums = Mapping[str, Mapping[int, float]]
"""How many edges of each chord are along the sides of a name."""
_NONE: Mapping[int, int] = MappingProxyType({})


def sums_of(chords: Chords) -> Sums:
    """Return how many edges of each chord are along the sides with given numbers of cells.

    Raises InputError: such a side ends inside an edge of a block.
    """
    mesh = chords.layout.mesh
    given = mesh.domain.counts
    if not given:
        return {}
    sums: dict[str, dict[int, float]] = {name: {} for name in given}
    after, beside = following(mesh), np.full(len(mesh.nodes), "", dtype=object)
    for each, *nodes in sides_of(mesh) if mesh.domain.periodic else ():
        for name, line in zip(each.names, nodes, strict=True):
            beside[line[1:-1]] = name
    for number, edge in enumerate(chords.edges):
        first, second = edge[:2].tolist()
        if after[first] != second and after[second] != first:
            continue
        periodic = next(filter(None, beside[edge].tolist()), "")
        names = [periodic] if periodic else _names(chords, number)
        for name in set(names) & set(given):
            if len(set(names)) > 1:
                problem = f"{name!r} begins or ends where the boundary goes straight on"
                raise InputError(problem, "give counts of sides between corners", parameter="count")
            chord = int(chords.chord[number])
            sums[name][chord] = sums[name].get(chord, 0.0) + 1.0
    return sums


def _names(chords: Chords, edge: int) -> list[str]:
    """Return the names along an edge on the boundary."""
    mesh = chords.layout.mesh
    loop = mesh.domain.loops[mesh.places.loop[chords.edges[edge]].max()]
    low, high = np.sort(chords.arcs(edge)[[0, -1]]).tolist()
    ends = [low, *corners_between(loop, low, high)[0].tolist(), high]
    return [loop.name_at(0.5 * (a + b)) for a, b in pairwise(ends)]


def with_counts(
    chords: Chords, counts: Indices, least: Indices, *, finer: int = 1, multiple: int = 1,
    fixed: Mapping[int, int] = _NONE,
) -> Indices:  # fmt: skip
    """Return the counts (chords,) nearest to `counts` that add up to those given along sides.

    `finer` cells are made of each of them later, with their number adjusted: if it is not 1 counts may be off
    by less than one. All are a multiple of `multiple`, as the given ones are then. Chords `fixed` stay.

    Raises InputError: given counts that exclude each other, or that are too few.
    """
    sums = sums_of(chords)
    if not sums:
        return counts
    least = least.copy()
    least[list(fixed)] = list(fixed.values())
    around = chords.multiple * multiple
    around[list(fixed)] = 1
    base = [({chord: 1.0}, float(count), float(count)) for chord, count in fixed.items()] + rows_of(chords)
    given = chords.layout.mesh.domain.counts

    def solved(names: Iterable[str]) -> Indices:
        rows = list(base)
        for name in names:
            total = given[name] * multiple / finer
            rows.append((sums[name], float(np.floor(total)), float(np.ceil(total))))
        rows = [({k: v * around[k] for k, v in row.items()}, low, high) for row, low, high in rows]
        return np.asarray(around * nearest_whole(counts / around, np.ceil(least / around), rows))

    try:
        found = solved(given)
        cause, remedy = "so many cells along sides", "give fewer"
        check_reach(chords.cells(found) * float(finer) ** 2, "cells", cause, remedy, parameter="count")
        return found
    except BlockingError:
        if finer > 1:
            return counts
    for size in (1, 2):
        for names in combinations(given, size):
            try:
                solved(names)
            except BlockingError:
                raise _conflict(names, given, sums, np.maximum(least, around)) from None
    raise _conflict(tuple(given), given, sums, least)


def _conflict(names: tuple[str, ...], given: Mapping[str, int], sums: Sums, least: Indices) -> InputError:
    cells = " and ".join(f"{given[name]} cells along {name!r}" for name in names)
    if len(names) > 1:
        problem = f"{cells} exclude each other: blocks have as many cells on opposite sides"
        return InputError(problem, "give one of these counts, or counts that are equal", parameter="count")
    fewest = int(sum(times * least[chord] for chord, times in sums[names[0]].items()))
    remedy = f"give {fewest} or more" if given[names[0]] < fewest else "give one more, or one less"
    return InputError(f"no blocks have {cells}", remedy, parameter="count")


def nearer(chords: Chords, counts: Indices, multiple: int = 1) -> Indices:
    """Return counts (chords,) with those along given sides scaled to about the given numbers."""
    counts = counts.copy()
    for name, row in sums_of(chords).items():
        total = sum(times * counts[chord] for chord, times in row.items())
        for chord in row:
            wanted = counts[chord] * chords.layout.mesh.domain.counts[name] * multiple / max(total, 1.0)
            counts[chord] = max(round(wanted), 1)
    return counts
