"""A layout carried over to other shapes of the same kind."""

import numpy as np
import pytest
from domains import STEP, STEP_NAMES, circle, ring_layout, step_domain, step_layout

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.to_grid import to_grid
from meshonet.geometry.quality.measure import measure
from meshonet.solvers.blocking.decomposition.reuse import carried_over


def folded(layout: object) -> int:
    return measure(to_grid(layout)).folded  # type: ignore[arg-type]


def test_an_affine_image_of_the_domain_has_the_affine_image_of_the_nodes() -> None:
    layout = step_layout()
    turn = np.array([[0.8, 0.6], [-0.6, 0.8]]) * 3.0
    carried = carried_over(layout, step_domain(STEP @ turn + [5.0, -7.0]))
    np.testing.assert_allclose(carried.mesh.nodes, layout.mesh.nodes @ turn + [5.0, -7.0], atol=1e-6)
    assert np.array_equal(carried.mesh.places.cells, layout.mesh.places.cells)


def test_nodes_stay_where_they_are_in_the_same_domain_whichever_point_it_starts_from() -> None:
    layout = step_layout()
    for start in range(6):
        names = tuple(np.roll(STEP_NAMES, -start).tolist())
        loop = Loop.of_polygon(np.roll(STEP, -start, axis=0), tuple(range(6)), names)
        carried = carried_over(layout, Domain((loop,)))
        np.testing.assert_allclose(carried.mesh.nodes, layout.mesh.nodes, atol=1e-6)
        unnamed = Loop.of_polygon(np.roll(STEP, -start, axis=0), tuple(range(6)))
        np.testing.assert_allclose(
            carried_over(layout, Domain((unnamed,))).mesh.nodes, layout.mesh.nodes, atol=1e-6
        )


def test_a_higher_step_is_the_same_topology_without_folds() -> None:
    higher = STEP.copy()
    higher[[0, 1], 1] = 1.4
    higher[[4, 5], 1] = [2.4, 2.2]
    higher[1, 0], higher[2, 0] = 2.5, 2.3
    carried = carried_over(step_layout(), step_domain(higher))
    assert folded(carried) == 0
    points = carried.mesh.nodes[carried.mesh.places.cells > 0]
    assert {tuple(point) for point in points.tolist()} == {tuple(point) for point in higher.tolist()}
    on = carried.mesh.places.loop == 0
    assert distance(carried.mesh.nodes[on], higher) < 1e-12, "wall nodes are on the wall"


def test_a_loop_without_corners_turns_with_its_box() -> None:
    layout = ring_layout(cuts=3)
    ellipses = [circle(0, 0, 3, 300) * [2, 1], circle(0, 0, 1, 200)[::-1] * [2, 1] + [0.5, 0.2]]
    carried = carried_over(layout, Domain.of_polygons([np.roll(ellipses[0], 77, axis=0), ellipses[1]]))
    assert folded(carried) == 0
    off = np.hypot(*(carried.mesh.nodes - layout.mesh.nodes * [2, 1]).T)
    assert off.max() < 1.0


@pytest.mark.parametrize(
    ("polygons", "message"),
    [
        ([STEP, circle(4, 1, 0.3)], "the layout is of a domain with 0 holes, this one has 1 hole; give a"),
        ([STEP[[0, 2, 3, 4, 5]]], r"loop 0 \(outer\) has 4 corners, in the layout it has 6; give a"),
    ],
)
def test_a_domain_of_another_kind_is_refused_with_what_differs(polygons: list[Floats], message: str) -> None:
    with pytest.raises(InputError, match=message):
        carried_over(step_layout(), Domain.of_polygons(polygons))


def test_holes_belong_together_by_name() -> None:
    ring = ring_layout()
    loops = ring.mesh.domain.loops
    other = Domain((loops[0], Loop.of_polygon(loops[1].curve.points, (), ("body",))))
    assert folded(carried_over(ring, other)) == 0


def distance(points: Floats, polygon: Floats) -> float:
    """Largest distance of points from the sides of a polygon."""
    start, along = polygon, np.roll(polygon, -1, axis=0) - polygon
    off = points[:, None] - start
    t = np.clip((off * along).sum(-1) / (along**2).sum(-1), 0, 1)
    return float(np.hypot(*np.moveaxis(off - t[..., None] * along, -1, 0)).min(axis=1).max())
