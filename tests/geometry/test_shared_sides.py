"""Sides of blocks that share nodes of one table."""

import numpy as np

from meshonet.geometry.layout.shared_sides import shared, shared_in_part


def test_a_side_that_meets_itself_is_joined_from_its_ends() -> None:
    line = (0, "south", np.array([3, 2, 1, 7, 8, 1, 2, 3]))
    (joined,), alone = shared_in_part([line])
    assert (joined.range, joined.donor_range, joined.orientation) == (((0, 2),), ((5, 7),), (-1,))
    assert [(nodes.tolist(), start) for (_, _, nodes), start in alone] == [([1, 7, 8, 1], 2)]


def test_rings_that_begin_elsewhere_are_joined_in_two_parts() -> None:
    one, other = (0, "south", np.array([0, 1, 2, 3, 4, 0])), (1, "south", np.array([2, 3, 4, 0, 1, 2]))
    assert not shared([one, other])[0]
    joined, alone = shared_in_part([one, other])
    assert [(each.range, each.donor_range, each.orientation) for each in joined] == [
        (((0, 2),), ((3, 5),), (1,)),
        (((2, 5),), ((0, 3),), (1,)),
    ]
    assert not alone
