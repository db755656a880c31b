"""Refusals of rows say at which part of the span, and where along the blade."""

import blade_row
import numpy as np
import pytest

from meshonet.geometry.errors import InputError, NoValidGridError
from meshonet.geometry.layout.quad_mesh import Places, QuadMesh
from meshonet.geometry.rows.row import Row
from meshonet.solvers.pipeline.rows import make_row
from meshonet.solvers.rows.middle_section import folded_section
from meshonet.solvers.rows.request import RowRequest
from meshonet.solvers.rows.section_plane import SectionPlane


@pytest.mark.parametrize(
    ("share", "words"),
    [
        (-0.5, "before the blades"),
        (0.05, "at the leading edge"),
        (0.4, "between the blades, 40 % of the way along them"),
        (0.95, "at the trailing edge"),
        (1.5, "behind the blades"),
    ],
)
def test_a_folded_section_is_refused_with_the_place_of_its_worst_cell(share: float, words: str) -> None:
    plane = SectionPlane.of(blade_row.blade_row(), 0.25, 1e-3, 1.2)
    centre = np.array([plane.stations(np.array([share]))[0], 0.3])
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    nodes = np.concatenate([square, centre + 1e-3 * square[::-1]])  # the second cell is turned over
    quads = np.arange(8).reshape(2, 4)
    error = folded_section(plane, QuadMesh(None, nodes, quads, Places.inside(8)))
    assert str(error).startswith(f"cells stay folded in the section at 25 % of the span, {words}; use more")


def notched(profile: np.ndarray) -> np.ndarray:
    """The profile with a point of one side near the other side."""
    points, k = profile.copy(), len(profile) // 4
    points[k] += 0.6 * (points[-k] - points[k])
    return points


def test_profiles_that_leave_no_room_for_layers_are_refused_with_their_part_of_the_span() -> None:
    profiles = [notched(each) for each in blade_row.profiles()]
    row = Row(profiles, blade_row.HUB, blade_row.SHROUD, blade_row.BLADES)
    with pytest.raises(InputError, match=r"section at .* % of the span, in m' and theta: blade, \("):
        make_row(row, RowRequest(threads=1))


def test_nodes_without_places_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """As where profiles lie so far beside each other that lines off the blade have no length."""
    monkeypatch.setattr(
        "meshonet.solvers.rows.row_grid.turned_by", lambda pitch: lambda nodes: nodes * np.nan
    )
    with pytest.raises(
        NoValidGridError, match=r"lines off the blade have no length.*; give profiles of one blade"
    ):
        make_row(blade_row.blade_row(), RowRequest(threads=1, cells=20_000, first_cell=0.01, growth=1.8))
