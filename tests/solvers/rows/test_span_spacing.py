"""Sizes along lines: first and last cells of a given height, growth within its limit, exact lengths."""

import numpy as np
import pytest

from meshonet.solvers.rows.span_spacing import smooth_arcs, spaced_cells, two_sided

LENGTHS = np.array([0.3, 1.0, 2.5])
FIRST, LAST = np.array([1e-6, 1e-4, 1e-2]), np.array([1e-3, 1e-5, 1e-6])


@pytest.mark.parametrize("growth", [1.1, 1.25, 1.6])
def test_cells_grow_from_both_ends_by_the_limit_at_most(growth: float) -> None:
    cells = max(spaced_cells(2.5, ends, growth, 0.2, 8) for ends in zip(FIRST, LAST, strict=True))
    arcs = two_sided(LENGTHS, (FIRST, LAST), growth, cells)
    sizes = np.diff(arcs)
    ratios = sizes[:, 1:] / sizes[:, :-1]
    assert np.maximum(ratios, 1.0 / ratios).max() <= growth * (1.0 + 1e-9)
    assert sizes[:, 0] == pytest.approx(FIRST, rel=2e-2)
    assert sizes[:, -1] == pytest.approx(LAST, rel=2e-2)
    assert arcs[:, -1] == pytest.approx(LENGTHS, rel=1e-12)


@pytest.mark.parametrize("last", [None, 1e-2])
def test_logarithms_of_sizes_are_polynomials_from_first_cells_of_the_given_height(last: float | None) -> None:
    sizes = np.diff(smooth_arcs(LENGTHS, (FIRST, last), 60))
    assert sizes[:, 0] == pytest.approx(FIRST, rel=1e-9)
    assert np.diff(np.log(sizes), 2 if last is None else 3, axis=1) == pytest.approx(0.0, abs=1e-9)
    assert sizes.sum(axis=1) == pytest.approx(LENGTHS, rel=1e-12)
