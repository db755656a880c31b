from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.laws import LAWS
from meshonet.geometry.spacing.tanh_law import TanhLaw

Q = np.linspace(0.0, 1.0, 33)


def spacing_tanh(n, first, last):
    return TanhLaw.fitted(n - 1, first, last)(np.linspace(0.0, 1.0, n))


def test_cosine_is_the_half_circle_seen_from_the_side():
    place = LAWS["cosine"].place
    assert place is not None
    np.testing.assert_allclose(place(Q), 0.5 - 0.5 * np.cos(np.pi * Q), atol=1e-15)


@pytest.mark.parametrize(
    "values",
    [spacing_tanh(33, 0.01, 0.02), *(law.place(Q) for law in LAWS.values() if law.place)],
)
def test_laws_run_from_0_to_1(values):
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


def test_a_new_law_is_one_line(monkeypatch):
    from meshonet.geometry.families.family import family
    from meshonet.geometry.shapes.airfoil.naca import naca
    from meshonet.geometry.shapes.outline import Outline
    from meshonet.geometry.spacing import laws, sampling

    monkeypatch.setitem(LAWS, "square", laws.Law(lambda q: q * q))
    monkeypatch.setattr(sampling, "SPACINGS", tuple(LAWS))
    settings = sampling.Sampling(61, 21, spacing="square")
    square = Outline(family("arch").boundary(0.0, 3, 3).outline()).boundary(settings)
    np.testing.assert_allclose(square.south[:, 0], np.linspace(0, 1, 61) ** 2, atol=1e-12)
    wall = naca("0012-sharp").boundary(settings).south
    steps = np.hypot(*np.diff(wall, axis=0).T)
    assert (np.diff(steps[:28]) > 0).all()
    naca("0012-sharp").boundary(replace(settings, topology="c"))
