"""Section of a quality report about one grid."""

import base64
import html
import io
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from meshonet.formats.figure.page.cells import BARS, Scale, corners_of, histogram, scale_of, worst_places
from meshonet.formats.figure.picture import Picture
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.gates import Gate, verdict_word
from meshonet.geometry.quality.measure import per_cell_of_blocks
from meshonet.geometry.quality.metrics import Metric, metrics_of
from meshonet.geometry.quality.report import QualityReport

_WORST = 3  # number of worst cells listed per metric
_DOTS = 110  # dots per inch of the pictures
_WIDTH, _HEIGHT, _FOOT = 240, 64, 16  # width, height of a histogram, and of the space below it, in pixels
_TINY = 1e-300  # smallest divisor, so that a scale of zero length does not cause a division by zero


def article(label: str, report: QualityReport, gates: Sequence[Gate], number: int) -> str:
    """Return the HTML section on the grid `label`; other parts of the page link to it by its `number`."""
    grid = report.grid
    verdicts = _gates(report, gates) + _profile(report)
    values = {m.name: [np.asarray(v) for v in per_cell_of_blocks(grid, m.name)] for m in metrics_of(grid)}
    parts = [
        f"<h2>{html.escape(label)}</h2>",
        f"<p>{html.escape(size_words(report))}</p>",
        '<div class="top">',
        f'<img alt="The grid, coloured by its largest angle" src="{_picture(grid)}">',
        f"<div>{verdicts or _table(['', ''], [['folded cells', _folded(report)]])}{_walls(report)}</div>",
        "</div>",
        "<h3>Metrics</h3>",
        _metrics(report),
        "<h3>How many cells have which value</h3>",
        f'<div class="charts">{_charts(grid, values, gates)}</div>',
        "<h3>Worst places</h3>",
        _worst(grid, values),
    ]
    return f'<article id="grid-{number}">\n' + "\n".join(parts) + "\n</article>"


def size_words(report: QualityReport) -> str:
    """Return the size of a grid: ``65 x 33 nodes, 2,048 cells, none folded``, or ``2 blocks, ...``."""
    grid, quality = report.grid, report.quality
    folded = f"{quality.folded:,} folded" if quality.folded else "none folded"
    if len(grid.blocks) == 1:
        counts = " x ".join(str(count) for count in grid.blocks[0].counts)
        return f"{counts} nodes, {quality.cells:,} cells, {folded}"
    return f"{len(grid.blocks)} blocks, {quality.cells:,} cells, {folded}"


def passed(report: QualityReport, gates: Sequence[Gate]) -> bool:
    """Return whether no cell is folded, and the grid passes all `gates` and its quality profile."""
    return not report.broken(gates) and not report.quality.folded


def verdict(name: str, words: str = "") -> str:
    """Return the verdict ``pass``, ``warn`` or ``fail``, or `words`, as HTML in its colour."""
    return f'<span class="{name}">{words or verdict_word(name)}</span>'


def _picture(grid: Grid) -> str:
    """Return a picture of the grid as a data URI."""
    data = io.BytesIO()
    Picture().draw("png", data, [grid], dots=_DOTS)
    return "data:image/png;base64," + base64.b64encode(data.getvalue()).decode("ascii")


def _folded(report: QualityReport) -> str:
    return verdict("fail", f"{report.quality.folded:,}") if report.quality.folded else verdict("pass", "none")


def _gates(report: QualityReport, gates: Sequence[Gate]) -> str:
    if not gates:
        return ""
    rows = [
        [html.escape(f"not {gate.text}"), f"{figure.value:.4g}", verdict("fail" if broken else "pass")]
        for gate, figure, broken in report.judged(gates)
    ]
    return _table(["gate", "is", ""], rows)


def _profile(report: QualityReport) -> str:
    if report.profile is None:
        return ""
    rows = []
    for result in report.profile.results:
        limits = ", ".join(f"{x.level} {x.compare} {x.value:g}" for x in result.check.limits)
        limits += " (gate)" if result.gated else ""
        value = "-" if result.value is None else f"{result.value:.4g}"
        rows.append([result.check.figure, value, html.escape(limits), verdict(result.verdict)])
    return _table([f"profile {report.profile.name}", "is", "limits", ""], rows)


def _walls(report: QualityReport) -> str:
    rows = [
        [html.escape(row.name), *(f"{v:.4g}" for v in (row.height.min, row.height.mean, row.height.max))]
        for row in report.figures.wall_rows
    ]
    table = _table(["first cell at", "min", "mean", "max"], rows) if rows else ""
    if not (report.flow and report.y_plus):
        return table
    heading = f"y+ at Re {report.flow.reynolds:g} on {report.flow.length:g}"
    y_plus = [
        [html.escape(name), *(f"{v:.4g}" for v in vars(row).values())] for name, row in report.y_plus.items()
    ]
    return table + _table([heading, "min", "median", "max"], y_plus)


