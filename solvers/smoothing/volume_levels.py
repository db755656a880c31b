"""A coarser copy of a hexahedral mesh with about every second node, and interpolation from it.

Nodes are counted from both ends of a line, so that blocks with opposite directions agree.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.blocks.block import PLACES
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.elementary import exp
from meshonet.geometry.volume.hex_mesh import HexMesh
from meshonet.solvers.energy.hex_tables import Targets

FEW = 12  # largest number of cells in a piece of a line that is not coarsened
SMALL = 4000  # largest number of nodes of a mesh without a coarser copy
FEWER = 0.6  # largest fraction of nodes in a useful copy


@dataclass(frozen=True, eq=False)
class CoarserCopy:
    """Copy of a mesh with fewer nodes."""

    mesh: HexMesh
    nodes: Indices  # (m,) for each node of the copy, its index in the finer mesh
    kept: tuple[tuple[Indices, Indices, Indices], ...]  # layers of nodes of each block that remain


def coarser(mesh: HexMesh) -> CoarserCopy | None:
    """Return a copy of a mesh with about half of the nodes along each direction; None for a small mesh."""
    kept = tuple(tuple(_halved(sorted(cuts)) for cuts in block) for block in _cuts(mesh))
    lattices = [block[np.ix_(*each)] for block, each in zip(mesh.blocks, kept, strict=True)]
    if len(mesh.nodes) <= SMALL or sum(each.size for each in lattices) > 0.6 * sum(
        b.size for b in mesh.blocks
    ):
        return None
    nodes = np.unique(np.concatenate([each.ravel() for each in lattices]))
    rank = np.full(len(mesh.nodes), -1)
    rank[nodes] = np.arange(len(nodes))
    joined = tuple(_thinned(each, kept) for each in mesh.connections)
    copy = HexMesh(mesh.nodes[nodes], tuple(rank[each] for each in lattices), joined)
    return CoarserCopy(copy, nodes, kept)  # type: ignore[arg-type]


def _cuts(mesh: HexMesh) -> list[tuple[set[int], set[int], set[int]]]:
    """Return, for each block and direction, the layers of nodes at which a connection starts or ends."""
    cuts = [({0, ni - 1}, {0, nj - 1}, {0, nk - 1}) for ni, nj, nk in (b.shape for b in mesh.blocks)]
    changed = True
    while changed:
        before = sum(len(each) for block in cuts for each in block)
        for connection in mesh.connections:
            for own, span, other, onto, opposed in _directions(connection):
                one, two = cuts[own[0]][own[1]], cuts[other[0]][other[1]]
                one |= set(span)
                two |= set(onto)
                inside = {k - span[0] for k in one if span[0] <= k <= span[1]}
                back = {k - onto[0] for k in two if onto[0] <= k <= onto[1]}
                length = span[1] - span[0]
                two |= {onto[0] + (length - k if opposed else k) for k in inside}
                one |= {span[0] + (length - k if opposed else k) for k in back}
        changed = sum(len(each) for block in cuts for each in block) > before
    return cuts


_Direction = tuple[tuple[int, int], tuple[int, int], tuple[int, int], tuple[int, int], bool]


def _directions(connection: Connection) -> Iterator[_Direction]:
    """Yield for both directions of a connection: block, axis and range of either side, whether reversed."""
    (block, side, spans), (donor, donor_side, donor_spans) = connection.ends
    own = [axis for axis in range(3) if axis != PLACES[side][0]]
    other = [axis for axis in range(3) if axis != PLACES[donor_side][0]]
    for axis, span, direction in zip(own, spans, connection.orientation, strict=True):
        at = abs(direction) - 1
        yield (block, axis), span, (donor, other[at]), donor_spans[at], direction < 0


def _halved(cuts: list[int]) -> Indices:
    """Return every second layer between cuts, counted from both ends."""
    kept = {cuts[0]}
    for a, b in pairwise(cuts):
        step = 2 if b - a > FEW else 1
        kept |= set(range(a, (a + b) // 2 + 1, step)) | set(range(b, (a + b + 1) // 2 - 1, -step))
    return np.array(sorted(kept))


def _thinned(connection: Connection, kept: tuple[tuple[Indices, ...], ...]) -> Connection:
    ranges = []
    for block, side, spans in connection.ends:
        axes = [axis for axis in range(3) if axis != PLACES[side][0]]
        ends = [np.searchsorted(kept[block][axis], span) for axis, span in zip(axes, spans, strict=True)]
        ranges.append(tuple((int(a), int(b)) for a, b in ends))
    return replace(connection, range=ranges[0], donor_range=ranges[1])


def carried(mesh: HexMesh, copy: CoarserCopy, values: Floats, targets: Targets) -> Floats:
    """Return `values` (m, 3) at the nodes of `copy`, interpolated to all nodes (n, 3) of `mesh`."""
    result = np.empty((len(mesh.nodes), 3))
    for block, coarse, kept, wanted in zip(mesh.blocks, copy.mesh.blocks, copy.kept, targets, strict=True):
        here = values[coarse]
        rest = list(kept)
        for axis in range(3):
            rest[axis] = np.arange(block.shape[axis])
            lengths = exp(np.moveaxis(wanted[axis], axis, 0)[1:-1])
            others = np.ix_(*(layers for k, layers in enumerate(rest) if k != axis))
            here = np.moveaxis(_between(np.moveaxis(here, axis, 0), kept[axis], lengths[:, *others]), 0, axis)
        result[block] = here
    return result


def _between(values: Floats, kept: Indices, lengths: Floats) -> Floats:
    """Return values (n, ..., 3) interpolated between layers `kept`, by the lengths (n-1, ...) of edges."""
    place = np.concatenate([np.zeros((1, *lengths.shape[1:])), np.cumsum(lengths, axis=0)])
    low = np.clip(np.searchsorted(kept, np.arange(len(place)), side="right") - 1, 0, len(kept) - 2)
    before, after = place[kept[low]], place[kept[low + 1]]
    part = ((place - before) / (after - before))[..., None]
    return np.asarray((1.0 - part) * values[low] + part * values[low + 1])
