import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.sampling import (
    Sampling,
    TanhLaw,
    monotone_cubic,
    spacing_cosine,
    spacing_tanh,
    spacing_uniform,
)


def test_cosine_is_the_half_circle_seen_from_the_side():
    np.testing.assert_allclose(spacing_cosine(5), 0.5 - 0.5 * np.cos(np.pi * np.arange(5) / 4), atol=1e-15)


@pytest.mark.parametrize("law", [spacing_uniform, spacing_cosine, lambda n: spacing_tanh(n, 0.01, 0.02)])
def test_laws_run_from_0_to_1(law):
    values = law(33)
    assert values[0] == pytest.approx(0, abs=1e-15)
    assert values[-1] == pytest.approx(1)
    assert (np.diff(values) > 0).all()


@settings(max_examples=80, deadline=None)
@given(cells=st.integers(3, 2000), first=st.floats(1e-7, 0.3), last=st.floats(1e-7, 0.3), half=st.booleans())
def test_tanh_meets_both_steps(cells, first, last, half):
    assume(first + last < 0.6)
    n, part = (cells + 0.5, 0.5) if half else (float(cells), 1.0)
    law = TanhLaw.fitted(n, first, last, part)
    s = law(np.array([0.0, 1 / n, 1 - part / n, 1.0]))
    assert s[1] == pytest.approx(first, rel=1e-5)
    assert 1 - s[2] == pytest.approx(part * last, rel=1e-5, abs=1e-13)
    assert (np.diff(law(np.append(np.arange(int(n) + 1) / n, 1.0))) >= 0).all()


def test_tanh_grows_evenly():
    steps = np.diff(spacing_tanh(101, 1e-4, 1e-3))
    ratio = steps[1:] / steps[:-1]
    assert max(ratio.max(), 1 / ratio.min()) < 1.16


def test_tanh_of_equal_steps_is_uniform():
    np.testing.assert_allclose(spacing_tanh(11, 0.1, 0.1), np.linspace(0, 1, 11), atol=1e-9)


def test_tanh_says_what_it_cannot_do():
    with pytest.raises(InputError, match="change the spacing or the number of nodes"):
        TanhLaw.fitted(2.0, 0.9, 0.9)


def test_monotone_cubic_is_monotone_and_exact_at_its_points():
    rng = np.random.default_rng(0)
    x, y = np.cumsum(rng.random(20)), np.cumsum(rng.random(20) ** 4)
    at = np.linspace(x[0], x[-1], 2000)
    assert (np.diff(monotone_cubic(x, y, at)) >= 0).all()
    np.testing.assert_allclose(monotone_cubic(x, y, x), y, atol=1e-14)


def test_monotone_cubic_is_of_high_order_on_smooth_data():
    def error(n: int) -> float:
        x = np.linspace(0, 1, n)
        at = np.linspace(0, 1, 999)
        return float(np.abs(monotone_cubic(x, np.exp(x), at) - np.exp(at)).max())

    assert error(20) / error(40) > 3.5


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"ni": 1}, "ni is 1 nodes; use 2 to"),
        ({"nj": 10**7}, "nj is 10000000 nodes"),
        ({"topology": "h"}, "topology 'h' is not known; use auto/quad/o/c"),
        ({"spacing": "log"}, "spacing 'log' is not known; use auto/"),
        ({"le_spacing": 0.0}, "le_spacing is 0 chords; use 1e-9 to 0.2"),
        ({"te_spacing": 1e-300}, "te_spacing is 1e-300 chords; use 1e-9 to 0.2"),
        ({"te_spacing": 0.5}, "te_spacing is 0.5 chords"),
        ({"far_field": 1.0}, "far field is at 1 chords"),
        ({"far_field": float("nan")}, "far field"),
        ({"corners": (0, 1, 1, 2)}, "not four different points"),
    ],
)
def test_settings_out_of_range_are_refused_with_the_range(setting, message):
    with pytest.raises(InputError, match=message):
        Sampling(**setting)
