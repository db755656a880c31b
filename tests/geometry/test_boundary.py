"""Sensors: boundary nodes at fixed places of the computational domain."""

import numpy as np
import pytest

from meshonet.geometry.errors import InputError
from meshonet.geometry.families.family import family
from meshonet.geometry.shapes.airfoil.naca import naca
from meshonet.geometry.spacing.sampling import Sampling


def test_around_a_quad_they_start_at_the_south_west_corner_and_run_counter_clockwise() -> None:
    edges = family("arch").boundary(0.2, 11, 11)
    sensors = edges.with_sensors(8).sensors
    assert sensors is not None
    np.testing.assert_array_equal(
        sensors[::2], [edges.south[0], edges.south[-1], edges.north[-1], edges.north[0]]
    )
    np.testing.assert_array_equal(sensors[1], edges.south[5])


def test_of_an_o_half_are_on_the_body_and_half_on_the_far_field() -> None:
    edges = naca("0012").boundary(Sampling(ni=41, nj=9))
    sensors = edges.with_sensors(9).sensors
    assert sensors is not None
    np.testing.assert_array_equal(sensors[:5], edges.south[[0, 8, 16, 24, 32]])
    np.testing.assert_array_equal(sensors[5:], edges.north[[0, 10, 20, 30]])


@pytest.mark.parametrize("count", [1, 41])
def test_counts_that_cannot_be_are_refused(count: int) -> None:
    with pytest.raises(InputError, match=f"{count} sensors; use 2 to 40, the number of boundary nodes"):
        family("arch").boundary(0.2, 11, 11).with_sensors(count)


def test_another_resolution_forgets_them() -> None:
    edges = family("arch").boundary(0.2, 11, 11).with_sensors(8)
    assert edges.boundary(Sampling(ni=21, nj=11)).sensors is None
