"""Report of one grid: how it was made, and its quality."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from meshonet.geometry.notes import changes_in
from meshonet.geometry.summary import named
from meshonet_cli.report.timed import Timed
from meshonet_cli.terminal.errors import with_options
from meshonet_cli.terminal.text import span

if TYPE_CHECKING:
    from meshonet.geometry.aircraft.dimensions import AircraftDimensions
    from meshonet.geometry.quality.blocks import BlockCounts
    from meshonet.geometry.quality.gates import Judgement
    from meshonet.geometry.rows.dimensions import RowDimensions
    from meshonet.geometry.summary import Quality
    from meshonet.solvers.neural.confidence import Confidence
    from meshonet.solvers.progress import HistoryRow
    from meshonet_cli.terminal.summary import MemberRow

_METHODS = {"conformal": "conformal map"}  # descriptions of methods whose names are not clear


@dataclass
class Report(Timed):
    """Report of a grid.

    `wake` is the number of cells along the wake of a C grid, else 0. `seconds` are the wall-clock seconds by
    stage: read, boundary, load (modules, models), grid, guard (repair of cells), quality, write, total.
    """

    method: str
    ni: int | None
    nj: int | None
    topology: str
    wake: int
    quality: Quality
    model: str | None = None
    path: tuple[str, ...] = ()
    residual: float | None = None
    cycles: int | None = None
    history: tuple[HistoryRow, ...] = ()
    blocks: BlockCounts | None = None
    judgement: Judgement | None = None
    confidence: Confidence | None = None
    dimensions: RowDimensions | AircraftDimensions | None = None

    @property
    def warning(self) -> str:
        """Warning about folded cells; empty if there are none."""
        folded = self.quality.folded
        return f"{self.item.label}: {folded} folded cells are in {self.output}" if folded else ""

    def row(self) -> MemberRow | None:
        """Return the row of the grid for the table of verdicts; None if the grid was not judged."""
        if not self.judgement:
            return None
        from meshonet_cli.terminal.summary import MemberRow, figures

        return MemberRow(self.item.label, figures(self.quality), self.judgement)

    def as_json(self) -> dict[str, Any]:
        """Return the data for ``--json``."""
        from meshonet.geometry.quality.blocks import BlockFigures
        from meshonet.geometry.quality.report import profile_dict, quality_dict
        from meshonet_cli.terminal.summary import gates_not_met

        figures = self.blocks.as_dict() if isinstance(self.blocks, BlockFigures) else None
        blocks = {} if figures is None else {"cells": self.quality.cells, **figures}
        sizes = {} if self.dimensions is None else {self.dimensions.kind: asdict(self.dimensions)}
        checked = self.judgement.profile if self.judgement else None
        return {
            **self.member_json(), **sizes, "method": self.method, "model": self.model,
            "ni": self.ni, "nj": self.nj, "topology": self.topology, **self._along_wall(), **blocks,
            "folded": self.quality.folded, "path": list(self.path), "confidence": self._confidence_json(),
            "residual": self.residual, "cycles": self.cycles,
            "quality": quality_dict(self.quality), "seconds": self.times_json(),
            "notes": [with_options(note) for note in self.notes], "changes": list(changes_in(self.notes)),
            "gates_not_met": gates_not_met(self.judgement),
            **({"profile": profile_dict(checked)} if checked else {}),
        }  # fmt: skip

    def lines(self) -> str:
        """Return the full report, which is printed for a single grid, as text."""
        angle = self.quality["max_angle"]
        kind = "multi-block" if self.topology == "blocks" else self.topology
        head = f"{self.item.label} -> {self.output}: {self._size()}, {kind} grid"
        if self.wake:
            counts = self._along_wall()
            head += f" with {counts['body_nodes']} nodes on the body and {counts['wake_nodes']} on the wake"
        lines = [head]
        if self.dimensions is not None:
            lines += [f"{name:10} {text}" for name, text in self.dimensions.lines.items()]
        lines.append(f"method     {self._made()}" + (f", model {self.model}" if self.model else ""))
        if self.confidence is not None:
            judged = "accepted" if self.confidence.accepted else "not accepted"
            limit = f"threshold {self.confidence.threshold:g}"
            lines.append(
                f"confidence expected error {self.confidence.expected_error:.1e}, {judged} ({limit})"
            )
        if self.residual is not None:
            cycles = f"after {self.cycles} cycle{'' if self.cycles == 1 else 's'}"
            when = cycles if self.cycles else "in the initial grid: no cycles needed"
            lines.append(f"residual   {self.residual:.1e} {when}")
        lines += [
            f"folded     {self.quality.folded} of {self.quality.cells} cells",
            f"max angle  {angle.max:.1f} degrees at {named(angle.worst)}; mean {angle.mean:.1f}",
            f"time       {self.times()}",
        ]
        lines += map(with_options, self.notes)
        if self.judgement and self.judgement.profile:
            from meshonet_cli.report.quality import profile_table

            lines += profile_table(self.judgement.profile).splitlines()
        return "\n  ".join(lines)

    def _confidence_json(self) -> dict[str, Any] | None:
        if self.confidence is None:
            return None
        facts = asdict(self.confidence)
        return facts if math.isfinite(facts["expected_error"]) else {**facts, "expected_error": None}

    def line(self) -> str:
        """Return the short report for batches: one line, then a line for each change of the input."""
        angle = self.quality["max_angle"].max
        head = (
            f"{self.item.label} -> {self.output}: {self._size(short=True)}, "
            f"{self.quality.folded} folded, max angle {angle:.1f}, "
            f"{self._made()}, {span(self.total)}"
        )
        if self.confidence is not None:
            head += f", expected error {self.confidence.expected_error:.1e}"
        return "\n  ".join([head, *changes_in(self.notes)])

    def _along_wall(self) -> dict[str, int]:
        """Return the numbers of nodes on body and wake of a C grid; the trailing edge is in both."""
        if self.ni is None or not self.wake:
            return {}
        return {"body_nodes": self.ni - 2 * self.wake, "wake_nodes": self.wake + 1}

    def _made(self) -> str:
        """Return the method and the stages after it."""
        method = _METHODS.get(self.method, self.method)
        return f"{method}, then {', '.join(self.path)}" if self.path else method

    def _size(self, *, short: bool = False) -> str:
        if self.ni is None and self.blocks is None:
            return f"{self.quality.cells} cells"
        if self.blocks is None:
            return f"{self.ni} x {self.nj} {self.topology if short else 'nodes'}"
        count = len(self.blocks.sizes)
        size = f"{count} block{'' if count == 1 else 's'}, {self.quality.cells} cells"
        if self.blocks.irregular is None:
            return size
        irregular = len(self.blocks.irregular)
        return f"{size}, {irregular or 'no'} irregular {'vertex' if irregular == 1 else 'vertices'}"
