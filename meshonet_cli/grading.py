"""What `quality` does with each grid."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from formats.registry import read_grids
from geometry.compare import Difference, compare
from geometry.errors import BadCell, InputError
from geometry.grid import Grid
from geometry.profiles import Figures, Judgement, judge
from geometry.quality import Quality, measure, worst_cells
from meshonet_cli.batch import Destination, items
from meshonet_cli.gates import Gate
from meshonet_cli.judging import (
    judgement_json,
    judgement_table,
    problems,
    walls,
    walls_json,
    walls_table,
)
from meshonet_cli.member import Item
from meshonet_cli.report import Timed, figure, quality_json, quality_table
from meshonet_cli.session import Session


@dataclass
class Grade(Timed):
    """What there is to tell of a grid."""

    grid: Grid
    quality: Quality
    worst: Sequence[BadCell]
    figures: Figures
    judgement: Judgement | None = None
    difference: Difference | None = None

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        told: dict[str, Any] = {
            "input": self.item.source,
            "name": self.item.what.name,
            "ni": self.grid.ni,
            "nj": self.grid.nj,
            "topology": self.grid.topology,
            "folded": self.quality.folded,
            "worst_cells": [vars(cell) for cell in self.worst],
            "quality": quality_json(self.quality),
            "walls": walls_json(self.figures.wall_rows),
        }
        if self.judgement:
            told |= judgement_json(self.figures, self.judgement)
        if self.difference:
            told["compare"] = vars(self.difference) | {"at": list(self.difference.at)}
        return told | {"seconds": self.times_json()}

    def lines(self) -> str:
        """Return the table for people."""
        grid, quality = self.grid, self.quality
        folded = f"{quality.folded} folded" if quality.folded else "none folded"
        size = f"{grid.ni} x {grid.nj} nodes, {grid.topology} grid, {quality.cells} cells"
        rows = [f"{self.item.label}: {size}, {folded}", quality_table(quality)]
        if self.figures.wall_rows and (self.judgement or grid.topology != "quad"):
            rows.append(walls_table(self.figures.wall_rows))
        if self.judgement:
            rows.append(judgement_table(self.figures, self.judgement))
        rows += [f"folded at i={c.i}, j={c.j}: x={c.x:.6g}, y={c.y:.6g}" for c in self.worst]
        if self.difference:
            d = self.difference
            rows.append(
                f"distance to the other grid: max {figure(d.max)} at i={d.at[0]}, j={d.at[1]}, "
                f"mean {figure(d.mean)}, relative L2 {figure(d.relative_l2)}"
            )
        return "\n".join(rows)


def grade_grids(
    sources: Sequence[str],
    session: Session,
    gates: Sequence[Gate],
    *,
    fmt: str | None = None,
    other: str | None = None,
    profile: str | None = None,
    outputs: Sequence[Destination] = (),
) -> int:
    """Measure every grid of `sources`, print what there is to tell and return the exit code.

    Parameters
    ----------
    other : grid file to compare with: its one grid with each, or its grids one by one.
    profile : thresholds of `geometry.profiles` to judge by.
    outputs : figures and files of metrics to write of each grid.
    """
    for destination in outputs:
        destination.check_room(sources)
        if destination.text == "-":
            raise InputError("standard output has the table", "write to a file", source="-")
    others = _partners(other) if other else None
    for item in items(sources, lambda source: read_grids(source, fmt), session):
        with session.member(item.label, item.source):
            grade = _graded(item, profile, others)
            for destination in outputs:
                destination.check_only(item)
                with grade.timed("write"):
                    destination.write(destination.path(item), [item.what])
            grade.finished(None)
            session.show(grade)
            session.gate(item.label, [told for gate in gates if (told := gate.broken(grade.quality))])
            session.gate(item.label, problems(grade.judgement) if grade.judgement else [])
    return session.finish()


def _graded(item: Item[Grid], profile: str | None, others: Iterator[Grid] | None) -> Grade:
    begun = time.perf_counter()
    quality = measure(item.what, percentiles=True)
    worst = worst_cells(item.what.nodes) if quality.folded else []
    figures = Figures(item.what, quality, walls(item.what))
    grade = Grade(item, item.what, quality, worst, figures, judge(figures, profile) if profile else None)
    grade.seconds["quality"] = time.perf_counter() - begun
    if others is not None:
        with grade.timed("compare"):
            other = next(others, None)
            if other is None:
                raise InputError(
                    "there is no grid to compare it with", "compare with one grid, or with as many"
                )
            grade.difference = compare(item.what, other)
    return grade


def _partners(text: str) -> Iterator[Grid]:
    """Yield the grids of `text` one by one, or its only one again and again."""
    found = read_grids(text)
    grid, following = next(found), next(found, None)
    yield grid
    while following is None:
        yield grid
    yield following
    yield from found
