"""Many grids in one table: a row each, and the median, mean, 90th percentile and worst of every column."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from meshonet_cli.text import aligned, figure

LABELS = {
    "folded": "folded", "max_angle": "max angle", "mean_angle": "mean angle", "relative_l2": "rel L2",
    "near_wall": "near wall", "max": "max", "boundary": "boundary", "folded_other": "folded there",
    "max_angle_ratio": "max ratio", "mean_angle_ratio": "mean ratio", "gates_not_met": "not met",
}  # fmt: skip
"""Columns, for people."""


@dataclass(frozen=True)
class Summary:
    """Figures of many grids."""

    # label and figures by column of each grid; a column is missing where it was not measured
    rows: Sequence[tuple[str, Mapping[str, float]]]

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        facts: dict[str, Any] = {"members": len(self.rows)}
        for column in self._columns():
            labels, values = self._values(column)
            facts[column] = _statistics(values) | {"worst": labels[values.index(max(values))]}
            if column.startswith("folded"):
                facts[column] |= {"sum": sum(values), "members": sum(value > 0 for value in values)}
        return {"summary": facts}

    def lines(self) -> str:
        """Return the table for people."""
        columns = self._columns()
        table = [["grid", *(LABELS[column] for column in columns)]]
        for label, figures in self.rows:
            table.append([label, *(figure(figures[c]) if c in figures else "-" for c in columns)])
        statistics = [_statistics(self._values(column)[1]) for column in columns]
        for name in ("median", "mean", "p90", "max"):
            label = f"{'worst' if name == 'max' else name} of {len(self.rows)}"
            table.append([label, *(figure(row[name]) for row in statistics)])
        return aligned(table)

    def _columns(self) -> list[str]:
        return [column for column in LABELS if any(column in figures for _, figures in self.rows)]

    def _values(self, column: str) -> tuple[list[str], list[float]]:
        pairs = [(label, figures[column]) for label, figures in self.rows if column in figures]
        return [label for label, _ in pairs], [float(value) for _, value in pairs]


def _statistics(values: Sequence[float]) -> dict[str, float]:
    import numpy as np

    low, median, high, most = (float(v) for v in np.percentile(values, [0, 50, 90, 100]))
    return {"min": low, "median": median, "mean": float(np.mean(values)), "p90": high, "max": most}