def _metrics(report: QualityReport) -> str:
    rows = []
    for metric in metrics_of(report.grid):
        row = report.quality[metric.name]
        figures = (row.min, row.p01, row.mean, row.p99, row.max)
        rows.append([_name(metric), *("-" if v is None else f"{v:.4g}" for v in figures), metric.short])
    return _table(["metric", "min", "1 %", "mean", "99 %", "max", "what it is"], rows, words=6)


def _charts(grid: Grid, values: dict[str, list[Any]], gates: Sequence[Gate]) -> str:
    figures = []
    for metric in metrics_of(grid):
        every = np.concatenate([cells.ravel() for cells in values[metric.name]])
        limits = [gate.limit for gate in gates if gate.metric == metric.name]
        chart = histogram_svg(every, scale_of(every), limits)
        figures.append(f"<figure><figcaption>{_name(metric)}</figcaption>{chart}</figure>")
    return "".join(figures)


def _worst(grid: Grid, values: dict[str, list[Any]]) -> str:
    rows = []
    for metric in metrics_of(grid):
        (block, cell, value), *others = worst_places(values[metric.name], metric, _WORST)
        centre = corners_of(grid, block, cell).mean(axis=0)
        at = ", ".join(f"{name} {x:.6g}" for name, x in zip("xyz", centre, strict=False))
        row = [_name(metric), f"{value:.4g}", _place(grid, block, cell), at]
        row += [f"{value:.4g} at {_place(grid, block, cell)}" for block, cell, value in others]
        rows.append(row + [""] * (_WORST + 3 - len(row)))
    return _table(["metric", "worst", "cell", "centre", "next", "and"], rows)


def _place(grid: Grid, block: int, cell: tuple[int, ...]) -> str:
    place = ", ".join(f"{name} {k}" for name, k in zip("ijk", cell, strict=False))
    return f"block {block}, {place}" if len(grid.blocks) > 1 else place


def _name(metric: Metric) -> str:
    unit = f" <span>({metric.unit})</span>" if metric.unit else ""
    return metric.name.replace("_", " ") + unit


def _table(head: Iterable[str], rows: Iterable[Sequence[str]], words: int | None = None) -> str:
    """Return a table. Cells are HTML; the column with the index `words` has text that may wrap."""

    def row(tag: str, cells: Iterable[str]) -> str:
        kinds = (' class="words"' if k == words else "" for k in range(99))
        return (
            "<tr>"
            + "".join(f"<{tag}{kind}>{c}</{tag}>" for kind, c in zip(kinds, cells, strict=False))
            + "</tr>"
        )

    body = "\n".join(row("td", cells) for cells in rows)
    return f"<table><thead>{row('th', head)}</thead>\n<tbody>{body}</tbody></table>"


def histogram_svg(values: Floats, scale: Scale, limits: Sequence[float] = ()) -> str:
    """Return a histogram of values (n,) as SVG, with a mark at each of the `limits` inside the scale.

    The height of a bar is proportional to the square root of its count, so that a few bad cells are visible.
    """
    counts = np.array(histogram(values, scale), dtype=float)
    heights = np.sqrt(counts / max(counts.max(), 1.0)) * _HEIGHT
    width = _WIDTH / BARS
    bars = "".join(
        f'<rect x="{k * width:.1f}" y="{_HEIGHT - max(h, 1):.1f}" width="{0.88 * width:.2f}" '
        f'height="{max(h, 1):.1f}"/>'
        for k, h in enumerate(heights)
        if h > 0
    )
    marks = "".join(
        f'<line x1="{x:.1f}" x2="{x:.1f}" y1="0" y2="{_HEIGHT}"/>'
        for limit in limits
        if 0 <= (x := _WIDTH * _shown_part(limit, scale)) <= _WIDTH
    )
    ends = (
        f'<text x="0" y="{_HEIGHT + 12}">{scale.start:.4g}</text>'
        f'<text x="{_WIDTH}" y="{_HEIGHT + 12}" class="end">{scale.stop:.4g}</text>'
    )
    box = f'viewBox="0 0 {_WIDTH} {_HEIGHT + _FOOT}"'
    return f'<svg class="histogram" {box} role="img">{bars}{marks}{ends}</svg>'


def _shown_part(value: float, scale: Scale) -> float:
    """Return the position of a value on the scale, 0 to 1 between its ends."""
    if scale.log and value <= 0:
        return -1.0
    part, first, last = scale.parts(np.array([value, scale.start, scale.stop]))
    return float((part - first) / max(last - first, _TINY))
