"""Windows cover every bad cell, with room about it, and stay inside the grid."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from meshonet.solvers.energy.clusters import windows

LARGEST = 2500


@settings(max_examples=60, deadline=None)
@given(
    ni=st.integers(3, 90), nj=st.integers(3, 90), margin=st.sampled_from([6, 12, 24]),
    periodic=st.booleans(), count=st.integers(1, 40), seed=st.integers(0, 99),
)  # fmt: skip
def test_every_bad_cell_lies_in_a_window_inside_the_grid(
    ni: int, nj: int, margin: int, periodic: bool, count: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    bad = np.unique(
        np.stack([rng.integers(0, ni - 1, count), rng.integers(0, nj - 1, count)], axis=1), axis=0
    )
    results = list(windows(bad, margin, (ni, nj), periodic, LARGEST))
    ends = [(*w.first, *w.last) for w in results]
    for i, j in bad:
        assert any(
            j0 <= j < j1 and (i0 <= i < i1 or (periodic and (i - i0) % (ni - 1) < i1 - i0))
            for i0, j0, i1, j1 in ends
        ) or (periodic and any(i1 - i0 == ni - 2 for i0, _, i1, _ in ends))
    for i0, j0, i1, j1 in ends:
        assert 0 <= j0 < j1 < nj
        assert i1 - i0 < ni - 1 + (not periodic)
        assert periodic or 0 <= i0 < i1 < ni


def test_a_group_on_both_sides_of_the_seam_is_one_window() -> None:
    bad = np.array([[0, 3], [98, 3], [97, 4]])
    (window,) = windows(bad, 6, (100, 40), True, LARGEST)
    rows = np.arange(window.first[0], window.last[0]) % 99
    assert set(bad[:, 0]) <= set(rows)
    assert window.cells < 40 * 20


def test_a_long_group_is_split() -> None:
    bad = np.stack([np.arange(300), np.arange(300)], axis=1)
    results = list(windows(bad, 6, (400, 400), False, LARGEST))
    assert len(results) > 4
    assert max(w.cells for w in results) <= LARGEST


@settings(max_examples=30, deadline=None)
@given(counts=st.tuples(*[st.integers(3, 40)] * 3), margin=st.integers(3, 9), seed=st.integers(0, 99))
def test_so_does_every_one_of_a_volume(counts: tuple[int, int, int], margin: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    bad = np.unique(rng.integers(0, np.array(counts) - 1, (rng.integers(1, 30), 3)), axis=0)
    results = list(windows(bad, margin, counts, False, LARGEST))
    for cell in bad:
        assert any(((w.first <= cell) & (cell < w.last)).all() for w in results)
    for w in results:
        assert (np.zeros(3) <= w.first).all()
        assert (np.array(w.last) < counts).all()
