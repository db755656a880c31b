"""Differences and transfers between levels on uneven steps."""

import numpy as np
import pytest

from meshonet.solvers.elliptic.coarsening import Direction

CELLS = [7, 8, 16, 25, 99, 100]


@pytest.mark.parametrize("cells", CELLS)
def test_differences_are_exact_for_parabolas(cells: int) -> None:
    direction = Direction(np.arange(cells + 1.0), periodic=False).coarse
    s = direction.positions
    forward, backward, centred = (w[1:-1] for w in direction.differences)
    f = s**2 - 3 * s
    second = forward * (f[2:] - f[1:-1]) + backward * (f[:-2] - f[1:-1])
    np.testing.assert_allclose(second, 2.0, atol=1e-10)
    np.testing.assert_allclose(centred * (s[2:] - s[:-2]), 1.0)


@pytest.mark.parametrize("cells", CELLS)
def test_interpolation_is_exact_for_straight_lines(cells: int) -> None:
    fine = Direction(np.arange(cells + 1.0), periodic=False).coarse
    right = fine.transfer[0]
    coarse = fine.coarse.positions
    dropped = np.setdiff1d(np.arange(fine.cells + 1), fine.kept)
    left = coarse[dropped // 2]
    np.testing.assert_allclose(
        left + right[dropped] * (coarse[dropped // 2 + 1] - left), fine.positions[dropped]
    )
    assert (right[fine.kept] == 0).all()


@pytest.mark.parametrize("cells", CELLS)
def test_restriction_keeps_a_constant_around_a_ring(cells: int) -> None:
    direction = Direction(np.arange(cells + 1.0), periodic=True)
    _, before, at, after = direction.transfer
    np.testing.assert_allclose(before + at + after, 1.0)


@pytest.mark.parametrize("cells", CELLS)
def test_restriction_is_the_transpose_of_interpolation_in_the_lengths_of_nodes(cells: int) -> None:
    fine = Direction(np.arange(cells + 1.0), periodic=True)
    coarse = fine.coarse
    right, before, at, after = fine.transfer
    up = np.zeros((cells, coarse.cells))
    for k in range(cells):
        if right[k] == 0:
            up[k, fine.kept.tolist().index(k)] = 1
        else:
            up[k, k // 2], up[k, (k // 2 + 1) % coarse.cells] = 1 - right[k], right[k]
    down = np.zeros((coarse.cells, cells))
    for k in range(coarse.cells):
        down[k, (2 * k - 1) % cells] += before[k]
        down[k, 2 * k] += at[k]
        down[k, (2 * k + 1) % cells] += after[k]
    length, lengths = (
        np.add(np.diff(d.positions), np.roll(np.diff(d.positions), 1)) / 2 for d in (fine, coarse)
    )
    np.testing.assert_allclose(lengths[:, None] * down, (up * length[:, None]).T)
