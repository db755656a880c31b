"""Places of nodes around a blade: steps grow by a limited ratio at the wall, on both sides alike if asked."""

import blade_row
import numpy as np
import pytest
import radial_rows

from meshonet.solvers.rows.across import ChannelLines
from meshonet.solvers.rows.opposite import opposite_places
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.wall_places import even_wall_places

GROWTH = 1.2
NO_PAIRS = np.empty((0, 2), dtype=np.intp)


def steps(plane: SectionPlane, places: np.ndarray) -> np.ndarray:
    """Lengths of the wall between places that go once around."""
    arcs = plane.wall_arcs(places)
    return np.mod(np.diff(np.append(arcs, arcs[0])), plane.cascade.blade.length)


@pytest.mark.parametrize("opposite", [False, True])
def test_uneven_places_become_even_in_all_sections(opposite: bool) -> None:
    row = blade_row.blade_row()
    planes = [SectionPlane.of(row, height, 1e-3, GROWTH) for height in (0.0, 1.0)]
    side = 0.25 * (1.0 - np.cos(np.pi * np.arange(40) / 40))
    side[10:20] += 0.004  # a long step beside a short one
    places = np.roll(np.concatenate([side, 1.0 - np.append(0.5, side[:0:-1])]), 7)
    made = even_wall_places(
        planes, places, np.empty(0), GROWTH, NO_PAIRS, ChannelLines.of(planes), opposite=opposite
    )
    for plane in planes:
        own = steps(plane, made)
        growth = np.exp(np.abs(np.log(np.append(own[1:], own[0]) / own)))
        assert growth.max() < 1.25
        before = steps(plane, places)
        assert np.exp(np.abs(np.log(before[1:] / before[:-1]))).max() > 1.3
    if opposite:
        other = np.sort(np.mod(1.0 - made, 1.0))
        assert np.sort(np.mod(made, 1.0)) == pytest.approx(other, abs=1e-12)


def test_corners_stay_where_they_are() -> None:
    row = blade_row.blade_row()
    plane = SectionPlane.of(row, 0.5, 1e-3, GROWTH)
    places = np.linspace(0.0, 1.0, 80, endpoint=False) ** 1.2
    corner = places[33]
    lines = ChannelLines.of([plane])
    made = even_wall_places([plane], places, np.array([corner]), GROWTH, NO_PAIRS, lines, opposite=False)
    assert made[33] == corner


def leaning(plane: SectionPlane, places: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Cosines of the angles between lines across the channel and the wall from which they start."""
    front = plane.cascade.ring.front
    one, other = (front.at(plane.front_arcs(places[pairs[:, k]])) for k in (0, 1))
    line = other + np.array([0.0, plane.cascade.pitch[1]]) - one
    along = np.gradient(one, axis=0)
    return (line * along).sum(axis=1) / np.hypot(*line.T) / np.hypot(*along.T)


def test_lines_across_a_channel_keep_their_direction() -> None:
    """Few nodes at both edges draw others to them, on the two sides of a staggered channel opposite ways."""
    row = radial_rows.impeller(4, gap=False)
    plane = SectionPlane.of(row, 0.5, 1e-3 * row.chord, GROWTH)
    count, nose = 40, 6
    upper, lower = np.linspace(0.01, 0.41, count), 1.0 - np.linspace(0.09, 0.49, count)
    ends = np.linspace(0.41, 0.51, nose + 2)[1:-1], np.linspace(0.91, 1.01, nose + 2)[1:-1]
    places = np.mod(np.concatenate([upper, ends[0], lower[::-1], ends[1]]), 1.0)
    pairs = np.stack([np.arange(count), 2 * count + nose - 1 - np.arange(count)], axis=1)
    given, lines = leaning(plane, places, pairs), ChannelLines.of([plane])
    kept, free = (
        np.abs(leaning(plane, made, pairs) - given).mean()
        for made in (
            even_wall_places([plane], places, np.empty(0), GROWTH, each, lines, opposite=False)
            for each in (pairs, NO_PAIRS)
        )
    )
    assert kept < 0.3 * free
    assert free > 0.02


def test_opposite_places_let_lines_across_a_channel_lean_least() -> None:
    """Of the nodes around the nose the one is at the leading edge from which on lines lean least."""
    row = radial_rows.impeller(4, gap=False)
    lines = ChannelLines.of([SectionPlane.of(row, 1.0, 1e-3 * row.chord, GROWTH)])
    count, nose = 40, 12
    side = np.linspace(0.0, 0.5, count + nose + 1)
    around = np.concatenate([side, 1.0 - side[-2:0:-1]])
    pairs = np.stack([nose + np.arange(count + 1), 2 * (count + nose) - np.arange(count + 1)], axis=1)
    pairs[:, 1] %= len(around)
    made = opposite_places(around, pairs, lines)
    assert np.sort(np.mod(-made, 1.0)) == pytest.approx(np.sort(made), abs=1e-12)
    tried = [lines.leaning(np.roll(around, k), pairs) for k in range(nose + 1)]
    assert lines.leaning(made, pairs) == pytest.approx(min(tried))
    assert min(tried) < 0.2 * max(tried)
