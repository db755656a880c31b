"""Base of the reports of members of a batch: the member, its output file, and times."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from meshonet_cli.batch.item import Item
from meshonet_cli.terminal.errors import with_options
from meshonet_cli.terminal.text import span

if TYPE_CHECKING:
    from meshonet.geometry.blocks.block import Block
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.blocks.grid import Grid
    from meshonet_cli.terminal.summary import MemberRow

STAGES = ("read", "boundary", "load", "layout", "grid", "guard", "quality", "compare", "write")
"""Stages with reported times, in this order."""


@dataclass
class Timed:
    """Report of a member of a batch: the member, its output file, and seconds by stage."""

    item: Item[Any]
    notes: tuple[str, ...] = field(default=(), kw_only=True)
    seconds: dict[str, float] = field(init=False)
    output: str | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.seconds = {"read": self.item.seconds}

    @property
    def warning(self) -> str:
        """Warning that is printed even with ``--quiet``; empty if there is none."""
        return ""

    def row(self) -> MemberRow | None:
        """Return its row in a table, if it was judged."""
        return None

    def as_json(self) -> dict[str, Any]:
        """Return the data for ``--json``."""
        raise NotImplementedError

    def lines(self) -> str:
        """Return the full report as text."""
        raise NotImplementedError

    def line(self) -> str:
        """Return the report as one line for a batch."""
        return self.lines()

    def finished(self, path: str | None) -> None:
        """Store the output file and add up the stages, in the order of `STAGES`; others follow."""
        self.output = path
        in_order = sorted(self.seconds, key=(*STAGES, *self.seconds).index)
        self.seconds = {stage: self.seconds[stage] for stage in in_order}
        self.seconds["total"] = sum(self.seconds.values())

    def member_json(self) -> dict[str, Any]:
        """Return the member and its output file for JSON."""
        return {"input": self.item.source, "name": self.item.name, "output": self.output}

    def times(self) -> str:
        """Return the times of the stages as text."""
        stages = [f"{name} {span(spent)}" for name, spent in self.seconds.items() if name != "total"]
        return f"{span(self.seconds['total'])}: {', '.join(stages)}"

    def times_json(self) -> dict[str, float]:
        """Return the times of the stages for JSON, to the microsecond."""
        return {stage: round(spent, 6) for stage, spent in self.seconds.items()}


@dataclass
class Delivered(Timed):
    """Report of the content of a file: `facts` are for JSON, `text` and `notes` for messages."""

    facts: dict[str, Any]
    text: str

    def as_json(self) -> dict[str, Any]:
        """Return the data for ``--json``."""
        notes = {"notes": [with_options(note) for note in self.notes]} if self.notes else {}
        return {**self.member_json(), **self.facts, **notes, "seconds": self.times_json()}

    def lines(self) -> str:
        """Return the report as text."""
        head = f"{self.item.label} -> {self.output}: {self.text}, {self.times()}"
        return "\n  ".join([head, *map(with_options, self.notes)])


def delivered(
    item: Item[Any], what: Grid | Boundary, facts: dict[str, Any], text: str = "", notes: Sequence[str] = ()
) -> Delivered:
    """Return the report of a grid or boundary; `text` replaces the name of its topology."""
    counts, topology = _counts(what), what.topology
    size = (
        "{ni} x {nj} nodes" if "ni" in counts else "{blocks} blocks, {cells} cells, {interfaces} interfaces"
    )
    summary = f"{size.format(**counts)}, {text or topology}"
    return Delivered(item, {**counts, "topology": topology, **facts}, summary, notes=tuple(notes))


def _counts(what: Grid | Boundary) -> dict[str, int]:
    if what.topology != "blocks":
        return {"ni": what.ni, "nj": what.nj}
    blocks: tuple[Block, ...] = getattr(what, "blocks", ())
    cells = sum(math.prod(count - 1 for count in block.counts) for block in blocks)
    return {"blocks": len(blocks), "cells": cells, "interfaces": len(what.connections)}


def part_names(what: Grid | Boundary) -> dict[str, Any]:
    """Return the names of the patches of a boundary for JSON."""
    names = [patch.name for patch in what.patches]
    return {"parts": list(dict.fromkeys(names)) if what.topology == "blocks" else names}
