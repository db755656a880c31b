"""Base of the reports of members of a batch."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from meshonet_cli.batch.item import Item
from meshonet_cli.terminal.text import span

if TYPE_CHECKING:
    from meshonet_cli.terminal.summary import MemberRow

STAGES = ("read", "boundary", "load", "layout", "grid", "guard", "quality", "compare", "write")
"""Stages with reported times, in this order."""


@dataclass
class Timed:
    """Report of a member of a batch: its output file, whether it was left out, the seconds of each stage."""

    item: Item[Any]
    notes: tuple[str, ...] = field(default=(), kw_only=True)
    seconds: dict[str, float] = field(default_factory=dict, init=False)
    output: str | None = field(default=None, init=False)
    left_out: bool = field(default=False, init=False)

    @property
    def warning(self) -> str:
        """Warning that is printed even with ``--quiet``; empty if there is none."""
        return ""

    def row(self) -> MemberRow | None:
        """Return the row of this grid in the table of a batch; None if its quality was not judged."""
        return None

    @property
    def failure(self) -> tuple[str, str, str, bool]:
        """Input, name, reason, and whether another try may succeed, for a dataset's list of failures."""
        row = self.row()
        limits = ", ".join(row.judgement.beyond) if row and row.judgement else ""
        return self.item.source, self.item.label, f"left out, as it fails: {limits}", False

    def as_json(self) -> dict[str, Any]:
        """Return the data for ``--json``."""
        raise NotImplementedError

    def lines(self) -> str:
        """Return the full report as text."""
        raise NotImplementedError

    def line(self) -> str:
        """Return the report as one line, for a batch."""
        return self.lines()

    def member_json(self) -> dict[str, Any]:
        """Return the input, the name and the output file of this grid or boundary, for ``--json``."""
        return {"input": self.item.source, "name": self.item.name, "output": self.output}

    @property
    def total(self) -> float:
        """Seconds of all stages together."""
        return sum(self.seconds.values(), start=self.item.seconds)

    def times(self) -> str:
        """Return the times of the stages as text."""
        stages = [f"{name} {span(spent)}" for name, spent in self._in_order().items()]
        return f"{span(self.total)}: {', '.join(stages)}"

    def times_json(self) -> dict[str, float]:
        """Return the times of the stages for JSON, to the microsecond."""
        times = {**self._in_order(), "total": self.total}
        return {stage: round(spent, 6) for stage, spent in times.items()}

    def _in_order(self) -> dict[str, float]:
        """Return the seconds in the order of `STAGES`, then others."""
        order, spent = (*STAGES, *self.seconds), {"read": self.item.seconds, **self.seconds}
        return dict(sorted(spent.items(), key=lambda item: order.index(item[0])))
