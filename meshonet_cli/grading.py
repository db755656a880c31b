"""What `quality` does with each grid."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import BadCell, InputError
from meshonet.geometry.quality.compare import Difference, compare
from meshonet.geometry.quality.measure import Quality, measure, worst_cells
from meshonet.geometry.quality.profiles import Figures, Judgement, judge
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.item import Item
from meshonet_cli.batch.sources import items
from meshonet_cli.gates import Gate
from meshonet_cli.judging import (
    judgement_json,
    judgement_table,
    problems,
    walls,
    walls_json,
    walls_table,
)
from meshonet_cli.pairing import Pairing, Partners
from meshonet_cli.report import Timed, figure, quality_json, quality_table
from meshonet_cli.session import Session
from meshonet_cli.summing import Total


@dataclass
class Grade(Timed):
    """What there is to tell of a grid."""

    grid: Grid
    quality: Quality
    worst: Sequence[BadCell]
    figures: Figures
    judgement: Judgement | None = None
    comparison: Comparison | None = None

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
        if self.comparison:
            told["compare"] = self.comparison.as_json()
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
        if self.comparison:
            rows.append(self.comparison.lines())
        return "\n".join(rows)

    def figures_of_row(self) -> dict[str, float]:
        """Return the figures that a summary of many grids shows."""
        angle = self.quality["max_angle"]
        row = {"folded": self.quality.folded, "max_angle": angle.max, "mean_angle": angle.mean}
        return row | (self.comparison.figures() if self.comparison else {})


COMPARED = (
    "relative_l2", "near_wall", "max", "boundary", "folded_other", "max_angle_ratio", "mean_angle_ratio",
)  # fmt: skip
"""Figures of a comparison, in the order of `Comparison.figures`; gates may name them."""


@dataclass(frozen=True)
class Comparison:
    """How far a grid is from another one, and how its angles compare."""

    difference: Difference
    folded: int
    max_angle_ratio: float
    mean_angle_ratio: float

    def figures(self) -> dict[str, float]:
        """Return the figures by name."""
        d = self.difference
        return {
            "relative_l2": d.relative_l2,
            "near_wall": d.near_wall,
            "max": d.max,
            "boundary": d.boundary,
            "folded_other": self.folded,
            "max_angle_ratio": self.max_angle_ratio,
            "mean_angle_ratio": self.mean_angle_ratio,
        }

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        d = self.difference
        return {"max": d.max, "mean": d.mean, "at": list(d.at), **self.figures()}

    def lines(self) -> str:
        """Return it for people."""
        d = self.difference
        return (
            f"distance to the other grid: max {figure(d.max)} at i={d.at[0]}, j={d.at[1]}, "
            f"mean {figure(d.mean)}, relative L2 {figure(d.relative_l2)}, "
            f"near the wall {figure(d.near_wall)}, boundary {figure(d.boundary)}\n"
            f"beside the other grid: {self.folded} folded there, max angle {self.max_angle_ratio:.4f} and "
            f"mean angle {self.mean_angle_ratio:.4f} times as large"
        )


def grade_grids(
    sources: Sequence[str],
    session: Session,
    gates: Sequence[Gate],
    *,
    fmt: str | None = None,
    other: str | None = None,
    pairing: Pairing = "auto",
    profile: str | None = None,
    summary: bool = False,
    outputs: Sequence[Destination] = (),
) -> int:
    """Measure every grid of `sources`, print what there is to tell and return the exit code.

    Parameters
    ----------
    other : file of grids to compare with.
    pairing : which of them goes with which, see `meshonet_cli.pairing`.
    summary : print one table over all grids in place of one for each.
    profile : thresholds of `meshonet.geometry.quality.profiles` to judge by.
    outputs : figures and files of metrics to write of each grid.
    """
    for destination in outputs:
        destination.check_room(sources)
        if destination.text == "-":
            raise InputError("standard output has the table", "write to a file", source="-")
    others = Partners(read_grids(other), pairing) if other else None
    rows: list[tuple[str, Mapping[str, float]]] = []
    for item in items(sources, lambda source: read_grids(source, fmt), session):
        with session.member(item.label, item.source):
            grade = _graded(item, profile, others)
            for destination in outputs:
                destination.check_only(item)
                with grade.timed("write"):
                    destination.write(destination.path(item), [item.what])
            grade.finished(None)
            rows.append((item.label, grade.figures_of_row()))
            if summary:
                session.done += 1
            else:
                session.show(grade)
            more = grade.comparison.figures() if grade.comparison else {}
            session.gate(item.label, [told for gate in gates if (told := gate.broken(grade.quality, more))])
            session.gate(item.label, problems(grade.judgement) if grade.judgement else [])
    if rows and summary:
        session.conclude(Total(rows))
    return session.finish()


def _graded(item: Item[Grid], profile: str | None, others: Partners | None) -> Grade:
    begun = time.perf_counter()
    quality = measure(item.what, percentiles=True)
    worst = worst_cells(item.what.nodes) if quality.folded else []
    figures = Figures(item.what, quality, walls(item.what))
    grade = Grade(item, item.what, quality, worst, figures, judge(figures, profile) if profile else None)
    grade.seconds["quality"] = time.perf_counter() - begun
    if others is not None:
        with grade.timed("compare"):
            grade.comparison = _compared(item.what, quality, others.of(item.what.name))
    return grade


def _compared(grid: Grid, quality: Quality, other: Grid) -> Comparison:
    difference = compare(grid, other)
    own, theirs = quality["max_angle"], measure(other)
    angle = theirs["max_angle"]
    return Comparison(difference, theirs.folded, own.max / angle.max, own.mean / angle.mean)
