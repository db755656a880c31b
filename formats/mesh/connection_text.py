"""The connections of a grid of blocks as JSON, for files that have room for text."""

import json
from collections.abc import Iterable
from dataclasses import asdict, astuple
from typing import Any

from meshonet.geometry.blocks.block import Range
from meshonet.geometry.blocks.connection import Connection, Motion
from meshonet.geometry.errors import InputError


def connections_text(connections: Iterable[Connection]) -> str:
    """Return connections as JSON: their fields in order, the transform as an object or null."""
    return json.dumps([[*astuple(c)[:-1], asdict(c.transform) if c.transform else None] for c in connections])


def connections_from(text: str) -> tuple[Connection, ...]:
    """Return the connections of a JSON text (`connections_text`)."""
    try:
        rows = json.loads(text or "[]")
        return tuple(
            Connection(k, side, _range(span), donor, face, _range(other), tuple(ways), _motion(move))
            for k, side, span, donor, face, other, ways, move in rows
        )
    except (ValueError, TypeError, KeyError, RecursionError):
        raise InputError("its connections are not those of blocks", "write the dataset again") from None


def _range(span: list[list[int]]) -> Range:
    return tuple((int(first), int(last)) for first, last in span)


def _motion(move: dict[str, Any] | None) -> Motion | None:
    return Motion(tuple(move["shift"]), tuple(map(tuple, move["turn"]))) if move else None
