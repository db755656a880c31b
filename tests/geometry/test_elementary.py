"""Elementary functions and products against twice the digits, and at the ends of what they take."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshonet.geometry import elementary
from meshonet.geometry.elementary import modulus, times

FUNCTIONS = {
    "exp": (-700.0, 700.0),
    "log": (1e-300, 1e300),
    "sin": (-3e4, 3e4),
    "cos": (-3e4, 3e4),
    "expm1": (-30.0, 700.0),
    "log1p": (-0.999, 1e9),
    "log2": (1e-300, 1e300),
    "log10": (1e-300, 1e300),
    "tan": (-100.0, 100.0),
    "arcsin": (-1.0, 1.0),
    "arccos": (-1.0, 1.0),
    "arctan": (-1e3, 1e3),
    "sinh": (-700.0, 700.0),
    "cosh": (-700.0, 700.0),
    "tanh": (-20.0, 20.0),
    "arcsinh": (-1e9, 1e9),
    "arccosh": (1.0, 1e6),
    "cbrt": (-1e9, 1e9),
}
"""Names, and from where to where they are tested."""
SPECIAL = np.array(
    [0.0, -0.0, 1.0, -1.0, 2.0, np.inf, -np.inf, np.nan, 5e-324, 1e-308, 1.7e308, -1.7e308, 1e6, 1e22]
)
RNG_SEED = 20240607


def between(low, high, count=20000):
    """Return numbers between two, of every size."""
    rng = np.random.default_rng(RNG_SEED)
    even = rng.uniform(max(low, -1e3), min(high, 1e3), count)
    sizes = 10.0 ** rng.uniform(-12, np.log10(high), count)
    each = np.concatenate([even, sizes, -sizes, 1.0 + 1e-9 * even, [low, high]])
    return each[(each >= low) & (each <= high)]


def units_off(values, exact):
    """Return by how many units in the last place numbers differ from exact ones in long double precision."""
    return float((np.abs(values - exact) / np.spacing(np.abs(exact.astype(np.float64)))).max())


def same(values, expected):
    """Whether numbers are equal, of the same sign where 0, or both not numbers."""
    return np.array_equal(values, expected, equal_nan=True) and np.array_equal(
        np.signbit(values[values == 0]), np.signbit(expected[values == 0])
    )


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_is_within_3_units_of_the_last_place(name):
    x = between(*FUNCTIONS[name])
    exact = getattr(np, name)(x.astype(np.longdouble))
    assert units_off(getattr(elementary, name)(x), exact) <= 3.0


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_of_special_values_is_numpy_s(name):
    with np.errstate(all="ignore"):
        expected = getattr(np, name)(SPECIAL)
    values = getattr(elementary, name)(SPECIAL)
    ends = ~np.isfinite(expected) | (expected == 0.0)
    assert same(values[ends], expected[ends])
    np.testing.assert_allclose(values[~ends], expected[~ends], rtol=1e-15)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_takes_what_numpy_s_takes(name):
    function, x = getattr(elementary, name), np.linspace(1.0, 1.0, 12).reshape(3, 4)
    x[1:, ::2] = 0.5 if name != "arccosh" else 1.5
    flat = np.array([function(v) for v in x.ravel()])
    assert isinstance(function(0.5 if name != "arccosh" else 1.5), np.float64)
    assert np.array_equal(function(x), flat.reshape(3, 4))
    assert np.array_equal(function(x.tolist()), flat.reshape(3, 4))
    assert np.array_equal(function(x[:, ::-2]), function(x)[:, ::-2])
    assert np.array_equal(function(x.T), function(x).T)
    assert function(np.zeros((0, 3))).shape == (0, 3)
    assert np.array_equal(function(np.array([1, 1])), function(np.array([1.0, 1.0])))
    assert np.ndim(function(np.array(1.0))) == 0


@pytest.mark.parametrize("name", FUNCTIONS)
def test_single_precision_stays_so(name):
    x = np.array([1.0, 1.0], np.float32)
    values = getattr(elementary, name)(x)
    assert values.dtype == np.float32
    np.testing.assert_allclose(values, getattr(np, name)(x), rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("name", ["exp", "log", "sin", "sinh"])
def test_complex_numbers_are_numpy_s(name):
    z = np.array([1 + 2j, -0.5 + 0.25j])
    assert np.array_equal(getattr(elementary, name)(z), getattr(np, name)(z))
    assert np.array_equal(elementary.power(z, 0.3), np.power(z, 0.3))


def test_sines_near_multiples_of_pi_have_all_digits():
    x = np.pi * np.arange(1, 2000) / 2.0
    exact = x.astype(np.longdouble)
    assert units_off(elementary.sin(x), np.sin(exact)) <= 3.0
    assert units_off(elementary.cos(x), np.cos(exact)) <= 3.0


def test_angles_are_within_3_units_of_the_last_place():
    rng = np.random.default_rng(RNG_SEED)
    x, y = (rng.normal(size=50000) * 10.0 ** rng.uniform(-8, 8, 50000) for _ in range(2))
    exact = np.arctan2(y.astype(np.longdouble), x.astype(np.longdouble))
    assert units_off(elementary.arctan2(y, x), exact) <= 3.0


def test_angles_of_special_values_are_numpy_s():
    x, y = SPECIAL[:, None], SPECIAL[None, :]
    values, expected = elementary.arctan2(y, x), np.arctan2(y, x)
    assert values.shape == (len(SPECIAL),) * 2
    np.testing.assert_allclose(values, expected, rtol=1e-15)
    assert np.array_equal(np.signbit(values)[values == 0], np.signbit(expected)[values == 0])


def test_the_angle_of_complex_and_of_real_numbers():
    z = np.array([[1 + 1j, -1 + 0j], [-2j, 0j]])
    np.testing.assert_allclose(elementary.angle(z), np.angle(z), rtol=1e-15)
    assert elementary.angle(-1.0) == np.pi
    assert isinstance(elementary.angle(1j), np.float64)


def test_powers_are_within_3_units_of_the_last_place_and_broadcast():
    x, exponent = between(1e-3, 1e3)[:, None], np.array([-2.3, 1 / 3, 0.75, 3.0, 7.0])
    exact = x.astype(np.longdouble) ** exponent
    assert units_off(elementary.power(x, exponent), exact) <= 3.0
    assert elementary.power(2, 10) == 1024.0
    assert np.array_equal(elementary.power(-2.0, np.arange(4)), [1.0, -2.0, 4.0, -8.0])
    assert elementary.power(np.zeros((0, 2)), 3).shape == (0, 2)


def test_single_precision_in_both_arguments_stays_so_and_in_one_does_not():
    single, double = np.full(3, 2.0, np.float32), np.full(3, 0.3)
    assert elementary.power(single, single).dtype == np.float32
    assert elementary.power(single, 0.3).dtype == np.float32
    for values in (elementary.power(single, double), elementary.power(double, single)):
        assert values.dtype == np.float64
    np.testing.assert_allclose(elementary.power(double, single), 0.3**2.0, rtol=1e-15)


@pytest.mark.parametrize(("start", "stop"), [(1e-5, 2.0), (3.0, 1e-4), (1.0, 1.0)])
def test_a_geometric_row_has_its_ends_and_one_ratio(start, stop):
    row = elementary.geomspace(start, stop, 7)
    np.testing.assert_allclose(row, np.geomspace(start, stop, 7), rtol=1e-14)
    assert (row[0], row[-1]) == (start, stop)


def test_functions_of_numpy_are_these_and_of_another_module_its_own():
    assert elementary.functions_of(np) is elementary
    assert elementary.functions_of(pytest) is pytest


SHAPES = [
    ((3,), (3,)),
    ((2,), (2, 5)),
    ((5, 2), (2,)),
    ((4, 3), (3, 2)),
    ((130, 300), (300, 70)),
    ((2, 5, 3), (3,)),
    ((2, 5, 3), (3, 4)),
    ((6, 2, 3), (6, 3, 4)),
    ((2, 3), (6, 3, 4)),
    ((3,), (6, 3, 4)),
    ((5, 1, 2, 3), (6, 3, 3)),
    ((0, 3), (3, 2)),
    ((4, 0), (0, 2)),
    ((0,), (0,)),
    ((3, 2), (2, 0)),
]
"""Shapes of the factors of products."""


@pytest.mark.parametrize(("left", "right"), SHAPES)
@pytest.mark.parametrize("kind", [float, complex])
def test_a_product_is_that_of_matmul(left, right, kind):
    rng = np.random.default_rng(RNG_SEED)
    a, b = rng.normal(size=left).astype(kind), rng.normal(size=right).astype(kind)
    a = a + 1j * rng.normal(size=left) if kind is complex else a
    values, expected = elementary.product(a, b), a @ b
    assert np.shape(values) == np.shape(expected)
    np.testing.assert_allclose(values, expected, rtol=1e-13, atol=1e-13)


def test_a_product_takes_views_lists_and_integers():
    rng = np.random.default_rng(RNG_SEED)
    a, b = rng.normal(size=(9, 14)), rng.normal(size=(8, 5))
    np.testing.assert_allclose(
        elementary.product(a[::2, ::-2], b[1:, ::2]), a[::2, ::-2] @ b[1:, ::2], rtol=1e-13
    )
    np.testing.assert_allclose(elementary.product(a.T[:8].T, b), a[:, :8] @ b, rtol=1e-13)
    assert elementary.product([1, 2], [3, 4]) == 11.0
    assert isinstance(elementary.product([1, 2], [3, 4]), np.float64)


@pytest.mark.parametrize("order", ["<", ">", "="])
@pytest.mark.parametrize("offset", [0, 1])
def test_arrays_are_taken_as_files_give_them(order, offset):
    x = np.array([1.0, 2.0, 3.0])
    kind = np.dtype(float).newbyteorder(order)
    given = np.frombuffer(offset * b"." + x.astype(kind).tobytes(), kind, offset=offset)
    assert given.flags.aligned == (offset == 0)
    assert elementary.product(given, given) == 14.0
    assert np.array_equal(elementary.cos(given), elementary.cos(x))
    assert np.array_equal(elementary.power(given, given), [1.0, 4.0, 27.0])


@pytest.mark.parametrize(("left", "right"), [((3,), (2,)), ((4, 3), (2, 3)), ((4, 3), (5, 2, 3))])
def test_a_product_of_shapes_that_do_not_fit_is_refused(left, right):
    with pytest.raises(ValueError, match="shapes"):
        elementary.product(np.ones(left), np.ones(right))


PARTS = st.floats(-1e3, 1e3, allow_subnormal=False)


@pytest.mark.slow
@given(st.lists(st.tuples(PARTS, PARTS, PARTS, PARTS), min_size=1, max_size=20))
def test_products_of_complex_numbers_round_every_product_and_sum(parts):
    a, b, c, d = np.array(parts).T
    answer = times(a + 1j * b, c + 1j * d)
    assert np.array_equal(answer.real, a * c - b * d)
    assert np.array_equal(answer.imag, a * d + b * c)


def test_products_of_complex_numbers_have_the_shape_and_kind_of_numpys():
    z = np.arange(6.0).reshape(2, 3) + 1j
    assert np.array_equal(times(z, 2.0), 2.0 * z)
    assert np.array_equal(times(z[:, :1], z), z[:, :1] * z)
    assert times(1j, z[0, 0]) == 1j * z[0, 0]
    assert times(z.astype(np.complex64), z.astype(np.complex64)).dtype == np.complex64


def test_the_modulus_is_the_length_of_complex_numbers_and_the_size_of_real_ones():
    assert modulus(3 + 4j) == 5.0
    assert modulus(np.array([3 + 4j, -1j])).tolist() == [5.0, 1.0]
    assert modulus(np.array([-2.0, 1.0])).tolist() == [2.0, 1.0]
