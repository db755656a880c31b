"""Edges that cross or touch are refused with the place, for every topology; others pass."""

import numpy as np
import pytest

from meshonet.geometry.blocks.boundary import Boundary
from meshonet.geometry.blocks.validate import check_edges
from meshonet.geometry.errors import InputError
from meshonet.geometry.families.family import family as family_of
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.shapes.shape import edges_of
from meshonet.geometry.spacing.sampling import Sampling

X, Y = np.linspace(0.0, 2.0, 21), np.linspace(0.0, 1.0, 11)


def channel(floor=0.0, ceiling=1.0, y=Y):
    """A channel 2 long; `floor` and `ceiling` are heights (21,) or numbers."""
    south, north = (np.stack([X, np.broadcast_to(h, X.shape)], axis=1) for h in (floor, ceiling))
    west, east = (np.stack([np.full_like(y, x), y], axis=1) for x in (0.0, 2.0))
    return south, north, west, east


def ring(radius, centre=(0.0, 0.0), n=33):
    """A circle, clockwise, the first node repeated."""
    turn = -np.linspace(0, 2 * np.pi, n)
    nodes = np.array(centre) + radius * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    nodes[-1] = nodes[0]
    return nodes


def around(body, far):
    """The O boundary of two rings."""
    cut = np.linspace(body[0], far[0], 9)
    return Boundary(body, far, cut, cut, "o")


def bump(height):
    """A floor whose middle node is that high."""
    floor = np.zeros(21)
    floor[10] = height
    return floor


@pytest.mark.parametrize("floor", [0.0, bump(0.9), bump(-3.0)])
def test_edges_that_keep_apart_pass(floor):
    check_edges(Boundary(*channel(floor)))


@pytest.mark.parametrize("height", [1.0, 1.5])
def test_opposite_sides_that_touch_or_cross_are_named_with_the_place(height):
    with pytest.raises(
        InputError, match=r"south and north cross at \(.*, 1\), behind node 9 of south"
    ) as message:
        check_edges(Boundary(*channel(bump(height))))
    x = float(str(message.value).split("(")[1].split(",")[0])
    assert x == pytest.approx(1.0 - 0.1 * (1.0 - 1.0 / height))


def test_a_side_that_crosses_itself_is_named_with_its_nodes():
    south, north, west, east = channel()
    south[8:12] = [[1.0, 0.2], [1.2, 0.1], [0.9, 0.1], [1.1, 0.2]]
    with pytest.raises(InputError, match=r"south crosses itself at .*, behind its nodes 8 and 10"):
        check_edges(Boundary(south, north, west, east))


def test_neighbours_that_cross_away_from_their_corner_are_refused():
    south, north, west, east = channel()
    west[3:6, 0] = 0.05
    west[4, 1] = -0.2
    with pytest.raises(InputError, match="south and west cross"):
        check_edges(Boundary(south, north, west, east))


def test_an_outline_that_crosses_so_much_that_it_seems_clockwise_is_told_as_crossing():
    with pytest.raises(InputError, match="south and north cross"):
        Boundary(*channel(np.where((X > 0) & (X < 2), 4.0, 0.0)))


def test_a_cut_that_is_both_west_and_east_does_not_cross():
    far, body = ring(2.0), ring(1.0)
    cut = np.linspace(body[0], far[0], 9)
    turned = [side[::-1] for side in (body, far)]  # as a quad: counter-clockwise outside, closed by the cut
    check_edges(Boundary(turned[1], turned[0], cut[::-1], cut[::-1], "quad"))


@pytest.mark.parametrize("centre", [(0.0, 0.0), (0.6, 0.2)])
def test_a_body_inside_its_far_field_passes_wherever_the_cut_lies(centre):
    check_edges(around(np.roll(ring(0.3, centre)[:-1], 7, axis=0)[[*range(32), 0]], ring(1.0)))


def test_a_body_through_its_far_field_is_refused():
    with pytest.raises(InputError, match=r"south and north cross at \(0\.9"):
        check_edges(around(ring(0.3, (0.9, 0.1)), ring(1.0)))


def test_a_body_outside_its_far_field_is_refused_with_its_place():
    with pytest.raises(InputError, match=r"the body, at \(4.3, 0\), lies outside its far field"):
        check_edges(around(ring(0.3, (4.0, 0.0)), ring(1.0)))


@pytest.mark.parametrize(("side", "radii"), [("south", (0.3, 1.0)), ("north", (1.0, 0.3))])
def test_a_tangled_ring_is_refused(side, radii):
    tangled, other = ring(radii[0]), ring(radii[1])
    tangled[[20, 22]] = tangled[[22, 20]]
    body, far = (tangled, other) if side == "south" else (other, tangled)
    with pytest.raises(InputError, match=f"{side} crosses itself"):
        check_edges(around(body, far))


def test_c_boundaries_meet_themselves_along_the_wake_and_nowhere_else():
    result = naca("2412").boundary(Sampling(101, 31, "c"))
    check_edges(result)
    north = result.north.copy()
    north[50] = [0.9, 0.0]  # through the airfoil
    with pytest.raises(InputError, match="south and north cross"):
        check_edges(Boundary(result.south, north, result.west, result.east, "c", result.patches))


@pytest.mark.parametrize("family", [family_of("arch"), family_of("hole")])
def test_the_families_pass(family):
    check_edges(family.boundary((family.low + family.high) / 2, 41, 31))


def test_given_edges_are_told_of_by_their_own_nodes_whatever_resolution_is_asked_for():
    with pytest.raises(InputError, match="behind node 9 of south"):
        edges_of(Boundary(*channel(bump(1.5))), Sampling(81, 41))


@pytest.mark.parametrize("unit", [1e-200, 1e200])
def test_units_beyond_arithmetic_are_told_as_such(unit):
    with pytest.raises(InputError, match=r"an extent of 2.*unit that suits the shape"):
        Boundary(*(side * unit for side in channel()))
