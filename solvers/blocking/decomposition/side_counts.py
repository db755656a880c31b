"""Cell counts of rows of blocks: some sides have prescribed counts, periodic sides have equal counts."""

from collections.abc import Iterable, Mapping
from itertools import combinations, pairwise
from types import MappingProxyType

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.domain.wall_turning import corners_between
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.periodic_sides import following, sides_of
from meshonet.geometry.reach import check_reach
from meshonet.solvers.refinement.chords import Chords
from meshonet.solvers.whole_numbers import Row, whole_numbers

Sums = Mapping[str, Mapping[int, float]]
"""By the name of sides and the number of a chord: number of edges of the chord along these sides."""
_NONE: Mapping[int, int] = MappingProxyType({})


def sums_of(chords: Chords) -> Sums:
    """Return, for each side with a given cell count, how many edges of each chord lie on this side.

    A chord is a set of opposite edges. Raises InputError if an end of such a side is no corner.
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
    mesh = chords.layout.mesh
    loop = mesh.domain.loops[mesh.places.loop[chords.edges[edge]].max()]
    low, high = np.sort(chords.arcs(edge)[[0, -1]]).tolist()
    ends = [low, *corners_between(loop, low, high)[0].tolist(), high]
    return [loop.name_at(0.5 * (a + b)) for a, b in pairwise(ends)]


def suited(
    chords: Chords, counts: Indices, least: Indices, *, finer: int = 1, multiple: int = 1,
    fixed: Mapping[int, int] = _NONE, named: bool = True,
) -> Indices:  # fmt: skip
    """Return cell counts of chords (rows of blocks) that satisfy all conditions and are nearest to `counts`.

    Counts are at least `least`, multiples of `multiple`, and equal on both sides of periodic pairs. `fixed`
    prescribes the counts of some chords, by index. If `named`, a side for which the domain prescribes n cells
    gets about n * `multiple` / `finer`. The final grid has `finer` times as many cells along each side; n is
    meant for a grid `multiple` times coarser than the final one. Raises InputError if prescribed counts
    contradict each other or are too small; SolverError if periodic sides cannot have equal counts.
    """
    sums, alike = sums_of(chords) if named else {}, _alike(chords)
    if not sums and not alike:
        return counts
    least = least.copy()
    least[list(fixed)] = list(fixed.values())
    around = chords.multiple * multiple
    around[list(fixed)] = 1
    numbers = chords.layout.mesh.domain.counts

    def solved(names: Iterable[str]) -> Indices:
        rows = [*alike, *(({chord: 1.0}, float(count), float(count)) for chord, count in fixed.items())]
        for name in names:
            total = numbers[name] * multiple / finer
            rows.append((sums[name], float(np.floor(total)), float(np.ceil(total))))
        rows = [({k: v * around[k] for k, v in row.items()}, low, high) for row, low, high in rows]
        return np.asarray(around * whole_numbers(counts / around, np.ceil(least / around), rows))

    try:
        nearest = solved(sums)
    except SolverError:
        try:
            counts = solved(()) if alike else counts
        except SolverError:
            raise SolverError(_unmatched(chords.layout.mesh.domain.periodic[0])) from None
        if finer > 1:
            return counts
    else:
        if sums:
            cause, remedy = "so many cells along sides", "give fewer"
            check_reach(chords.cells(nearest) * float(finer) ** 2, "cells", cause, remedy, parameter="count")
        return nearest
    for size in (1, 2):
        for names in combinations(sums, size):
            try:
                solved(names)
            except SolverError:
                raise _conflict(names, numbers, sums, np.maximum(least, around)) from None
    raise _conflict(tuple(sums), numbers, sums, least)


def _conflict(names: tuple[str, ...], given: Mapping[str, int], sums: Sums, least: Indices) -> InputError:
    cells = " and ".join(f"{given[name]} cells along {name!r}" for name in names)
    if len(names) > 1:
        problem = f"{cells} exclude each other: blocks have as many cells on opposite sides"
        return InputError(problem, "give one of these counts, or counts that are equal", parameter="count")
    fewest = int(sum(times * least[chord] for chord, times in sums[names[0]].items()))
    remedy = f"give {fewest} or more" if given[names[0]] < fewest else "give one more, or one less"
    return InputError(f"no blocks have {cells}", remedy, parameter="count")


def nearer(chords: Chords, counts: Indices, multiple: int = 1) -> Indices:
    """Return cell counts, scaled so that sides with a prescribed count get about `multiple` times this count.

    `counts` (chords,) and the result have a number of cells for each chord (set of opposite block edges).
    """
    counts = counts.copy()
    for name, row in sums_of(chords).items():
        total = sum(times * counts[chord] for chord, times in row.items())
        for chord in row:
            wanted = counts[chord] * chords.layout.mesh.domain.counts[name] * multiple / max(total, 1.0)
            counts[chord] = max(round(wanted), 1)
    return counts


def check_sides(layout: Layout) -> None:
    """Raise SolverError unless the nodes of periodic sides can match their partners one to one."""
    mesh = layout.mesh
    if not mesh.domain.periodic:
        return
    for each, first, second in sides_of(mesh):
        ends = np.array([first[0], first[-1], second[0], second[-1]])
        if (mesh.valence[ends] != mesh.places.cells[ends]).any():
            raise SolverError(_unmatched(each))
    chords = Chords.of(layout)
    suited(chords, chords.counts, chords.least, named=False)


def _unmatched(sides: Periodic) -> str:
    return (
        f"blocks along periodic sides {sides.names[0]!r} and {sides.names[1]!r} cannot be matched; cut the "
        "domain where its sides meet walls at about 90 degrees"
    )


def alike_along_sides(chords: Chords, counts: Indices) -> bool:
    """Return whether, with these cell `counts`, both sides of each periodic pair have equally many cells."""
    return all(
        sum(value * counts[chord] for chord, value in row.items()) == 0.0 for row, _, _ in _alike(chords)
    )


def _alike(chords: Chords) -> list[Row]:
    """Return the conditions that both sides of each periodic pair have equally many cells."""
    return [(row, 0.0, 0.0) for row in _differences(chords) if row]


def lacking_side(layout: Layout) -> Indices | None:
    """Return the nodes of a periodic side that cannot have as many cells as its partner; None if all can."""
    if not layout.mesh.domain.periodic:
        return None
    for row, (_, first, second) in zip(_differences(Chords.of(layout)), sides_of(layout.mesh), strict=True):
        signs = set(np.sign(list(row.values())).tolist())
        if len(signs) == 1:
            return second if signs == {1.0} else first
    return None


def _differences(chords: Chords) -> list[dict[int, float]]:
    """Return, for each pair of sides, the ends of each chord on the first minus those on the second."""
    mesh = chords.layout.mesh
    if not mesh.domain.periodic:
        return []
    after = following(mesh)
    side = np.zeros(len(mesh.nodes), dtype=np.intp)  # of the boundary edge that starts at a node
    for number, (_, first, second) in enumerate(sides_of(mesh), start=1):
        side[first[:-1]], side[second[1:]] = number, -number
    rows: list[dict[int, float]] = [{} for _ in mesh.domain.periodic]
    for edge, chord in zip(chords.edges, chords.chord.tolist(), strict=True):
        a, b = edge[:2].tolist()
        start = a if after[a] == b else b if after[b] == a else -1
        if start >= 0 and side[start]:
            row = rows[abs(side[start]) - 1]
            row[chord] = row.get(chord, 0.0) + float(np.sign(side[start]))
    return [{chord: value for chord, value in row.items() if value} for row in rows]
