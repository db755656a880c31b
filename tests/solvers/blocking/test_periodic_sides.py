"""Grids of domains with periodic sides: nodes on both, lines across them, layers that touch them."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from periodic_domains import BOTH, HEIGHT, LENGTH, bank, circle, parallelogram

from meshonet import quality
from meshonet.formats.mesh.unstructured import unstructured
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.periodic import with_periodic_sides
from meshonet.geometry.domain.ring import ring_loop
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.quality.measure import count_folded
from meshonet.geometry.quality.walls import wall_rows
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.make import make_blocks
from meshonet.solvers.blocking.request import BlockRequest

LAYERS = {"first_cell": 2e-3, "walls": ("tube", "tubes"), "growth": 1.2}
TURNS = 0, 5, 25, 30, 50, 80, 90


def triangle(turn: float) -> Domain:
    """Return a box with a triangular hole: opposite sides are alike in some decompositions."""
    box = np.array([[0.0, 0.0], [1.6, 0.0], [1.6, 1.0], [0.0, 1.0]])
    hole = circle(0.6, 0.45, 0.3, turn, turn + 360.0, 3)[:-1]
    return Domain.of_polygons([box, hole], names=[["bottom", "right", "top", "left"], "tube"])


CASES = {
    "two pairs": (bank, BOTH, {}),
    "one pair": (bank, BOTH[:1], {}),
    "layers that touch sides": (bank, BOTH, LAYERS),
    "sheared": (parallelogram, BOTH, {}),
    "sheared, finer": (parallelogram, BOTH, {"cells": 9000}),
    "sheared, a family": (parallelogram, BOTH, {"cells": 600, "refine": 2}),
    "sheared, layers": (parallelogram, BOTH, {"first_cell": 1e-3}),
    **{f"a triangle at {turn} degrees": (partial(triangle, turn), BOTH, {"cells": 600}) for turn in TURNS},
    "nothing inside": (lambda: replace(parallelogram(), loops=parallelogram().loops[:1]), BOTH, {}),
}


def made(case):
    make, pairs, more = CASES[case]
    shape = DomainShape(make())
    return make_blocks(shape, BlockRequest(periodic=pairs, **{"cells": 2500, **more})).grid


@pytest.mark.parametrize("case", CASES)
def test_nodes_of_one_side_are_bitwise_those_of_the_other_moved(case):
    grid, pairs = made(case), CASES[case][1]
    assert sum(count_folded(block.nodes) for block in grid.blocks) == 0
    mesh = unstructured(grid)
    assert [(pair.name, pair.partner) for pair in mesh.periodic] == list(pairs)
    for pair in mesh.periodic:
        assert pair.motion.turn == ()
        own, other = (mesh.points[pair.nodes[:, k]] for k in (0, 1))
        np.testing.assert_array_equal(own + np.array(pair.motion.shift), other)
        assert len(pair.nodes) == len(pair.faces) + 1


def test_the_period_is_that_of_the_file():
    shifts = [pair.motion.shift for pair in unstructured(made("two pairs")).periodic]
    assert shifts == [(LENGTH, 0.0), (0.0, HEIGHT)]


def test_cells_on_both_sides_of_a_periodic_side_are_alike():
    mesh = unstructured(made("sheared"))
    z = mesh.points[mesh.cells]
    x, y = z[..., 0], z[..., 1]
    areas = 0.5 * (x * np.roll(y, -1, axis=1) - np.roll(x, -1, axis=1) * y).sum(axis=1)
    assert areas.sum() == pytest.approx(parallelogram().area, rel=1e-3)  # what one side gains the other loses
    for pair in mesh.periodic:
        ratio = areas[pair.own.cells] / areas[pair.opposite.cells]
        assert np.maximum(ratio, 1.0 / ratio).max() < 1.3


def test_first_cells_are_exact_where_layers_touch_periodic_sides():
    grid = made("layers that touch sides")
    rows = wall_rows(grid, [patch for patch in grid.patches if patch.name in LAYERS["walls"]])
    assert len(rows) == 2
    for row in rows:
        assert (row.height.min, row.height.max) == pytest.approx((2e-3, 2e-3), rel=1e-6)


def test_a_tube_cut_off_its_middle_has_as_many_cells_at_both_ends():
    """At 26 and 154 degrees one cell each: the line between them is a line of the whole tube."""
    box = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    reach = np.degrees(np.arccos(0.27 / 0.3))
    outer = np.concatenate([
        box[:2], [[2.0, 0.5 - 0.3 * np.sin(np.radians(reach))]],
        circle(2.27, 0.5, 0.3, 180.0 + reach, 180.0 - reach, 24)[1:-1],
        [[2.0, 0.5 + 0.3 * np.sin(np.radians(reach))]], box[2:],
        [[0.0, 0.5 + 0.3 * np.sin(np.radians(reach))]],
        circle(0.27, 0.5, 0.3, 180.0 - reach, -180.0 + reach, 60)[1:-1],
        [[0.0, 0.5 - 0.3 * np.sin(np.radians(reach))]],
    ])  # fmt: skip
    names = ["bottom", "right", "tubes", "right", "top", "left", "tubes", "left"]
    corners = [0, 1, 2, 26, 27, 28, 29, 29 + 60]
    domain = Domain((ring_loop(outer, hole=False, corners=corners, names=names),))
    loop = with_periodic_sides(domain, BOTH[:1]).loops[0]
    assert loop.corner_cells.tolist() == [1] * 8
    assert (domain.loops[0].corner_cells == 2).any()


@pytest.mark.parametrize(
    ("pairs", "message"),
    [
        (
            (("left", "tube"),),
            "there is no side 'tube' to be periodic; use sides of the outer boundary: bottom",
        ),
        ((("left", "right"), ("left", "top")), "side 'left' is periodic twice"),
        ((("left", "bottom"),), "sides 'left' and 'bottom' differ by 1.7, 0.81 of the extent"),
    ],
)
def test_sides_that_are_no_pair_are_refused(pairs, message):
    with pytest.raises(InputError, match=message):
        with_periodic_sides(parallelogram(), pairs)


def test_the_distance_between_sides_is_said_and_a_millionth_of_the_extent_allowed():
    box = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0 + 1e-3], [0.0, 1.0]])
    domain = Domain.of_polygons([box], names=[["bottom", "right", "top", "left"]])
    with pytest.raises(
        InputError, match=r"differ by 0\.001, 0\.0005 of the extent; make one a translated copy"
    ):
        with_periodic_sides(domain, BOTH[:1])
    box[2, 1] = 1.0 + 1e-6
    (pair,) = with_periodic_sides(
        Domain.of_polygons([box], names=[["bottom", "right", "top", "left"]]), (("right", "left"),)
    ).periodic
    assert pair.shift == (-2.0, 0.0) or pair.shift[0] == -2.0


def test_layers_at_one_of_two_periodic_ends_are_refused():
    domain = bank()
    loop = domain.loops[0]
    names = tuple("upper" if k == 3 else name for k, name in enumerate(loop.names))
    other = replace(domain, loops=(replace(loop, names=names), *domain.loops[1:]))
    request = BlockRequest(cells=4000, periodic=BOTH, first_cell=2e-3, walls=("upper",))
    with pytest.raises((InputError, SolverError), match="periodic sides"):
        make_blocks(DomainShape(other), request)


@pytest.mark.parametrize("cells", [4000, 8000])
def test_layers_grow_no_faster_across_periodic_sides(cells):
    """Across the sides that a row of unlike cylinders is cut at, neighbours differed by 1.4 to 1.8."""
    box = np.array([[0.0, 0.0], [12.0, 0.0], [12.0, 4.0], [0.0, 4.0]])
    tubes = [circle(*tube)[:-1] for tube in ((2.5, 2.0, 0.5), (6.5, 1.5, 0.4), (9.5, 2.4, 0.3))]
    names = [["lower", "outlet", "upper", "inlet"], "a", "b", "c"]
    shape = DomainShape(Domain.of_polygons([box, *tubes], "row", names))
    layers = {"first_cell": 0.01, "walls": ("a", "b", "c"), "growth": 1.2}
    request = BlockRequest(periodic=(("lower", "upper"),), cells=cells, **layers)
    figures = quality(make_blocks(shape, request).grid).figures
    assert figures("wall_growth").value < 1.2 * (1.0 + 1e-6)
    assert figures("growth").value < 1.25
