"""Types of the arrays that modules pass to each other."""

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

Floats: TypeAlias = NDArray[np.float64]
"""float64 array; docstrings of functions state the shape."""

Complexes: TypeAlias = NDArray[np.complex128]
"""complex128 array of points x + iy."""
Indices: TypeAlias = NDArray[np.intp]
"""Array of integers: indices or numbers of nodes and cells."""
Bools: TypeAlias = NDArray[np.bool_]
"""Array of flags, a mask."""

Topology: TypeAlias = Literal["quad", "o", "c", "blocks"]
"""Kind of a grid by its connections; ``blocks`` are all grids that are neither ``quad`` nor ``o`` nor ``c``.
"""
Side: TypeAlias = Literal["south", "east", "north", "west", "bottom", "top"]

TOPOLOGIES: tuple[Topology, ...] = ("quad", "o", "c")
"""The topologies of a single block."""
SIDES: tuple[Side, ...] = ("south", "east", "north", "west")
"""The sides of a two-dimensional block, counter-clockwise."""


AnyArray = TypeVar("AnyArray", bound=NDArray[Any])

_ROUNDING = 1e-12  # largest distance of the ends of a closed curve, relative to its extent
_MANY, _SAMPLE = 1 << 17, 1 << 14  # values of which ranks are found by a sample, and how large that is


def distinct(values: AnyArray) -> AnyArray:
    """Return the sorted distinct values of an array (n,), as np.unique does, but without loading numpy.ma."""
    ordered = np.sort(values)
    return ordered[np.append(True, ordered[1:] != ordered[:-1])[: len(ordered)]]


def norms(vectors: Floats) -> Floats:
    """Return the lengths (...) of vectors (..., 2 or 3)."""
    if vectors.shape[-1] == 2:
        return np.hypot(vectors[..., 0], vectors[..., 1])
    return np.sqrt(dots(vectors, vectors))


def growth_ratios(lengths: Floats) -> Floats:
    """Return the ratios (..., n - 1) of neighbouring `lengths` (..., n), the longer over the shorter."""
    ratio = lengths[..., 1:] / lengths[..., :-1]
    return np.maximum(ratio, 1.0 / ratio)


def dots(one: Floats, other: Floats) -> Floats:
    """Return the scalar products (...) of vectors (..., 2 or 3)."""
    total = one[..., 0] * other[..., 0]
    for k in range(1, one.shape[-1]):
        total += one[..., k] * other[..., k]
    return np.asarray(total)


def turned_left(vectors: Floats) -> Floats:
    """Return vectors (..., 2) turned by a right angle to the left."""
    return np.stack([-vectors[..., 1], vectors[..., 0]], axis=-1)


def extent_of(points: Floats) -> float:
    """Return the greatest extent of `points` (n, d) along any axis."""
    return float(np.ptp(points, axis=0).max())


def ends_meet(points: Floats) -> bool:
    """Return whether the last of `points` (n, d) equals the first, up to rounding.

    >>> angles = np.linspace(0.0, 2 * np.pi, 9)
    >>> ends_meet(np.stack([np.cos(angles), np.sin(angles)], axis=1))
    True
    """
    return len(points) > 1 and bool(np.abs(points[-1] - points[0]).max() <= _ROUNDING * extent_of(points))


def rolled(values: AnyArray, by: int) -> Any:
    """Return `values` (n, ...) rolled by `by` along the first axis, as np.roll; faster for few values.

    >>> rolled(np.arange(5), 2).tolist()
    [3, 4, 0, 1, 2]
    """
    return np.concatenate([values[-by:], values[:-by]])


def cross2(u: Floats, v: Floats) -> Floats:
    """Return the cross products u x v (...), which are scalars, of vectors (..., 2) in the plane."""
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def complex_of(points: Floats) -> Complexes:
    """Return points (..., 2) as complex numbers (...)."""
    return np.asarray(points[..., 0] + 1j * points[..., 1])


def pairs_of(values: NDArray[Any]) -> Floats:
    """Return complex numbers (...) as points (..., 2)."""
    return np.stack([values.real, values.imag], axis=-1)


def wrapped(parts: Floats, least: float = -0.5) -> Floats:
    """Return fractions of a turn (...), each moved by a whole number of turns into [`least`, `least` + 1).

    >>> wrapped(np.array([0.75, -0.25])).tolist()
    [-0.25, -0.25]
    """
    return np.asarray(np.mod(parts - least, 1.0) + least)


def shortest_ways(ways: Floats, length: float | Floats) -> Floats:
    """Return signed distances (...) along closed curves, each by the shorter way around its curve.

    `ways` (...) are signed distances by any way around. `length` is the length of the curves.

    >>> shortest_ways(np.array([3.0, -3.0, 1.0]), 4.0).tolist()
    [-1.0, 1.0, 1.0]
    """
    return np.asarray(np.mod(ways + 0.5 * length, length) - 0.5 * length)


