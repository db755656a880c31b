"""Report of a file that is written or drawn: sizes, names, notes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from meshonet_cli.batch.item import Item
from meshonet_cli.report.timed import Timed
from meshonet_cli.terminal.errors import with_options

if TYPE_CHECKING:
    from meshonet.geometry.blocks.block import Block
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.geometry.blocks.grid import Grid


@dataclass
class Delivered(Timed):
    """Report of what was written: `facts` are for JSON, `text` and `notes` for messages."""

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
    """Return the report of the grid or boundary `what`; messages show `text` or, if empty, the topology."""
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
    cells = sum(block.cells for block in blocks)
    return {"blocks": len(blocks), "cells": cells, "interfaces": len(what.connections)}


def part_names(what: Grid | Boundary) -> dict[str, Any]:
    """Return the names of the patches of a grid or boundary for JSON."""
    names = [patch.name for patch in what.patches]
    return {"parts": list(dict.fromkeys(names)) if what.topology == "blocks" else names}
