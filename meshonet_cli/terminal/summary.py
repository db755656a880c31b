"""Table of many grids, with median, mean, 90th percentile and worst value of every column."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from meshonet.geometry.quality.gates import VERDICTS, verdict_word
from meshonet_cli.terminal.errors import with_options
from meshonet_cli.terminal.text import aligned, figure

if TYPE_CHECKING:
    from meshonet.geometry.quality.gates import Judgement
    from meshonet.geometry.summary import Quality

LABELS = {
    "folded": "folded", "max_angle": "max angle", "mean_angle": "mean angle", "relative_l2": "rel L2",
    "near_wall": "near wall", "max": "max", "boundary": "boundary", "folded_other": "folded there",
    "max_angle_ratio": "max ratio", "mean_angle_ratio": "mean ratio",
}  # fmt: skip
"""Headings of the columns."""


def figures(quality: Quality) -> dict[str, float]:
    """Return quality measures of a grid, by name of their column in a table of many grids."""
    angle = quality["max_angle"]
    return {"folded": quality.folded, "max_angle": angle.max, "mean_angle": angle.mean}


def gates_not_met(judgement: Judgement | None) -> list[str]:
    """Return the quality limits by which a grid fails, as texts for JSON."""
    return [with_options(problem) for problem in judgement.problems] if judgement else []


@dataclass(frozen=True)
class MemberRow:
    """Name, quality and verdict of a grid, a row of `BatchSummary`; `figures` is empty for a failed input."""

    label: str
    figures: Mapping[str, float] = field(default_factory=dict)
    judgement: Judgement | None = None

    @property
    def verdict(self) -> str:
        """One of `VERDICTS`; empty if the grid was not judged."""
        return (self.judgement.verdict if self.judgement else "") if self.figures else "error"


@dataclass(frozen=True)
class BatchSummary:
    """Table of the values of many grids, and of their verdicts if they are `judged`."""

    rows: Sequence[MemberRow]
    judged: bool = False

    @property
    def members(self) -> list[MemberRow]:
        """Rows of the members that did not fail."""
        return [row for row in self.rows if row.figures]

    def as_json(self) -> dict[str, Any]:
        """Return the data for ``--json``."""
        facts: dict[str, Any] = {"members": len(self.members)}
        for column in self._columns():
            labels, values = self._values(column)
            facts[column] = _statistics(values) | {"worst": labels[values.index(max(values))]}
            if column.startswith("folded"):
                facts[column] |= {"sum": sum(values), "members": sum(value > 0 for value in values)}
        if self.judged:
            facts["verdicts"] = [
                {"name": row.label, "verdict": row.verdict, "beyond": list(_beyond(row))} for row in self.rows
            ]
        return {"summary": facts}

    def lines(self) -> str:
        """Return the table as text."""
        columns = self._columns()
        rows = self.rows if self.judged else self.members
        table = [["grid", *(LABELS[column] for column in columns)]]
        for row in rows:
            values = row.figures
            table.append([row.label, *(figure(values[c]) if c in values else "-" for c in columns)])
        statistics = [_statistics(self._values(column)[1]) for column in columns]
        for name in ("median", "mean", "p90", "max") if statistics else ():
            label = f"{'worst' if name == 'max' else name} of {len(self.members)}"
            table.append([label, *(figure(values[name]) for values in statistics)])
        return self._with_verdicts(aligned(table)) if self.judged else aligned(table)

    def _with_verdicts(self, table: str) -> str:
        """Return the table with a verdict at the end of each row, and the number of each verdict."""
        lines = table.splitlines()
        width = max(map(len, lines))
        ends = ["verdict  limits exceeded"]
        ends += [f"{verdict_word(row.verdict):<7}  {', '.join(_beyond(row))}" for row in self.rows]
        whole = [f"{line:<{width}}  {end}".rstrip() for line, end in zip(lines, ends, strict=False)]
        verdicts = [row.verdict for row in self.rows]
        counts = [f"{verdicts.count(word)} {verdict_word(word)}" for word in VERDICTS if word in verdicts]
        replaced = dict.fromkeys(
            text for row in self.rows if row.judgement for text in row.judgement.replaced
        )
        note = [f"--fail-on in place of the profile's limit: {', '.join(replaced)}"] if replaced else []
        return "\n".join([*whole, *lines[len(ends) :], *note, f"verdicts: {', '.join(counts)}"])

    def _columns(self) -> list[str]:
        return [column for column in LABELS if any(column in row.figures for row in self.rows)]

    def _values(self, column: str) -> tuple[list[str], list[float]]:
        pairs = [(row.label, float(row.figures[column])) for row in self.rows if column in row.figures]
        return [label for label, _ in pairs], [value for _, value in pairs]


def _beyond(row: MemberRow) -> Sequence[str]:
    return row.judgement.beyond if row.judgement else ()


def _statistics(values: Sequence[float]) -> dict[str, float]:
    import numpy as np

    low, median, high, most = (float(v) for v in np.percentile(values, [0, 50, 90, 100]))
    return {"min": low, "median": median, "mean": float(np.mean(values)), "p90": high, "max": most}