def arc_lengths(line: Floats) -> Floats:
    """Return the arc lengths (..., n) at the nodes of lines (..., n, d), from 0 at the first node."""
    arcs = np.zeros(line.shape[:-1])
    np.cumsum(norms(np.diff(line, axis=-2)), axis=-1, out=arcs[..., 1:])
    return arcs


def arc_parts(line: Floats) -> Floats:
    """Return the arc lengths (..., n) at the nodes of lines (..., n, d) as fractions of the line's length."""
    arcs = arc_lengths(line)
    return np.asarray(arcs / arcs[..., -1:])


def smooth_step(t: Floats) -> Floats:
    """Return t² (3 - 2 t), which increases from 0 at t = 0 to 1 at t = 1, with slope 0 at both ends."""
    return np.asarray(t * t * (3.0 - 2.0 * t))


def running_sums(values: Floats, count: int) -> Floats:
    """Return the sums (n - count + 1,) of each run of `count` consecutive `values` (n,)."""
    last = len(values) - count + 1
    return np.asarray(sum(values[k : last + k] for k in range(count)))


def along_and_across(vectors: Floats, axis: Floats) -> tuple[Floats, Floats]:
    """Return two scalar products (...) of `vectors` (..., 2): with `axis` (2,), and with its left normal."""
    x, y = vectors[..., 0], vectors[..., 1]
    return x * axis[0] + y * axis[1], y * axis[0] - x * axis[1]


def middle(values: Floats) -> float:
    """Return the median of an array (n,) without NaN, as np.median does, but without loading numpy.ma."""
    ordered, half = np.sort(values), len(values) // 2
    return float(ordered[half] if len(values) % 2 else 0.5 * (ordered[half - 1] + ordered[half]))


def percentiles_of(values: NDArray[Any], percents: Sequence[float]) -> list[float]:
    """Return percentiles of all `values`, bitwise as np.percentile does, but without loading numpy.ma.

    >>> percentiles_of(np.array([[3.0, 1.0], [2.0, 4.0]]), (0, 50, 100))
    [1.0, 2.5, 4.0]
    """
    places = np.asarray(percents) / 100.0 * (values.size - 1)
    below = np.floor(places).astype(np.intp)
    above = np.minimum(below + 1, values.size - 1)
    ends = [_two_in_order(values.reshape(-1), k, last) for k, last in zip(below, above, strict=True)]
    low, high = (np.array(each) for each in zip(*ends, strict=True))
    part = places - below
    step = high - low
    return [float(v) for v in np.where(part < 0.5, low + step * part, high - step * (1.0 - part))]


def _two_in_order(values: NDArray[Any], k: int, last: int) -> tuple[float, float]:
    """Return the values of ranks k and `last` = k + 1 or k of `values` (n,).

    Of many, only those between two of a sample are sorted, if both ranks are there.
    """
    if len(values) > _MANY:
        sample = np.sort(values[:: len(values) // _SAMPLE])
        place, slack = k * len(sample) // len(values), len(sample) // 64
        low, high = sample[max(0, place - slack)], sample[min(len(sample) - 1, place + slack)]
        between = values[(values >= low) & (values <= high)] if low < high else values[:0]
        before = int(np.count_nonzero(values < low))
        if before <= k and last < before + len(between):
            values, k, last = between, k - before, last - before
    ordered = np.partition(values, [k, last])
    return ordered[k], ordered[last]


def read_only(values: AnyArray) -> AnyArray:
    """Make `values` read-only, and return them."""
    values.flags.writeable = False
    return values


def array_like(values: NDArray[Any], like: Any, xp: Any) -> Any:
    """Return `values` as an array of `xp` (numpy or torch), on the device and in the precision of `like`.

    Complex values stay complex, real values stay real.
    """
    dtype = like.real.dtype
    if xp is np:
        return values.astype(
            np.result_type(dtype, np.complex64) if np.iscomplexobj(values) else dtype, copy=False
        )
    dtype = dtype.to_complex() if np.iscomplexobj(values) else dtype
    return xp.tensor(values, dtype=dtype, device=like.device)  # a copy: torch warns of read-only memory


def ring_of(nodes: AnyArray) -> AnyArray:
    """Return the four corners (4, ni-1, nj-1, ...) of cells of `nodes` (ni, nj, ...), counter-clockwise."""
    return np.stack([nodes[:-1, :-1], nodes[1:, :-1], nodes[1:, 1:], nodes[:-1, 1:]])  # type: ignore[return-value]


def planar_nodes(ni: int, nj: int) -> Floats:
    """Return an uninitialised array (ni, nj, 2) in planar layout: x and y are each contiguous in memory."""
    return np.moveaxis(np.empty((2, ni, nj)), 0, -1)


def as_planar(nodes: Floats) -> Floats:
    """Return `nodes` (ni, nj, ..., d) as float64 with each coordinate contiguous, copied only if needed."""
    last = nodes.ndim - 1
    planes = np.asarray(nodes, dtype=np.float64).transpose(last, *range(last))
    return np.ascontiguousarray(planes).transpose(*range(1, last + 1), 0)
