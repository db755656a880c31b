"""The quality of a grid for people."""

from dataclasses import dataclass
from typing import Any

from meshonet.geometry.errors import BadCell
from meshonet.geometry.quality.blocks import LINES, BlockFigures
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.metrics import METRICS
from meshonet.geometry.quality.profiles import CheckResult, Figures, Limit, ProfileReport
from meshonet.geometry.quality.report import Comparison, QualityReport
from meshonet.geometry.quality.summary import Quality
from meshonet.geometry.quality.walls import Spread, WallRow
from meshonet_cli.batch.timed import Timed
from meshonet_cli.text import aligned, figure, named

_VERDICTS = {"fail": "FAIL", "warn": "warning", "none": "no figure"}


@dataclass
class Measured(Timed):
    """The report of a grid that was measured."""

    report: QualityReport

    def as_json(self) -> dict[str, Any]:
        """Return what ``--json`` prints."""
        member = {"input": self.item.source, "name": self.item.what.name}
        return member | self.report.as_dict() | {"seconds": self.times_json()}

    def lines(self) -> str:
        """Return the tables for people."""
        report = self.report
        grid, quality = report.grid, report.quality
        folded = f"{quality.folded} folded" if quality.folded else "none folded"
        many = grid.topology == "blocks"
        size = (
            f"{grid.ni} x {grid.nj} nodes, {grid.topology} grid"
            if not many
            else blocks_line(report.figures.blocks)
        )
        rows = [f"{self.item.label}: {size}, {quality.cells} cells, {folded}", quality_table(quality)]
        if many:
            rows.append(lines_table(report.figures.blocks))
        if report.figures.wall_rows and (report.profile or grid.around_body or many):
            rows.append(walls_table(report.figures.wall_rows))
        if report.profile:
            rows.append(profile_table(report.figures, report.profile))
        rows += [f"folded at {cell_text(cell)}" for cell in report.worst]
        if report.comparison:
            rows.append(comparison_lines(report.comparison))
        return "\n".join(rows)

    def figures_of_row(self) -> dict[str, float]:
        """Return the figures that a summary of many grids shows."""
        quality, comparison = self.report.quality, self.report.comparison
        angle = quality["max_angle"]
        row = {"folded": quality.folded, "max_angle": angle.max, "mean_angle": angle.mean}
        return row | (comparison.figures() if comparison else {})


def quality_table(quality: Quality) -> str:
    """Return the metrics as a table; it needs the percentiles."""
    many = any(len(summary.worst) == 3 for summary in quality.metrics.values())
    rows = [["metric", "min", "p01", "mean", "p99", "max", f"worst at {'block, ' * many}i, j"]]
    for metric in METRICS:
        row = quality[metric.name]
        name = f"{metric.name} ({metric.unit})" if metric.unit else metric.name
        values = ["-" if v is None else figure(v) for v in (row.min, row.p01, row.mean, row.p99, row.max)]
        rows.append([name, *values, _place(row.worst)])
    return aligned(rows)


def blocks_line(blocks: BlockFigures) -> str:
    """Return how many blocks, nodes, interfaces and irregular vertices there are."""
    parts = (len(blocks.sizes), "block"), (blocks.nodes, "node"), (blocks.interfaces, "interface")
    counts = [f"{count} {word}{'' if count == 1 else 's'}" for count, word in parts]
    irregular = len(blocks.irregular)
    vertices = f"{irregular or 'no'} irregular {'vertex' if irregular == 1 else 'vertices'}"
    return ", ".join([*counts, vertices])


def lines_table(blocks: BlockFigures) -> str:
    """Return angles, growth and bends of many blocks as a table."""
    angles = blocks.deviation
    rows = [["angles and lines", "mean", "p99", "max", "at block, i, j"]]
    angle = "off 90 at corners (deg)"
    rows.append([angle, figure(angles.mean), figure(angles.p99), figure(angles.max), _place(angles.at)])
    for name in LINES:
        extreme: Extreme | None = getattr(blocks.lines, name)
        what, where = name.split("_")
        label = f"{what} {'inside blocks' if where == 'inside' else 'across sides'}"
        if extreme:
            values = (extreme.mean, extreme.p99 or 0.0, extreme.max)
            unit = " (deg)" if what == "bend" else ""
            rows.append([label + unit, *map(figure, values), _place(extreme.at)])
    return aligned(rows)


def cell_text(cell: BadCell) -> str:
    """Return the place of a folded cell for people."""
    block = "" if cell.block is None else f"block={cell.block}, "
    return f"{block}i={cell.i}, j={cell.j}: x={cell.x:.6g}, y={cell.y:.6g}"


def _place(at: tuple[int, ...]) -> str:
    return ", ".join(map(str, at))


def comparison_lines(comparison: Comparison) -> str:
    """Return a comparison in two lines."""
    d = comparison.difference
    return (
        f"distance to the other grid: max {figure(d.max)} at {named(d.at)}, "
        f"mean {figure(d.mean)}, relative L2 {figure(d.relative_l2)}, "
        f"near the wall {figure(d.near_wall)}, boundary {figure(d.boundary)}\n"
        f"beside the other grid: {comparison.folded} folded there, "
        f"max angle {comparison.max_angle_ratio:.4f} and "
        f"mean angle {comparison.mean_angle_ratio:.4f} times as large"
    )


def walls_table(rows: tuple[WallRow, ...]) -> str:
    """Return the cells at the walls as a table."""
    table = [["at the walls", "min", "mean", "max", "equal cells"]]
    for row in rows:
        table.append([f"{row.name}: first cell", *_spread(row.height), str(row.equal_cells)])
        table.append([f"{row.name}: off 90 (deg)", *_spread(row.off_square), ""])
    return aligned(table)


def profile_table(figures: Figures, profile: ProfileReport) -> str:
    """Return the checks of a profile, and the growth of cells, as tables."""
    at = "at block, i, j" if figures.grid.topology == "blocks" else "at i, j"
    rows = [["growth", "mean", "max", at]]
    for name, extreme in (("along xi", figures.growth.xi), ("along eta", figures.growth.eta)):
        if extreme:
            rows.append([name, figure(extreme.mean), figure(extreme.max), _place(extreme.at)])
    checks = [[f"profile {profile.name}", "figure", at, "limits", "verdict"]]
    checks += [_check_row(result) for result in profile.results]
    return f"{aligned(rows)}\n{aligned(checks)}"


def _check_row(result: CheckResult) -> list[str]:
    value = "-" if result.value is None else figure(result.value)
    place = _place(result.at) if result.at else ""
    limits = ", ".join(limit_text(limit) for limit in result.check.limits)
    return [result.check.figure, value, place, limits, _VERDICTS.get(result.verdict, result.verdict)]


def limit_text(limit: Limit) -> str:
    """Return a limit for people.

    >>> limit_text(Limit("fail", ">=", 90))
    'fail >= 90'
    """
    return f"{limit.level} {limit.compare} {limit.value:g}"


def _spread(spread: Spread) -> list[str]:
    return [figure(value) for value in (spread.min, spread.mean, spread.max)]
