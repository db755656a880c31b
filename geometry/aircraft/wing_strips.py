"""Strips of a wing from patches of a surface, in order around its sections."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, norms
from meshonet.geometry.curves.monotone import monotone_cubic
from meshonet.geometry.errors import InputError, place_of
from meshonet.geometry.polygon.area import polygon_area
from meshonet.geometry.polygon.corners import angle_between

_CORNER = np.pi / 3.0  # smallest turn of a section at a corner of the trailing edge
_PART = 0.5  # smallest span of a strip, relative to the longest; shorter patches close the tip
_EDGE, _BASE = 0.03, 0.1  # largest distance of a base from the trailing edge, and largest length, in chords
_GAP = 0.05  # largest distance of neighbouring strips, in chords
_LEVELS = 5  # number of heights at which strips are compared


@dataclass(frozen=True, eq=False)
class _Strip:
    """Nodes (stations, n, 3) of a strip, and nodes (_LEVELS, n, 3) at some heights."""

    nodes: Floats
    rows: Floats

    def turned(self) -> "_Strip":
        return _Strip(self.nodes[:, ::-1], self.rows[:, ::-1])


def wing_strips(patches: Sequence[Floats], name: str) -> tuple[tuple[Floats, ...], tuple[int, ...]]:
    """Return strips (stations, n, 3) of nodes from root to tip, and indices of patches that close the tip.

    `patches` (ni, nj, 3) form the surface of a wing, where z >= 0. Patches on a blunt trailing edge are left
    out. `name` is used in messages. Raises InputError: a gap between patches around the wing; patches without
    a common part of the span; patches that do not end at the trailing edge.
    """
    turned = [_from_root(patch) for patch in patches]
    spans = np.array([float((nodes[-1, :, 2] - nodes[0, :, 2]).mean()) for nodes in turned])
    long = spans >= _PART * spans.max()
    parts = [part for nodes, fit in zip(turned, long, strict=True) if fit for part in _between_corners(nodes)]
    begin = max(float(part[0, :, 2].max()) for part in parts)
    end = min(float(part[-1, :, 2].min()) for part in parts)
    if not begin < end:
        problem = f"the patches of the {name} do not lie beside each other along the span"
        raise InputError(problem, "give those from its root to its tip")
    z = begin + (end - begin) * np.linspace(0.1, 0.8, _LEVELS)
    strips = [_Strip(part, at_heights(part, z)) for part in parts]
    x = np.concatenate([strip.rows[..., 0] for strip in strips], axis=1)
    back, chord = x.max(axis=1), np.ptp(x, axis=1)
    chain = _chained(strips, chord, name)
    base = [_is_base(strip, back, chord) for strip in chain]
    chain = _from_edge(chain, base, back, chord, name)
    loop = np.concatenate([strip.rows[_LEVELS // 2] for strip in chain])
    if polygon_area(loop[:, :2]) < 0.0:
        chain = [strip.turned() for strip in chain[::-1]]
    return tuple(strip.nodes for strip in chain), tuple(np.flatnonzero(~long).tolist())


def at_heights(strip: Floats, z: Floats) -> Floats:
    """Return nodes (k, n, 3) at `z` (k,) on the lines of a strip (stations, n, 3), even beyond their ends."""
    return np.stack([on_line(strip[:, k], z) for k in range(strip.shape[1])], axis=1)


def on_line(line: Floats, z: Floats) -> Floats:
    """Return points (k, 3) at `z` (k,) on a line (stations, 3), which is extrapolated beyond its ends."""
    return monotone_cubic(line[:, 2], line, z, linear=True)


def _from_root(patch: Floats) -> Floats:
    if np.abs(patch[-1, :, 2] - patch[0, :, 2]).mean() < np.abs(patch[:, -1, 2] - patch[:, 0, 2]).mean():
        patch = patch.swapaxes(0, 1)
    return patch if patch[-1, :, 2].mean() > patch[0, :, 2].mean() else patch[::-1]


def _between_corners(nodes: Floats) -> list[Floats]:
    steps = np.diff(nodes, axis=1)
    turns = angle_between(steps[:, :-1], steps[:, 1:])
    corners = np.flatnonzero(np.median(turns, axis=0) > _CORNER) + 1
    bounds = [0, *corners.tolist(), nodes.shape[1] - 1]
    return [nodes[:, first : last + 1] for first, last in pairwise(bounds)]


def _chained(strips: Sequence[_Strip], chord: Floats, name: str) -> list[_Strip]:
    """Return the strips in order around the wing, each from where the last one ends."""
    chain, left, gaps = [strips[0]], list(strips[1:]), []
    while left:
        end = chain[-1].rows[:, -1]
        tried = [turned for strip in left for turned in (strip, strip.turned())]
        apart = [float((norms(each.rows[:, 0] - end) / chord).mean()) for each in tried]
        nearest = int(np.argmin(apart))
        gaps.append(apart[nearest])
        chain.append(tried[nearest])
        del left[nearest // 2]
    gaps.append(float((norms(chain[0].rows[:, 0] - chain[-1].rows[:, -1]) / chord).mean()))
    if max(gaps) > _GAP:
        at = int(np.argmax(gaps))
        where = f"at {place_of(chain[at].rows[0, -1])}"
        problem = f"a patch of the {name} ends {gaps[at]:.2g} chords from the next one, {where}"
        raise InputError(problem, "give all patches around the wing, from its root to its tip")
    return chain


def _is_base(strip: _Strip, back: Floats, chord: Floats) -> bool:
    """Return whether a strip is part of the base, at trailing edges x = `back` (_LEVELS,)."""
    length = norms(np.diff(strip.rows, axis=1)).sum(axis=1)
    near = strip.rows[..., 0].min(axis=1) >= back - _EDGE * chord
    return bool((near & (length <= _BASE * chord)).all())


def _from_edge(chain: list[_Strip], base: list[bool], back: Floats, chord: Floats, name: str) -> list[_Strip]:
    """Return the chain from one side of the trailing edge to the other, without its base."""
    starts = [float(((back - strip.rows[:, 0, 0]) / chord).mean()) for strip in chain]
    known = [k for k in range(len(chain)) if base[k - 1] and not base[k]]
    first = known[0] if known else int(np.argmin(starts))
    chain, base = chain[first:] + chain[:first], base[first:] + base[:first]
    if starts[first] > _EDGE or all(base):
        problem = f"the patches of the {name} do not end at its trailing edge"
        raise InputError(problem, "give patches with a side there")
    return [strip for strip, left_out in zip(chain, base, strict=True) if not left_out]
