"""Report of the quality of a grid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.bad_cell import centre_of
from meshonet.geometry.quality.blocks import LINES, BlockFigures
from meshonet.geometry.quality.figures import Figures
from meshonet.geometry.quality.gates import Judgement, verdict_word
from meshonet.geometry.quality.growth import Extreme
from meshonet.geometry.quality.metrics import metrics_of
from meshonet.geometry.quality.profiles import CheckResult, ProfileReport
from meshonet.geometry.quality.report import Comparison, QualityReport
from meshonet.geometry.quality.wall_y_plus import Flow, YPlus
from meshonet.geometry.quality.walls import Spread, WallRow
from meshonet.geometry.summary import Quality, named
from meshonet_cli.report.timed import Timed
from meshonet_cli.terminal.summary import MemberRow, figures, gates_not_met
from meshonet_cli.terminal.text import aligned, figure

if TYPE_CHECKING:
    from meshonet.geometry.quality.periodic import Period

_PLACES = {2: "i, j", 3: "block, i, j", 4: "block, i, j, k"}  # names of indices, by their number
_AXES = {2: "at x, y", 3: "at x, y, z"}  # headings of the column with centres of cells


@dataclass
class Measured(Timed):
    """Report of the quality of a grid."""

    report: QualityReport
    judgement: Judgement
    judged: bool

    def row(self) -> MemberRow:
        """Return the row of the grid for the table of all grids."""
        comparison = self.report.comparison
        values = figures(self.report.quality) | (comparison.figures() if comparison else {})
        return MemberRow(self.item.label, values, self.judgement if self.judged else None)

    def as_json(self) -> dict[str, Any]:
        """Return the data for ``--json``."""
        member = {"input": self.item.source, "name": self.item.name}
        end = {"seconds": self.times_json(), "gates_not_met": gates_not_met(self.judgement)}
        return member | self.report.as_dict() | end

    def lines(self) -> str:
        """Return the tables as text."""
        report = self.report
        grid, quality = report.grid, report.quality
        folded = folded_words(quality)
        many = grid.topology == "blocks"
        size = "" if many else f"{grid.ni} x {grid.nj} nodes, {grid.topology} grid"
        size = size or blocks_line(report.figures.blocks)
        rows = [f"{self.item.label}: {size}, {quality.cells} cells, {folded}", quality_table(grid, quality)]
        if many:
            rows.append(lines_table(grid, report.figures.blocks))
        if report.figures.wall_rows and (report.profile or many or grid.form == "plane"):
            rows.append(walls_table(report.figures.wall_rows))
        if report.wall_skewness:
            rows.append(skewness_table(grid, report.wall_skewness))
        if report.flow and report.y_plus:
            rows.append(y_plus_table(report.flow, report.y_plus))
        rows += [_period_line(row) for row in report.periods]
        if report.profile or not many:
            rows.append(growth_table(report.figures))
        if many:
            rows += _largest_growth(grid, report.figures)
        if report.profile:
            rows.append(profile_table(report.profile))
        rows += [f"folded at {cell.indices}: {cell.centre}" for cell in report.worst]
        if report.comparison:
            rows.append(comparison_lines(report.comparison))
        return "\n".join(rows)


def _largest_growth(grid: Grid, figures: Figures) -> list[str]:
    """Return the largest growth inside blocks and across their sides, as a line."""
    most = figures("growth")
    if most is None or most.at is None:
        return []
    return [f"largest growth: {figure(most.value)}{most.where}, ({_cell(grid, most.at)[1]})"]


def _period_line(row: Period) -> str:
    if row.angle:
        motion, size = f"turned by {row.angle:.6g} degrees", "the radius"
    else:
        way = ", ".join(f"{each:.4g}" for each in row.along)
        motion, size = f"shifted by {row.shift:.6g} along ({way})", "this"
    return f"periodic sides: {motion}, nodes then {row.mismatch:.2g} of {size} apart"


def quality_table(grid: Grid, quality: Quality) -> str:
    """Return the metrics as a table; `quality` must contain percentiles."""
    places = max(len(summary.worst) for summary in quality.metrics.values())
    rows = [["metric", "min", "p01", "mean", "p99", "max", f"worst at {_PLACES[places]}", _axes(grid)]]
    for metric in metrics_of(grid):
        row = quality[metric.name]
        name = f"{metric.name} ({metric.unit})" if metric.unit else metric.name
        values = [_figure(value) for value in (row.min, row.p01, row.mean, row.p99, row.max)]
        rows.append([name, *values, *_cell(grid, row.worst)])
    return aligned(rows)


def blocks_line(blocks: BlockFigures) -> str:
    """Return the numbers of blocks, nodes, interfaces and irregular vertices as text."""
    parts = (len(blocks.sizes), "block"), (blocks.nodes, "node"), (blocks.interfaces, "interface")
    counts = [f"{count} {word}{'' if count == 1 else 's'}" for count, word in parts]
    if blocks.irregular is None:
        return ", ".join(counts)
    irregular = len(blocks.irregular)
    vertices = f"{irregular or 'no'} irregular {'vertex' if irregular == 1 else 'vertices'}"
    return ", ".join([*counts, vertices])


def lines_table(grid: Grid, blocks: BlockFigures) -> str:
    """Return a table of angles, growth and bends along the grid lines of a multi-block grid."""
    angles = blocks.deviation
    rows = [["angles and lines", "mean", "p99", "max", f"at {_PLACES[len(angles.at)]}", _axes(grid)]]
    values = (angles.mean, angles.p99, angles.max)
    rows.append(["off 90 at corners (deg)", *map(_figure, values), *_cell(grid, angles.at)])
    for name in LINES:
        extreme: Extreme | None = getattr(blocks.lines, name)
        what, where = name.split("_")
        label = f"{what} {'inside blocks' if where == 'inside' else 'across sides'}"
        if extreme:
            unit = " (deg)" if what == "bend" else ""
            values = (extreme.mean, extreme.p99, extreme.max)
            rows.append([label + unit, *map(_figure, values), *_cell(grid, extreme.at)])
    return aligned(rows)


def folded_words(quality: Quality) -> str:
    """Return the number of folded cells as text; in volumes, both by corners and by Bezier coefficients."""
    words = f"{quality.folded} folded" if quality.folded else "none folded"
    if quality.bezier_folded is None:
        return words
    return f"{words} at corners, {quality.bezier_folded or 'none'} by the Bezier test"


def _figure(value: float | None) -> str:
    return "-" if value is None else figure(value)


def _place(at: tuple[int, ...]) -> str:
    return ", ".join(map(str, at))


def _cell(grid: Grid, at: tuple[int, ...]) -> tuple[str, str]:
    """Return the indices and the centre of a cell as text."""
    return _place(at), ", ".join(map(figure, centre_of(grid, at)))


def _axes(grid: Grid) -> str:
    return _AXES[2 if grid.form == "plane" else 3]


def comparison_lines(comparison: Comparison) -> str:
    """Return the comparison with a reference grid as two lines."""
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
    """Return the figures of the first cells at each wall as a table."""
    table = [["at the walls", "min", "mean", "max", "equal cells"]]
    for row in rows:
        table.append([f"{row.name}: first cell", *_spread(row.height), str(row.equal_cells)])
        table.append([f"{row.name}: off 90 (deg)", *_spread(row.off_square), ""])
        if row.growth:
            growth = ["", figure(row.growth.mean), figure(row.growth.max), ""]
            table.append([f"{row.name}: growth of lines", *growth])
    return aligned(table)


def skewness_table(grid: Grid, skewness: Mapping[str, Extreme]) -> str:
    """Return the skewness of the cells at each wall as a table."""
    rows = [["skewness at the walls", "mean", "p99", "max", f"at {_PLACES[4]}", _axes(grid)]]
    for name, row in skewness.items():
        rows.append([name, figure(row.mean), _figure(row.p99), figure(row.max), *_cell(grid, row.at)])
    return aligned(rows)


def y_plus_table(flow: Flow, y_plus: Mapping[str, YPlus]) -> str:
    """Return y+ at each wall as a table."""
    rows = [[f"y+ at Re {flow.reynolds:g} on {flow.length:g}", "min", "median", "max"]]
    rows += [[name, figure(row.min), figure(row.median), figure(row.max)] for name, row in y_plus.items()]
    return aligned(rows)


def growth_table(figures: Figures) -> str:
    """Return the growth ratios of cells as a table."""
    grid = figures.grid
    places = _PLACES[1 + len(grid.blocks[0].counts) if grid.topology == "blocks" else 2]
    rows = [["growth", "mean", "max", f"at {places}", _axes(grid)]]
    for name, extreme in figures.growth.families().items():
        values = (figure(extreme.mean), figure(extreme.max))
        rows.append([f"along {name}", *values, *_cell(grid, extreme.at)])
    return aligned(rows)


def profile_table(profile: ProfileReport) -> str:
    """Return the checks of a profile as a table."""
    places = max((len(result.at) for result in profile.results if result.at), default=2)
    axes = _AXES[max((len(result.centre) for result in profile.results if result.centre), default=2)]
    rows = [[f"profile {profile.name}", "figure", f"at {_PLACES[places]}", axes, "limits", "verdict"]]
    return aligned(rows + [_check_row(result) for result in profile.results])


def _check_row(result: CheckResult) -> list[str]:
    value = "-" if result.value is None else figure(result.value)
    place = _place(result.at) if result.at else ""
    centre = ", ".join(map(figure, result.centre or ()))
    limits = ", ".join(f"{each.level} {each.compare} {each.value:g}" for each in result.check.limits)
    limits += " (--fail-on)" if result.gated else ""
    return [result.check.figure, value, place, centre, limits, verdict_word(result.verdict)]


def _spread(spread: Spread) -> list[str]:
    return [figure(value) for value in (spread.min, spread.mean, spread.max)]
