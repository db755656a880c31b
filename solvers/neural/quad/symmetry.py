"""The eight relabellings of a quad, and convolutions that commute with them.

A quad stays the same domain when its index axes are turned by quarters or mirrored, and the plane with
them. These eight signed permutations form the dihedral group D4. A layer's channels come in sets of eight,
one for each element; a kernel of the layer is one small set of weights, seen from every element::

    K[h, g](p) = w[h^-1 g](h^-1 p)

so the network's answer to a relabelled domain is the relabelled answer, to rounding, and an ordinary
convolution with the expanded kernels computes it. Cohen & Welling, Group Equivariant Convolutional Networks,
ICML 2016.
"""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Complexes, Floats

Integers: TypeAlias = NDArray[np.int64]
Reals: TypeAlias = NDArray[np.floating[Any]]

ORDER = 8
"""Elements of the group."""


def _elements() -> Integers:
    """Return the group (8, 2, 2): turns by quarters, then the same after a mirror."""
    quarter, mirror = np.array([[0, -1], [1, 0]]), np.array([[1, 0], [0, -1]])
    turns = [np.linalg.matrix_power(quarter, k) for k in range(4)]
    return np.stack([*turns, *(turn @ mirror for turn in turns)])


ELEMENTS: Integers = _elements()
"""(8, 2, 2) what an element does to index steps (along xi, along eta) and to vectors (x, y) of the plane."""


def _number(element: Integers) -> int:
    return int(np.flatnonzero((element == ELEMENTS).all(axis=(1, 2)))[0])


INVERSE: Integers = np.array([_number(g.T) for g in ELEMENTS])
"""(8,) number of the inverse of each element."""

PRODUCT: Integers = np.array([[_number(a @ b) for b in ELEMENTS] for a in ELEMENTS])
"""(8, 8) number of the product of two."""


def _taps(size: int) -> Integers:
    """Return (8, size, size): for each element g, the flat index of g^-1 p for every place p of a kernel."""
    half = size // 2
    places = np.stack(np.meshgrid(*2 * [np.arange(size) - half], indexing="ij")).reshape(2, -1)
    moved = np.einsum("gba,bp->gap", ELEMENTS, places) + half
    return (moved[:, 0] * size + moved[:, 1]).reshape(ORDER, size, size)


TAPS: dict[int, Integers] = {size: _taps(size) for size in (1, 3)}
"""Of kernels with this many places along each axis."""

RELATIVE: Integers = PRODUCT[INVERSE]
"""(8, 8) number of h^-1 g."""


def _sum(*blocks: Reals) -> Floats:
    """Return a block diagonal matrix."""
    sizes = [len(block) for block in blocks]
    result, at = np.zeros((sum(sizes), sum(sizes))), 0
    for block, size in zip(blocks, sizes, strict=True):
        result[at : at + size, at : at + size] = block
        at += size
    return result


def _seen(element: Integers) -> Floats:
    """Return the matrix that takes the features of `features` to those an observer at `element` sees."""
    turn = element.astype(np.float64)
    axes = np.abs(turn)
    sign = axes[0, 0] * turn[0, 0] * turn[1, 1] + axes[0, 1] * turn[0, 1] * turn[1, 0]
    one = np.ones((1, 1))
    return _sum(
        np.kron(turn.T, turn.T), np.kron(turn.T, axes.T), axes.T, turn.T, sign * one, one, one, turn.T,
        turn.T, one,
    )  # fmt: skip


SEEN: Floats = np.stack([_seen(element) for element in ELEMENTS])
"""(8, FEATURES, FEATURES)"""


def relabelled(values: Complexes, element: int) -> Complexes:
    """Return fields (..., n, n) of complex vectors or places, index axes and plane moved by an element.

    >>> square = np.array([[0, 1j], [1, 1 + 1j]]) - (0.5 + 0.5j)
    >>> [bool(np.allclose(relabelled(square, k), square)) for k in range(8)]
    [True, True, True, True, True, True, True, True]
    """
    n = values.shape[-1]
    centred = np.arange(n) - (n - 1) / 2
    places = np.stack(np.meshgrid(centred, centred, indexing="ij")).reshape(2, -1)
    at = np.rint(ELEMENTS[element] @ places + (n - 1) / 2).astype(np.int64)
    moved = values[..., at[0], at[1]].reshape(values.shape)
    back = ELEMENTS[element].T
    real = back[0, 0] * moved.real + back[0, 1] * moved.imag
    return np.asarray(real + 1j * (back[1, 0] * moved.real + back[1, 1] * moved.imag))
