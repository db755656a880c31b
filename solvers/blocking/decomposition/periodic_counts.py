"""Counts of cells along chords with as many cells on both of two periodic sides."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from meshonet.geometry.arrays import Indices
from meshonet.geometry.domain.periodic import Periodic
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.periodic_sides import following, sides_of
from meshonet.solvers.blocking.decomposition.errors import BlockingError
from meshonet.solvers.blocking.decomposition.quads.arc_counts import Row, nearest_whole
from meshonet.solvers.blocking.sizes.chords import Chords


def counts_along_sides(
    chords: Chords, counts: Indices, least: Indices, fixed: Mapping[int, int] = MappingProxyType({})
) -> Indices:
    """Return the counts (chords,) nearest to `counts` with as many cells on both sides of every pair.

    They are at least `least` (chords,), and those of chords `fixed` are as given.
    Raises BlockingError: there are none.
    """
    rows = rows_of(chords)
    if not rows:
        return counts
    rows += [({chord: 1.0}, float(count), float(count)) for chord, count in fixed.items()]
    least = least.copy()
    least[list(fixed)] = list(fixed.values())
    try:
        return nearest_whole(counts.astype(np.float64), least.astype(np.float64), rows)
    except BlockingError:
        raise BlockingError(_unmatched(chords.layout.mesh.domain.periodic[0])) from None


def check_sides(layout: Layout) -> None:
    """Raise BlockingError if no counts are equal on periodic sides, or blocks extend past their ends."""
    mesh = layout.mesh
    if not mesh.domain.periodic:
        return
    for each, first, second in sides_of(mesh):
        ends = np.array([first[0], first[-1], second[0], second[-1]])
        if (mesh.valence[ends] != mesh.places.cells[ends]).any():
            raise BlockingError(_unmatched(each))
    chords = Chords.of(layout)
    counts_along_sides(chords, chords.counts, chords.least)


def _unmatched(sides: Periodic) -> str:
    return (
        f"blocks along periodic sides {sides.names[0]!r} and {sides.names[1]!r} cannot be matched; cut the "
        "domain where its sides meet walls at about 90 degrees"
    )


def alike_along_sides(chords: Chords, counts: Indices) -> bool:
    """Return whether `counts` (chords,) are as many cells on both sides of every pair."""
    return all(
        sum(value * counts[chord] for chord, value in row.items()) == 0.0 for row, _, _ in rows_of(chords)
    )


def rows_of(chords: Chords) -> list[Row]:
    """Return coefficients of chords whose sums are to be zero, for pairs of sides that may differ."""
    return [(row, 0.0, 0.0) for row in _differences(chords) if row]


def lacking_side(layout: Layout) -> Indices | None:
    """Return the nodes along a periodic side with fewer cells than the other whatever the counts, or None."""
    if not layout.mesh.domain.periodic:
        return None
    for row, (_, first, second) in zip(_differences(Chords.of(layout)), sides_of(layout.mesh), strict=True):
        signs = set(np.sign(list(row.values())).tolist())
        if len(signs) == 1:
            return second if signs == {1.0} else first
    return None


def _differences(chords: Chords) -> list[dict[int, float]]:
    """Return for each pair of sides how much oftener a chord ends on the first than on the second."""
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
