"""Nodes of lines at other arc lengths."""

import numpy as np
import pytest

from meshonet.geometry.curves.cubic import sampled


@pytest.mark.parametrize("dimensions", [2, 3])
def test_lines_that_are_quadratic_in_their_parameter_are_met_anywhere(dimensions: int) -> None:
    rng = np.random.default_rng(5)
    arcs = np.cumsum(rng.uniform(0.2, 1.0, (7, 9)), axis=1)
    arcs -= arcs[:, :1]
    at = np.sort(rng.uniform(0.0, 1.0, (7, 12)), axis=1) * arcs[:, -1:]
    at[:, 0], at[:, -1] = 0.0, arcs[:, -1]
    factors = rng.normal(size=(7, 1, dimensions, 3))

    def quadratic(t):
        return (factors * t[..., None, None] ** np.arange(3)).sum(axis=-1)

    assert np.abs(sampled(quadratic(arcs), arcs, at) - quadratic(at)).max() < 1e-12


def test_places_need_not_be_in_order() -> None:
    rng = np.random.default_rng(6)
    arcs = np.cumsum(rng.uniform(0.2, 1.0, (2, 6)), axis=1)
    lines = rng.normal(size=(2, 6, 2))
    at = rng.uniform(arcs[:, :1], arcs[:, -1:], (2, 10))
    order = np.argsort(at[:, 1:-1], axis=1, kind="stable") + 1
    there = np.take_along_axis(sampled(lines, arcs, at), order[..., None], axis=1)
    at[:, 1:-1] = np.take_along_axis(at, order, axis=1)
    assert np.array_equal(sampled(lines, arcs, at)[:, 1:-1], there)


def test_ends_are_those_of_the_lines_to_the_bit() -> None:
    lines = np.random.default_rng(7).normal(size=(3, 5, 2))
    arcs = np.tile(np.linspace(0.0, 0.7, 5), (3, 1))
    at = np.tile(np.linspace(0.0, 0.7, 4), (3, 1))
    assert np.array_equal(sampled(lines, arcs, at)[:, [0, -1]], lines[:, [0, -1]])
