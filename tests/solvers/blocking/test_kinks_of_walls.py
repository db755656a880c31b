"""Kinks of walls between straight parts: a multi-block grid with layers has a node at each."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.domain.kinks import with_kinks
from meshonet.geometry.domain.loop import Loop
from meshonet.geometry.shapes.domain_shape import DomainShape
from meshonet.solvers.blocking.make import make_blocks
from meshonet.solvers.blocking.request import BlockRequest

KINKS = np.array([[0.1, 0.025], [0.1675, 0.0125], [0.1925, 0.0125], [0.2875, 0.025]])
"""Of a Venturi tube: a cone of 10.5 degrees, the throat, a diffuser of 7.5 degrees."""
WALL = np.concatenate([[[0.0, 0.025]], KINKS, [[0.4375, 0.025]]])
NAMES = ("axis", "outlet", "wall", "inlet")


def venturi(parts):
    """Return the tube above its axis, each straight part of the wall divided into so many edges."""
    share = np.arange(parts)[:, None] / parts
    dense = [a + share * (b - a) for a, b in pairwise(WALL)]
    wall = np.concatenate([*dense, WALL[-1:]])[::-1]
    points = np.concatenate([[[0.0, 0.0], [0.4375, 0.0]], wall])
    return Domain((Loop.of_polygon(points, (0, 1, 2, len(points) - 1), NAMES),))


@pytest.mark.parametrize("parts", [1, 20])
def test_grids_with_layers_have_a_node_at_each_kink_of_a_wall(parts):
    request = BlockRequest(cells=4000, first_cell=2e-5, walls=("wall",))
    grid = make_blocks(DomainShape(venturi(parts)), request).grid
    nodes = np.concatenate([block.nodes.reshape(-1, 2) for block in grid.blocks])
    for kink in KINKS:
        assert np.hypot(*(nodes - kink).T).min() < 1e-12
    assert {patch.name for patch in grid.patches} == set(NAMES)


def test_points_of_curves_are_no_kinks():
    turn = np.radians(np.arange(0.0, 90.1, 7.5))
    arc = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    loop = Loop.of_polygon(np.concatenate([[[0.0, 0.0]], arc]), None, ("a", "b", "c"))
    assert with_kinks(Domain((loop,))).loops == (loop,)


def test_kinks_close_to_a_corner_leave_cells_their_lengths():
    points = np.array([[0.0, 0.0], [0.4375, 0.0], [0.4375, 0.025], [0.435, 0.0248], [0.0, 0.025]])
    loop = Loop.of_polygon(points, (0, 1, 2, 4), NAMES)
    assert with_kinks(Domain((loop,))).loops == (loop,)


def test_numbers_of_cells_at_corners_are_kept_beside_kinks():
    domain = venturi(20)
    loop = replace(domain.loops[0], cells=(1, 1, 1, 1))
    (kinked,) = with_kinks(Domain((loop,))).loops
    assert sorted(kinked.cells) == [1, 1, 1, 1, 2, 2, 2, 2]
