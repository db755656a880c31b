"""Convolutions equivariant under the dihedral group D4 (Cohen & Welling, ICML 2016)."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats

Integers: TypeAlias = NDArray[np.int64]
Reals: TypeAlias = NDArray[np.floating[Any]]

ORDER = 8  # elements of the group


def _elements() -> Integers:
    """Return the group (8, 2, 2): turns by quarters, then the same after a mirror."""
    unit, quarter = np.eye(2, dtype=np.int64), np.array([[0, -1], [1, 0]])
    turns = np.stack([unit, quarter, -unit, -quarter])
    return np.concatenate([turns, turns * (1, -1)])


ELEMENTS: Integers = _elements()  # (8, 2, 2) on index steps and on vectors of the plane


def _number(element: Integers) -> int:
    return int(np.flatnonzero((element == ELEMENTS).all(axis=(1, 2)))[0])


INVERSE: Integers = np.array([_number(g.T) for g in ELEMENTS])  # (8,) number of the inverse of each element

PRODUCT: Integers = np.array([[_number((a[:, :, None] * b).sum(axis=1)) for b in ELEMENTS] for a in ELEMENTS])


def _taps(size: int) -> Integers:
    """Return (8, size, size): for each element g, the flat index of g^-1 p for every place p of a kernel."""
    half = size // 2
    places = np.stack(np.meshgrid(*2 * [np.arange(size) - half], indexing="ij")).reshape(2, -1)
    moved = (ELEMENTS[..., None] * places[:, None]).sum(axis=1) + half
    return (moved[:, 0] * size + moved[:, 1]).reshape(ORDER, size, size)


TAPS: dict[int, Integers] = {size: _taps(size) for size in (1, 3)}  # by places along an axis
RELATIVE: Integers = PRODUCT[INVERSE]  # (8, 8) number of h^-1 g


def _sum(*blocks: Reals) -> Floats:
    sizes = [len(block) for block in blocks]
    result, at = np.zeros((sum(sizes), sum(sizes))), 0
    for block, size in zip(blocks, sizes, strict=True):
        result[at : at + size, at : at + size] = block
        at += size
    return result


def _seen(element: Integers) -> Floats:
    """Return the matrix that transforms the features of `encoding.features` by `element`."""
    turn = element.astype(np.float64)
    axes = np.abs(turn)
    sign = axes[0, 0] * turn[0, 0] * turn[1, 1] + axes[0, 1] * turn[0, 1] * turn[1, 0]
    unit = np.ones((1, 1))
    return _sum(
        np.kron(turn.T, turn.T), np.kron(turn.T, axes.T), axes.T, turn.T, sign * unit, unit, unit, turn.T,
        turn.T, unit,
    )  # fmt: skip


SEEN: Floats = np.stack([_seen(element) for element in ELEMENTS])  # (8, FEATURES, FEATURES)


def table(size: int) -> Integers:
    """Return which parameters the entries of an equivariant convolution kernel take: (8, 8, size²) indices.

    Each output channel and each input channel belongs to one of the 8 symmetries of a square. For the
    symmetries h and g, the kernel at position p is w[h⁻¹ g](h⁻¹ p). Indices are for w (8, size, size), flat.
    """
    count = size * size
    return np.asarray(RELATIVE[:, :, None] * count + TAPS[size].reshape(ORDER, 1, count))


def convolution(weight: Any, places: Any, xp: Any) -> Any:
    """Return the kernel (8 * out, 8 * in, size, size) of a convolution that commutes with turns and mirrors.

    Channels are in sets of 8, one for each symmetry of a square. `weight` (out, in, 8, size, size) has 8 *
    size² parameters for each pair of an output set and an input set. `places` (8, 8, size²), from `table`,
    tells which of them is taken for a channel of the output set, a channel of the input set, and a position.
    """
    out, into, _, size, _ = weight.shape
    spread = weight.reshape(out, into, -1)[:, :, places]
    return xp.moveaxis(spread, 2, 1).reshape(ORDER * out, ORDER * into, size, size)


def lift(weight: Any, seen: Any) -> Any:
    """Return the first layer (8 * out, FEATURES): `weight` (out, FEATURES) times each of 8 matrices `seen`.

    The matrices (8, FEATURES, FEATURES) transform the features of a node by the symmetries of a square.
    """
    return (weight[:, None, :, None] * seen).sum(2).reshape(ORDER * len(weight), -1)


def projection(weight: Any, elements: Any, xp: Any) -> Any:
    """Return the matrix (2 * heads, 8 * sets) of the last layer; a head is x and y for one kind of grid.

    Channels are in sets of 8, one for each symmetry of a square, with its matrix in `elements` (8, 2, 2).
    Channel g of set k is multiplied by the vector ``elements[g] @ weight[head, :, k] / 8`` for each head.
    """
    back = weight[:, None, :, :, None] * xp.moveaxis(elements, 0, -1)[:, :, None]
    return back.sum(2).reshape(2 * len(weight), -1) / ORDER
