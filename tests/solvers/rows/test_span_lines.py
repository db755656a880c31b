"""Polynomials along the span: sums of Chebyshev polynomials, as NumPy has them."""

import numpy as np
import pytest

from meshonet.kernels._native import chebyshev_sums
from meshonet.solvers.rows.span_lines import SpanLines, key_heights


@pytest.mark.parametrize("terms", [2, 3, 6, 17])
def test_values_are_those_of_numpys_polynomials(terms: int) -> None:
    draw = np.random.default_rng(terms)
    coefficients, heights = draw.normal(size=(terms, 131, 2)), draw.uniform(size=(7, 131))
    expected = np.polynomial.chebyshev.chebval(
        2.0 * heights[..., None] - 1.0, coefficients[:, None], tensor=False
    )
    lines = SpanLines(coefficients)
    np.testing.assert_allclose(lines.at(heights), expected, rtol=0.0, atol=1e-12)
    same = SpanLines(coefficients).at(heights[:, :1])
    np.testing.assert_array_equal(same, lines.at(np.repeat(heights[:, :1], 131, axis=1)))


def test_lines_pass_through_values_at_key_heights() -> None:
    values = np.random.default_rng(0).normal(size=(9, 5, 2))
    np.testing.assert_allclose(SpanLines.through(values).at(key_heights(9)[:, None]), values, atol=1e-13)


@pytest.mark.parametrize(
    ("terms", "lines", "shape"), [(1, 4, (3, 4)), (3, 3, (3, 4)), (3, 4, (3, 5))], ids=str
)
def test_arrays_that_do_not_belong_together_are_refused(terms: int, lines: int, shape: tuple) -> None:
    with pytest.raises(ValueError, match=r"terms|shape"):
        chebyshev_sums(np.zeros((terms, 4)), np.zeros((3, lines)), np.empty(shape))
