"""The rigid motion between two connected sides, from their nodes: files differ in its sign."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from meshonet.geometry.arrays import Floats, extent_of, norms
from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.connection import Connection
from meshonet.geometry.blocks.find_connections import TOLERANCE
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.elementary import product
from meshonet.geometry.errors import InputError
from meshonet.geometry.linear import nearest_rotation

LOOSE = 1e-3  # largest distance of connected nodes, relative to the shortest edge along their side
_DIGITS = range(1, 18)  # possible numbers of significant digits of a translation in a file


def matched(connection: Connection, blocks: Sequence[Block]) -> Connection:
    """Return `connection` with the motion (translation or rotation) that maps its side onto the donor's side.

    Raises InputError if the sides have different node counts, or if no motion makes their nodes coincide.
    """
    own, donor = connection.nodes(lambda block, side: blocks[block].face(side))
    if own.shape != donor.shape:
        counts = (" x ".join(str(n - 1) for n in nodes.shape[:-1]) for nodes in (own, donor))
        raise InputError(f"{connection} joins {' cells to '.join(counts)}", "join equal counts, one to one")
    edges = [norms(np.diff(own, axis=k)) for k in range(own.ndim - 1)]
    edge = min(float(lengths.min()) for lengths in edges)
    own, donor = (nodes.reshape(-1, nodes.shape[-1]) for nodes in (own, donor))
    reach = max(LOOSE * edge, TOLERANCE * extent_of(own))
    for motion in _motions(own, donor):
        if np.abs(motion(own) - donor).max() <= reach:
            return replace(connection, transform=motion if motion.shift or motion.turn else None)
    problem = f"{connection} joins nodes that no shift or rotation makes the same"
    raise InputError(problem, "correct its ranges, or leave it out")


def like_others(connection: Connection, motions: list[Motion]) -> Connection:
    """Return a periodic connection, its motion replaced by the one of `motions` that nearly equals it.

    Without such a motion its own is kept, and added to `motions`. Nearly equal motions thus become identical.
    """
    for known in motions:
        for each in (connection, connection.reversed()):
            if each.transform and known.alike(each.transform, LOOSE):
                return replace(each, transform=known)
    motions.append(connection.transform or Motion())
    return connection


def _motions(own: Floats, donor: Floats) -> Iterator[Motion]:
    """Yield possible motions from nodes `own` (n, d) to `donor`: none, translations, a rotation."""
    yield Motion()
    shift = (donor - own).mean(axis=0).tolist()
    for digits in _DIGITS:  # one that was meant makes the very nodes
        motion = Motion(tuple(float(f"{x:.{digits}g}") for x in shift))
        if np.array_equal(motion(own), donor):
            yield motion
    yield Motion(tuple(shift))
    rows = _turn(own, donor)
    if rows:
        shift = (donor - Motion((), rows)(own)).mean(axis=0).tolist()
        about_origin = math.hypot(*shift) <= TOLERANCE * math.hypot(*own.mean(axis=0))
        yield Motion((0.0,) * len(shift) if about_origin else tuple(shift), rows)


def _turn(own: Floats, donor: Floats) -> tuple[tuple[float, ...], ...]:
    """Return the rows of the (least-squares) rotation between sides (n, d); none for sides without extent."""
    if own.shape[1] == 2:
        here, there = (nodes[-1] - nodes[0] for nodes in (own, donor))
        if not here.any():
            return ()
        turn = complex(*there) / complex(*here)
        turn /= abs(turn) or 1.0
        return (turn.real, -turn.imag), (turn.imag, turn.real)
    rotation = nearest_rotation(product((donor - donor.mean(axis=0)).T, own - own.mean(axis=0)))
    return tuple(map(tuple, rotation.tolist()))
