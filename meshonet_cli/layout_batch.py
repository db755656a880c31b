"""The layouts of `layout`, one after the other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshonet.formats.inputs import Inputs
from meshonet.geometry.layout.layout import Layout
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.spacing.sampling import Sampling
from meshonet.solvers.pipeline.blocks import make_layout
from meshonet.solvers.pipeline.request import GridRequest
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.executors.engine import HERE, Engine
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.run import process
from meshonet_cli.batch.sources import shape_items
from meshonet_cli.batch.timed import Timed
from meshonet_cli.errors import with_options
from meshonet_cli.session import Session


@dataclass
class LayoutReport(Timed):
    """The report of a layout: `facts` are its counts."""

    facts: dict[str, int]

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        notes = [with_options(note) for note in self.notes]
        return {**self.member_json(), **self.facts, "notes": notes, "seconds": self.times_json()}

    def lines(self) -> str:
        """Return it for people."""
        counts = ", ".join(f"{count} {name}" for name, count in self.facts.items())
        head = f"{self.item.label} -> {self.output}: {counts}, {self.times()}"
        return "\n  ".join([head, *map(with_options, self.notes)])


@dataclass(frozen=True)
class LayoutMaker:
    """Splits members of a batch into blocks."""

    request: GridRequest

    def __call__(self, item: Item[Shape]) -> tuple[Layout, LayoutReport]:
        """Return the layout of one shape and the report."""
        layout, stages = make_layout(item.what, self.request)
        mesh = layout.mesh
        facts = {
            "blocks": len(layout.blocks), "cells": layout.cells,
            "irregular": int(np.count_nonzero(mesh.irregular & ~mesh.wall_nodes)),
        }  # fmt: skip
        report = LayoutReport(item, facts, notes=mesh.domain.notes)
        report.seconds |= stages
        return layout, report


def write_layouts(
    inputs: Inputs, output: str, parameters: Mapping[str, Any], far_field: float | None,
    session: Session, *, assemble: bool = False, from_format: str | None = None, skip_existing: bool = False,
    engine: Engine = HERE,
) -> int:  # fmt: skip
    """Split the domains of `inputs`, or the one that they make, into blocks, and return the exit code."""
    sampling = Sampling(far_field=far_field)
    maker = LayoutMaker(GridRequest(sampling, **parameters))
    members = shape_items(inputs, from_format, session, sampling if assemble else None)
    return process(
        members, maker, Destination(output, "layout", "layouts"),
        session, skip_existing=skip_existing, engine=engine,
    )  # fmt: skip
