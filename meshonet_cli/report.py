"""What is told about a result: as JSON, and as a few lines for people."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from meshonet_cli.member import Item

if TYPE_CHECKING:
    from meshonet.geometry.quality.measure import Quality
    from meshonet_cli.watching import Row


STAGES = ("read", "boundary", "load", "grid", "guard", "quality", "compare", "write")


@dataclass
class Timed:
    """Something done to a member of a batch: which, where the result is, and seconds by stage."""

    item: Item[Any]
    seconds: dict[str, float] = field(init=False)
    output: str | None = field(default=None, init=False)

    def __post_init__(self) -> None:
        self.seconds = {"read": self.item.seconds}

    @contextlib.contextmanager
    def timed(self, stage: str) -> Iterator[None]:
        """Add the time that the block takes to `stage`."""
        begun = time.perf_counter()
        yield
        self.seconds[stage] = self.seconds.get(stage, 0.0) + time.perf_counter() - begun

    def finished(self, path: str | None) -> None:
        """Note where the result is and add the stages up."""
        self.output = path
        known = [stage for stage in STAGES if stage in self.seconds]
        others = [stage for stage in self.seconds if stage not in STAGES]
        self.seconds = {stage: self.seconds[stage] for stage in known + others}
        self.seconds["total"] = sum(self.seconds.values())

    def member_json(self) -> dict[str, Any]:
        """Return for JSON which member this is, and where its result."""
        return {"input": self.item.source, "name": self.item.what.name, "output": self.output}

    def times(self) -> str:
        """Return the stages for people."""
        stages = [f"{name} {span(spent)}" for name, spent in self.seconds.items() if name != "total"]
        return f"{span(self.seconds['total'])}: {', '.join(stages)}"

    def times_json(self) -> dict[str, float]:
        """Return the stages for JSON, to the microsecond."""
        return {stage: round(spent, 6) for stage, spent in self.seconds.items()}


@dataclass
class Report(Timed):
    """The story of one grid, as ``--json`` prints it.

    `seconds` holds wall-clock seconds by stage: read, boundary, load (modules and models, once a process),
    grid (from boundary nodes in memory to grid nodes in memory), guard, quality, write, and total.
    """

    method: str
    ni: int
    nj: int
    topology: str
    quality: Quality
    model: str | None = None
    path: tuple[str, ...] = ()
    residual: float | None = None
    cycles: int | None = None
    notes: tuple[str, ...] = ()
    history: tuple[Row, ...] = ()

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        return {
            **self.member_json(),
            "method": self.method,
            "model": self.model,
            "ni": self.ni,
            "nj": self.nj,
            "topology": self.topology,
            "folded": self.quality.folded,
            "path": list(self.path),
            "residual": self.residual,
            "cycles": self.cycles,
            "quality": quality_json(self.quality),
            "seconds": self.times_json(),
            "notes": list(self.notes),
        }

    def lines(self) -> str:
        """Return the report of a single grid for people."""
        angle = self.quality["max_angle"]
        i, j = angle.worst
        rows = {
            "method": self.method + (f", model {self.model}" if self.model else "") + _after(self.path),
            "residual": f"{self.residual:.1e} after {self.cycles} cycle{'' if self.cycles == 1 else 's'}"
            if self.residual is not None
            else "",
            "folded": f"{self.quality.folded} of {self.quality.cells} cells",
            "max angle": f"{angle.max:.1f} degrees at i={i}, j={j}; mean {angle.mean:.1f}",
            "time": self.times(),
        }
        head = f"{self.item.label} -> {self.output}: {self.ni} x {self.nj} nodes, {self.topology} grid"
        notes = [f"  {note}" for note in self.notes]
        return "\n".join([head, *(f"  {name:<10} {text}" for name, text in rows.items() if text), *notes])

    def line(self) -> str:
        """Return the report of a member of a batch for people."""
        angle = self.quality["max_angle"].max
        return (
            f"{self.item.label} -> {self.output}: {self.ni} x {self.nj} {self.topology}, "
            f"{self.quality.folded} folded, max angle {angle:.1f}, "
            f"{self.method}{_after(self.path)}, {span(self.seconds['total'])}"
        )


def quality_json(quality: Quality) -> dict[str, Any]:
    """Return the quality of a grid as JSON; percentiles are left out when they were not computed."""
    told: dict[str, Any] = {"cells": quality.cells, "folded": quality.folded}
    for name, summary in quality.metrics.items():
        row: dict[str, Any] = {"min": summary.min, "mean": summary.mean, "max": summary.max}
        if summary.p01 is not None:
            row |= {"p01": summary.p01, "p99": summary.p99}
        told[name] = row | {"worst": list(summary.worst)}
    return told


def quality_table(quality: Quality) -> str:
    """Return the quality of a grid as a table for people; it needs the percentiles."""
    from meshonet.geometry.quality.metrics import METRICS

    head = ["metric", "min", "p01", "mean", "p99", "max", "worst at i, j"]
    rows = [head]
    for metric in METRICS:
        row = quality[metric.name]
        figures = [row.min, row.p01, row.mean, row.p99, row.max]
        name = f"{metric.name} ({metric.unit})" if metric.unit else metric.name
        rows.append(
            [
                name,
                *("-" if value is None else figure(value) for value in figures),
                "{}, {}".format(*row.worst),
            ]
        )
    return aligned(rows)


def aligned(rows: list[list[str]]) -> str:
    """Return `rows` as lines with columns aligned, the first to the left and the others to the right."""
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = []
    for row in rows:
        cells = [
            row[0].ljust(widths[0]),
            *(text.rjust(width) for text, width in zip(row[1:], widths[1:], strict=True)),
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


def figure(value: float) -> str:
    """Return a number as a table shows it.

    Examples
    --------
    >>> figure(90.12345), figure(0.000123456), figure(1234567.0), figure(0.0)
    ('90.12', '0.0001235', '1.235e+06', '0')
    """
    return f"{value:.4g}"


def explained(error: Exception, name: str = "") -> str:
    """Return the line or two that tell a user of `error`, which happened to the member `name`."""
    from meshonet.geometry.errors import InputError, MeshonetError

    if isinstance(error, InputError):
        error.source = error.source or name
        return error.text(option)
    where = f"{name}: " if name else ""
    if isinstance(error, MeshonetError):
        return f"{where}{error}"
    if isinstance(error, MemoryError):
        return f"{where}not enough memory ({error}); use a smaller --res".replace(" ()", "")
    if isinstance(error, OSError):
        file = f"{error.filename}: " if error.filename else where
        return f"{file}{error.strerror or error}; check the path, its permissions and the free space"
    return f"{where}internal error: {type(error).__name__}: {error}; this is a bug, --debug shows where"


def option(parameter: str) -> str:
    """Return how the command line spells a parameter.

    Examples
    --------
    >>> option("far_field")
    '--far-field'
    """
    return _OPTIONS.get(parameter) or "--" + parameter.replace("_", "-")


_OPTIONS = {"from_format": "--from", "to_format": "--to", "output": "-o"}
"""Parameters whose options have other names."""


def _after(path: tuple[str, ...]) -> str:
    return f", then {', '.join(path)}" if path else ""


def span(seconds: float) -> str:
    """Return a time span for people."""
    return f"{seconds:.2f} s" if seconds >= 1 else f"{1e3 * seconds:.1f} ms"
