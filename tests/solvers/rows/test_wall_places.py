"""Places of nodes around a blade: steps grow by a limited ratio at the wall, on both sides alike if asked."""

import blade_row
import numpy as np
import pytest

from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.wall_places import even_wall_places

GROWTH = 1.2


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
    made = even_wall_places(planes, places, np.empty(0), GROWTH, opposite=opposite)
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
    made = even_wall_places([plane], places, np.array([corner]), GROWTH, opposite=False)
    assert made[33] == corner
