"""Places on the two stretches of a periodic domain's outer loop, of which the second is the first, moved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshonet.geometry.arrays import Floats
from meshonet.geometry.domain.domain import Domain
from meshonet.geometry.polygon.corners import Indices

_SAME = 1e-9
"""Places nearer than this part of the loop are one."""


def within(stretch: tuple[float, float], arc: Floats, length: float) -> NDArray[np.bool_]:
    """Return which arc lengths (m,) of a loop lie inside a stretch, its ends left out."""
    along = np.mod(arc - stretch[0], length)
    return np.asarray(
        (along > _SAME * length) & (along < (stretch[1] - stretch[0]) % length - _SAME * length)
    )


def on_second(domain: Domain, loop: Indices, arc: Floats) -> NDArray[np.bool_]:
    """Return which places (m,) lie inside the second stretch: none where the domain is not periodic."""
    if domain.periodic is None:
        return np.zeros(len(arc), dtype=bool)
    return (loop == 0) & within(domain.periodic.second, arc, domain.loops[0].length)


def on_both(domain: Domain, loop: Indices, arc: Floats) -> tuple[Indices, Floats]:
    """Return places (m,) and their copies on the other stretch, each once; without a period just these."""
    periodic, length = domain.periodic, domain.loops[0].length
    if periodic is None:
        return loop, arc
    first = (loop == 0) & within(periodic.first, arc, length)
    second = on_second(domain, loop, arc)
    start, end = periodic.first[0], periodic.second[1]
    # the loop runs along the second stretch the other way
    along = np.sort(np.mod(np.concatenate([arc[first] - start, end - arc[second]]), length))
    along = along[np.diff(along, prepend=-length) > _SAME * length]
    rest = ~first & ~second
    added = np.mod(np.concatenate([start + along, end - along]), length)
    return (
        np.concatenate([loop[rest], np.zeros(len(added), dtype=loop.dtype)]),
        np.concatenate([arc[rest], added]),
    )
