"""Heights of layers: what the law promises, against roots of another solver."""

import numpy as np
import pytest
from numpy.polynomial import polynomial
from scipy.optimize import brentq

from meshonet.solvers.layers.layer_law import STEEPER, layer_arcs

ROWS = 24
FIRST = 1e-3
K = np.arange(ROWS) / (ROWS - 1)


def constant_ratio(length):
    """Return the logarithm of the last cell over the first of a constant ratio."""
    return brentq(lambda slope: np.exp(slope * K).sum() - length / FIRST, 0.0, 60.0, xtol=1e-14)


@pytest.fixture(scope="module")
def lengths():
    return np.random.default_rng(5).uniform(0.03, 2.0, 37)  # not a multiple of what a vector holds


def test_an_open_end_gives_a_constant_ratio(lengths):
    arcs = layer_arcs(lengths, FIRST, np.full(len(lengths), np.inf), ROWS)
    wanted = [constant_ratio(length) / (ROWS - 1) for length in lengths]
    np.testing.assert_allclose(
        np.diff(np.log(np.diff(arcs))), np.array(wanted)[:, None] * np.ones(ROWS - 1), atol=1e-11
    )


def test_a_given_last_height_is_met_by_a_quadratic_of_the_index(lengths):
    plain = np.array([constant_ratio(length) for length in lengths])
    last = FIRST * np.exp(plain * (1.0 + 0.25 * STEEPER))
    arcs = layer_arcs(lengths, FIRST, last, ROWS, growth=2.0)
    sizes = np.diff(arcs)
    np.testing.assert_allclose(sizes[:, 0], FIRST, rtol=1e-12)
    np.testing.assert_allclose(sizes[:, -1], last, rtol=1e-10)
    assert (arcs[:, -1] == lengths).all()
    for logs in np.log(sizes):
        fit = polynomial.polyfit(K, logs, 2)
        np.testing.assert_allclose(polynomial.polyval(K, fit), logs, atol=1e-10)


def test_a_last_height_out_of_reach_gives_way_to_the_growth(lengths):
    plain = np.array([constant_ratio(length) for length in lengths])
    for last in (1e3 * lengths, np.full(len(lengths), FIRST)):
        steps = np.diff(np.log(np.diff(layer_arcs(lengths, FIRST, last, ROWS))))
        assert (steps <= 1.05 * (1.0 + STEEPER) * plain[:, None] / (ROWS - 1)).all()
        assert (steps >= -1e-9).all()


def test_a_line_has_the_same_layers_whatever_lines_are_beside_it(lengths):
    last = np.linspace(0.01, 0.4, len(lengths))
    together = layer_arcs(lengths, FIRST, last, ROWS)
    for k in range(len(lengths)):
        assert (layer_arcs(lengths[k : k + 1], FIRST, last[k : k + 1], ROWS)[0] == together[k]).all()
