"""First cells of exact height at walls, also of nodes next to two walls."""

from collections.abc import Callable

import numpy as np

from meshonet.geometry.arrays import Floats, dots, norms

_ROUNDS = 60  # largest number of rounds in which first cells of nodes next to two walls are made exact
_CLOSE = 1e-13


def exact_in_corners(
    nodes: Floats, begins: tuple[Floats, Floats], sizes: tuple[float, Floats],
    in_space: Callable[[Floats], Floats],
) -> Floats:  # fmt: skip
    """Return `nodes`, each moved so that it has the distances `sizes` from two points.

    Parameters
    ----------
    nodes : (..., 3) coordinates of nodes, which `in_space` converts.
    begins : first points and second points, each (..., 3), in the same coordinates.
    sizes : distance from the first point (one number for all nodes) and from the second point (an array).
    in_space : converts coordinates to x, y, z.
    """
    starts, before = [in_space(begin) for begin in begins], np.inf
    for _ in range(_ROUNDS):
        at = in_space(nodes)
        one, other = (at - start for start in starts)
        lengths = norms(one), norms(other)
        off = sizes[0] - lengths[0], sizes[1] - lengths[1]
        largest = float(max(np.abs(off[0]).max() / sizes[0], (np.abs(off[1]) / sizes[1]).max()))
        if largest < _CLOSE or largest >= before:
            break
        before = largest
        cosine = dots(one, other) / (lengths[0] * lengths[1])
        rest = 1.0 - cosine * cosine
        ways = (off[0] - cosine * off[1]) / rest, (off[1] - cosine * off[0]) / rest
        moves = [
            (way / length)[..., None] * (nodes - begin)
            for way, length, begin in zip(ways, lengths, begins, strict=True)
        ]
        nodes = nodes + moves[0] + moves[1]
    return nodes
