"""Cuts a layout in the plane of a passage map from inlet to outlet, and moves it next to the blade.

::

    inlet -------- cut, moved by the pitch -------- outlet      the cut runs along sides of blocks; its nodes
      |                                               |        occur twice, the second time as partners
    inlet ----------------- cut ------------------- outlet
"""

from __future__ import annotations

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.layout.lattice import lattice_quads
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.layout.quad_mesh import QuadMesh
from meshonet.geometry.polygon.corners import Indices
from meshonet.solvers.blocking.cascade.passage_map import PassageMap


def unwrap(layout: Layout, passage: PassageMap, cut: Indices) -> tuple[Layout, Indices]:
    """Return the layout of a passage in its own plane, cut along nodes (k,) on sides of blocks.

    Loops and arc lengths are those in the plane of the map. Also returned are the nodes (k,) of the lower
    side of the cut, starting at the inlet; the node above each has the next number and is its partner.
    """
    mesh = layout.mesh
    principal = passage.back(mesh.nodes)
    turns = _turns(layout, passage, principal, cut)
    low = min(int(turn.min()) for turn in turns)
    span = max(int(turn.max()) for turn in turns) - low + 1
    keys = [block * span + (turn - low) for block, turn in zip(layout.blocks, turns, strict=True)]
    kept, number = np.unique(np.concatenate([key.ravel() for key in keys]), return_inverse=True)
    source, shift = np.divmod(kept, span)
    pitch = np.array([passage.pitch.real, passage.pitch.imag])
    nodes = principal[source] + (shift + low)[:, None] * pitch
    places = mesh.places.take(source)
    first = np.searchsorted(source, cut)  # copies of a node follow each other, the lower one first
    places.partner[first + 1] = first
    nodes[first + 1] = nodes[first] + pitch
    parts = np.split(number.astype(np.intp), np.cumsum([block.size for block in layout.blocks])[:-1])
    blocks = tuple(part.reshape(block.shape) for part, block in zip(parts, layout.blocks, strict=True))
    return Layout(QuadMesh(mesh.domain, nodes, lattice_quads(blocks), places), blocks), first


def _turns(layout: Layout, passage: PassageMap, z: Floats, cut: Indices) -> list[Indices]:
    """Return how many pitches each node of each block is from where `back` puts it, `z` (n, 2).

    Neighbours agree along all sides but those of the cut.
    """
    along = passage.along(z)
    turns = []
    for block in layout.blocks:
        jump = np.zeros(block.shape)
        jump[1:, 0] = -np.cumsum(np.round(np.diff(along[block[:, 0]])))
        jump[:, 1:] = jump[:, :1] - np.cumsum(np.round(np.diff(along[block], axis=1)), axis=1)
        turns.append(jump.astype(np.intp))
    closed = np.zeros(len(z), dtype=bool)
    closed[cut] = True
    sides: dict[tuple[int, ...], list[tuple[int, int]]] = {}
    for number, (block, turn) in enumerate(zip(layout.blocks, turns, strict=True)):
        for rows in (np.s_[:, 0], np.s_[:, -1], np.s_[0], np.s_[-1]):
            line = block[rows]
            if not closed[line].all():
                first = int(np.argmin(line))
                sides.setdefault(tuple(sorted(line.tolist())), []).append((number, int(turn[rows][first])))
    moved = {0: 0}
    queue = [0]
    for number in queue:
        for pair in sides.values():
            mine = [own for which, own in pair if which == number]
            for which, other in pair if mine else ():
                if which not in moved:
                    moved[which] = moved[number] + mine[0] - other
                    queue.append(which)
    return [turn + moved[number] for number, turn in enumerate(turns)]
