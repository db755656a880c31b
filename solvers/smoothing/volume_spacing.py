"""Target lengths of the edges of a given volume grid: its own, with noise and jumps diffused."""

import math
from functools import partial

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, Side
from meshonet.geometry.blocks.block import PLACES, face_of
from meshonet.geometry.elementary import log
from meshonet.geometry.volume.hex_mesh import HexMesh, exchange, second_layer
from meshonet.solvers.energy.hex_tables import BlockTargets, Targets

ROUNDS = 12  # number of diffusion steps; they act over about the square root of as many cells
_SHARE = 0.1  # fraction of the second differences in three directions by which an edge changes in a step
_OUTLIER = math.log(2.0)
"""Largest logarithmic difference between an edge and the mean of its neighbours in the first steps."""
_CLIPPED = 4  # number of steps in which this limit applies


def wanted_edges(mesh: HexMesh, moves: Bools, rounds: int = ROUNDS) -> Targets:
    """Return the logarithms of target lengths of a mesh's edges; the mask `moves` (n,) marks free nodes."""
    logs: list[BlockTargets] = [
        tuple(_logs(mesh.nodes[block], axis) for axis in range(3))  # type: ignore[misc]
        for block in mesh.blocks
    ]
    stays = [tuple(_stays(moves[block], axis) for axis in range(3)) for block in mesh.blocks]
    _fill_beyond(mesh, logs)
    for number in range(rounds):
        for edges, still in zip(logs, stays, strict=True):
            for axis in range(3):
                _diffuse(edges[axis], axis, still[axis], clip=number < _CLIPPED)
        _fill_beyond(mesh, logs)
    return logs


def _logs(nodes: Floats, axis: int) -> Floats:
    """Return logs of lengths along `axis`, NaN for one edge beyond either end, the median for length 0."""
    steps = np.diff(nodes, axis=axis)
    squares = (steps**2).sum(axis=-1)
    known = squares > 0.0
    least = float(np.median(squares[known])) if known.any() else 1.0
    logs = 0.5 * log(np.where(known, squares, least))
    return np.pad(logs, [(int(k == axis),) * 2 for k in range(3)], constant_values=np.nan)


def _stays(moves: Bools, axis: int) -> Bools:
    ends = np.moveaxis(moves, axis, 0)
    return np.moveaxis(~(ends[1:] | ends[:-1]), 0, axis)


def _fill_beyond(mesh: HexMesh, logs: list[BlockTargets]) -> None:
    """Copy the first edges on the other side of each connection to the entries beyond the sides."""

    def edges(number: int, side: Side) -> Floats:
        return logs[number][PLACES[side][0]]

    exchange(
        mesh.connections,
        lambda number, side: face_of(edges(number, side), side),
        lambda number, side: second_layer(edges(number, side), side),
    )


def _diffuse(logs: Floats, axis: int, stays: Bools, *, clip: bool) -> None:
    """Diffuse logarithms along `axis`, except those that are fixed."""
    own = np.moveaxis(np.moveaxis(logs, axis, 0)[1:-1], 0, axis)
    bend, mean, count = (np.zeros(own.shape) for _ in range(3))
    for direction in range(3):
        at = partial(np.moveaxis, source=direction, destination=0)
        values = at(logs) if direction == axis else at(own)
        if len(values) < 3:
            continue
        both = 0.5 * (values[2:] + values[:-2])
        known = np.isfinite(both)
        inner = slice(None) if direction == axis else slice(1, -1)
        at(bend)[inner] += np.where(known, 2.0 * (both - values[1:-1]), 0.0)
        at(mean)[inner] += np.where(known, both, 0.0)
        at(count)[inner] += known
    if clip:
        around = np.where(count > 0, mean / np.maximum(count, 1), own)
        own[...] = np.where(stays, own, np.clip(own, around - _OUTLIER, around + _OUTLIER))
    own += np.where(stays, 0.0, _SHARE * bend)
