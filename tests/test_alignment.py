"""Kernels return the same bits wherever their arrays begin in memory, and whatever their room held before."""

from collections.abc import Callable

import numpy as np
import pytest

from meshonet.geometry.arrays import Floats
from meshonet.geometry.rows.channel import Channel
from meshonet.kernels import _native
from meshonet.solvers.sparse import SparsePattern

DRAW = np.random.default_rng(4)
N = 333
CHANNEL = Channel(np.array([[0.0, 1.0], [2.0, 1.1]]), np.array([[0.0, 2.0], [2.0, 1.9]]), 0.01, 0.02)
CHAIN = SparsePattern(N, np.r_[:N, : N - 1], np.r_[:N, 1:N])
FACTOR = CHAIN.factor(np.r_[np.full(N, 2.5), np.full(N - 1, -1.0)])


def placed(values: Floats, offset: int) -> Floats:
    """The values `offset` doubles behind a multiple of 64 bytes."""
    room = np.full(values.size + 16, np.nan)
    start = -(room.ctypes.data // 8) % 8 + offset
    out = room[start : start + values.size].reshape(values.shape)
    out[...] = values
    assert out.ctypes.data % 64 == 8 * offset % 64
    return out


def solved(x: Floats, out: Floats) -> None:
    out[...] = x
    _native.sparse_solve(CHAIN.arrays, FACTOR.arrays, out)


def function(name: str) -> Callable[..., object]:
    return lambda x, out: _native.elementary(name.encode(), x, out)


def drawn(*shape: int) -> Floats:
    return DRAW.uniform(0.1, 3.0, shape)


KERNELS: dict[str, tuple[Callable[..., object], list[Floats], tuple[int, ...]]] = {
    **{name: (function(name), [drawn(N)], (N,)) for name in ("exp", "log", "sin", "cos")},
    "angles": (_native.angles_of, [drawn(N), drawn(N)], (N,)),
    "product": (_native.matrix_product, [drawn(37, N), drawn(N, 29)], (37, 29)),
    "product with a vector": (_native.matrix_product, [drawn(37, N), drawn(N, 1)], (37, 1)),
    "Chebyshev sums": (_native.chebyshev_sums, [drawn(6, N), drawn(9, N)], (9, N)),
    "channel": (lambda v, out: _native.channel_space(CHANNEL._tables, v, out), [drawn(N, 3)], (N, 3)),
    "sparse": (solved, [drawn(N, 2)], (N, 2)),
}


@pytest.mark.parametrize("name", KERNELS)
def test_bits_do_not_depend_on_where_arrays_begin(name: str) -> None:
    kernel, arrays, shape = KERNELS[name]
    results = []
    for offset in range(8):
        out = placed(np.full(shape, np.nan), (3 * offset + 1) % 8)
        kernel(*(placed(each, offset) for each in arrays), out)
        results.append(out.copy())
    assert np.isfinite(results[0]).all()
    assert all(np.array_equal(results[0], other) for other in results)
