"""C grids without a first cell: what the march takes by itself, and when it steps aside."""

from dataclasses import replace

import numpy as np
import pytest

from meshonet.geometry.quality.measure import count_folded, measure
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.hyperbolic.default_spacing import GROWTH, MOST, PART, first_cell, march_by_default
from meshonet.solvers.pipeline.automatic import elliptic, fewer_on_quads
from meshonet.solvers.pipeline.named import method_named


@pytest.mark.parametrize(("section", "te"), [("0012", "wedge"), ("4415", "wedge"), ("23012", "wedge")])
@pytest.mark.parametrize("res", [(100, 100), (160, 60), (200, 40)])
def test_grids_are_valid_nearly_square_and_grow_slowly(section: str, te: str, res: tuple[int, int]) -> None:
    boundary = naca(section).boundary(Sampling(*res, "c", te=te))  # type: ignore[arg-type]
    result = march_by_default(boundary)
    assert result is not None
    nodes = result.grid.nodes
    assert count_folded(nodes) == 0
    angle = measure(result.grid)["max_angle"]
    assert angle.max < 125
    assert angle.mean < 94
    np.testing.assert_array_equal(nodes[:, 0], boundary.south)
    behind = boundary.wake
    wall = nodes[behind : len(nodes) - behind]
    heights = np.hypot(*np.diff(wall, axis=1).T).T
    np.testing.assert_allclose(heights[:, 0], first_cell(boundary), rtol=1e-7)
    assert (heights[:, 1:] / heights[:, :-1]).max() < 1.32


def test_first_cells_are_a_part_of_the_smallest_and_larger_with_few_rows() -> None:
    def over_the_smallest(nj: int) -> float:
        boundary = naca("2412").boundary(Sampling(160, nj, "c"))
        behind = boundary.wake
        wall = boundary.south[behind : boundary.ni - behind]
        return first_cell(boundary) / np.hypot(*np.diff(wall, axis=0).T).min()

    assert over_the_smallest(100) == pytest.approx(PART)
    assert PART < over_the_smallest(52) < over_the_smallest(48) < MOST
    assert over_the_smallest(40) == pytest.approx(MOST)
    boundary = naca("2412").boundary(Sampling(160, 48, "c"))
    rows = first_cell(boundary) * GROWTH ** np.arange(47)
    assert rows.sum() == pytest.approx(np.hypot(*(boundary.west[-1] - boundary.west[0])))


def test_given_far_fields_and_very_few_rows_are_left_to_the_variational_method() -> None:
    boundary = naca("0012").boundary(Sampling(100, 50, "c"))
    given = replace(boundary, wall=None)
    few = naca("0012").boundary(Sampling(100, 30, "c"))
    for one in given, few:
        assert march_by_default(one) is None
        result = elliptic().solve([one])[0]
        assert result.method == "variational"
        np.testing.assert_array_equal(result.grid.nodes[:, -1], one.north)
    assert elliptic().solve([boundary])[0].method == "hyperbolic"
    assert fewer_on_quads(method_named("winslow")).solve([boundary])[0].method == "winslow"
