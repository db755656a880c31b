"""How far away the outer boundary of a marched grid is: never nearer than asked for, and hardly farther."""

import numpy as np
import pytest

import meshonet
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.report import quality_report


def distance(grid: Grid) -> float:
    """Return the least distance of the outer nodes from the middle of the wall, in chords."""
    wall = next(patch for patch in grid.patches if patch.kind == "wall")
    nodes = grid.nodes[wall.start : wall.stop + 1, 0]
    middle = 0.5 * (nodes.min(axis=0) + nodes.max(axis=0))
    chord = np.hypot(*(nodes - nodes[0]).T).max()
    return float(np.hypot(*(grid.nodes[:, -1] - middle).T).min() / chord)


@pytest.mark.parametrize("far_field", [5.0, 20.0, 100.0, 500.0])
@pytest.mark.parametrize("topology", ["o", "c"])
@pytest.mark.parametrize("name", ["0012-sharp", "4424", "0006"])
@pytest.mark.parametrize("res", [(200, 100), (120, 60), (400, 150)])
def test_the_outer_boundary_is_as_far_away_as_asked_for(
    name: str, topology: str, far_field: float, res: tuple[int, int]
) -> None:
    te = "wedge" if topology == "c" else "auto"
    grid = meshonet.grid(
        f"naca:{name}", te=te, topology=topology, far_field=far_field, res=res, y_plus=1, reynolds=3e6
    )
    assert 1.0 <= distance(grid) / far_field < 1.03


@pytest.mark.parametrize("name", ["0012-sharp", "0012", "4424", "23012"])
@pytest.mark.parametrize("more", [{}, {"te": "wedge", "topology": "c"}, {"te": "round"}])
def test_a_far_field_of_100_chords_meets_the_profile_of_viscous_grids(
    name: str, more: dict[str, str]
) -> None:
    if name == "0012-sharp" and more.get("te") == "round":
        pytest.skip("there is no base to round")
    grid = meshonet.grid(f"naca:{name}", far_field=100, y_plus=1, reynolds=3e6, **more)
    report = quality_report(grid, "viscous").profile
    assert report is not None
    assert {result.check.figure: result.verdict for result in report.results}["far_field"] == "pass"
