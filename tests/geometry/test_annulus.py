"""A body in a far field that the input draws: both curves are met, corners and all."""

import numpy as np
import pytest

from meshonet.geometry.curves.curve import Curve
from meshonet.geometry.errors import InputError
from meshonet.geometry.shapes.annulus import Annulus
from meshonet.geometry.shapes.outline import Outline
from meshonet.geometry.spacing.sampling import Sampling

T = np.linspace(0, -2 * np.pi, 80, endpoint=False)
DISC = Outline(0.4 * np.stack([np.cos(T), np.sin(T)], axis=1))
SQUARE = 2.0 * np.array([[-1.0, -1], [-1, 1], [1, 1], [1, -1]])


@pytest.mark.parametrize("ni", [33, 50, 64])
def test_corners_of_the_far_field_are_nodes(ni: int) -> None:
    result = Annulus(DISC, Curve(SQUARE, closed=True)).boundary(Sampling(ni, 9))
    for corner in SQUARE:
        assert np.hypot(*(result.north - corner).T).min() < 1e-12
    assert np.abs(result.north).max(axis=1) == pytest.approx(2.0, abs=1e-12)
    np.testing.assert_array_equal(result.north[0], result.north[-1])


def test_a_far_field_begins_where_its_body_does_wherever_both_are() -> None:
    place = np.array([7.0, -3.0])
    here = Annulus(DISC, Curve(SQUARE, closed=True)).boundary(Sampling(33, 9))
    there = Annulus(Outline(DISC.curve.points + place), Curve(SQUARE + place, closed=True)).boundary(
        Sampling(33, 9)
    )
    np.testing.assert_allclose(there.north, here.north + place, atol=1e-12)
    off = here.north[0] / np.hypot(*here.north[0]) - here.south[0] / np.hypot(*here.south[0])
    np.testing.assert_allclose(off, 0.0, atol=2e-3)


def test_fewer_nodes_than_corners_are_refused() -> None:
    star = np.stack([(2.0 + np.cos(20 * T)) * np.cos(T), (2.0 + np.cos(20 * T)) * np.sin(T)], axis=1)
    outer = Curve(star, closed=True, corners=np.arange(0, 80, 4))
    with pytest.raises(InputError, match="corners do not fit on 9 nodes"):
        Annulus(DISC, outer).boundary(Sampling(9, 9))
