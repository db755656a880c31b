"""The report of quality as a page."""

import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from format_shapes import channel, ring
from many_blocks import passage
from volume_grids import box

import meshonet
from meshonet.formats.figure.page.cells import BARS, scale_of
from meshonet.formats.figure.report import report as report_module
from meshonet.formats.figure.report.article import histogram_svg
from meshonet.formats.figure.report.report import QualityPage
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.gates import parse_gates
from meshonet.geometry.quality.report import quality_report


class Text(HTMLParser):
    """The cells of tables, the headings, and whether all tags are closed in their order."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.rows: list[list[str]] = []
        self.headings: list[str] = []
        self._open: list[str] = []
        self.feed(page)
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        if tag not in ("meta", "img"):
            self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
        elif tag in ("h1", "h2", "h3"):
            self.headings.append("")

    def handle_endtag(self, tag: str) -> None:
        if tag not in ("rect", "line"):
            assert self._open.pop() == tag

    def handle_startendtag(self, tag: str, attrs: object) -> None:
        assert tag in ("rect", "line")

    def handle_data(self, data: str) -> None:
        if {"td", "th"} & set(self._open):
            self.rows[-1][-1] += data
        elif {"h1", "h2", "h3"} & set(self._open):
            self.headings[-1] += data


def page(*grids: Grid, gates: tuple[str, ...] = (), profile: str | None = None) -> str:
    page = QualityPage(parse_gates(gates))
    for grid in grids:
        page.add(grid.name, quality_report(grid, profile))
    return page.text()


@pytest.mark.parametrize("make", [channel, ring, passage, box])
def test_a_page_has_the_figures_of_every_metric(make: type[Grid]) -> None:
    grid = make()
    rows = {row[0]: row[1:] for row in reversed(Text(page(grid)).rows) if row}
    for name, summary in grid.quality().metrics.items():
        figures = next(row for first, row in rows.items() if first.split(" (")[0] == name.replace("_", " "))
        wanted = (summary.min, summary.p01, summary.mean, summary.p99, summary.max)
        assert figures[:5] == [f"{value:.4g}" for value in wanted if value is not None]


def test_gates_and_checks_of_a_profile_have_their_verdicts() -> None:
    text = page(ring(), gates=("aspect_ratio>1", "folded>0"), profile="viscous")
    rows = Text(text).rows
    assert [row[-1] for row in rows if row[0] == "not aspect_ratio>1"] == ["FAIL"]
    assert [row[-1] for row in rows if row[0] == "not folded>0"] == ["pass"]
    assert [row[-1] for row in rows if row[0] == "wall_growth"] == ["FAIL"]
    assert [row[-1] for row in rows if row[0] == "far_field"] == ["warn"]


def test_a_page_stands_alone() -> None:
    text = page(ring())
    assert not re.search(r"https?://|@import|url\(|<script|<link", text)
    assert re.findall(r'src="(.{22})', text) == ["data:image/png;base64,"]


def test_several_grids_have_a_table_with_links_and_verdicts() -> None:
    text = page(ring(49), channel(name="b<a>d"), gates=("max_angle>100",))
    rows = Text(text).rows
    assert [row[0] for row in rows[1:3]] == ["ring", "b<a>d"]
    assert [row[-1] for row in rows[1:3]] == ["pass", "FAIL"]
    assert (
        re.findall(r'href="#(.*?)"', text) == re.findall(r'<article id="(.*?)"', text) == ["grid-0", "grid-1"]
    )
    assert "2 grids, 1 failed" in text


def test_of_many_grids_the_worst_are_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(report_module, "SHOWN", 2)
    leaning = [Grid.from_nodes(leaned(lean), name=f"lean {lean}") for lean in (0.1, 0.9, 0.3, 0.7)]
    text = page(*leaning)
    assert re.findall(r'<article id="(.*?)"', text) == ["grid-1", "grid-3"]
    assert [row[0] for row in Text(text).rows[1:5]] == [grid.name for grid in leaning]
    assert "4 grids, none failed; the 2 worst are shown below" in text


def leaned(lean: float) -> np.ndarray:
    """Nodes of a square, leaned over."""
    x, y = np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 4), indexing="ij")
    return np.stack([x + lean * y, y], axis=-1)


def test_a_histogram_has_a_bar_for_each_count_and_a_mark_for_each_limit_in_view() -> None:
    values = np.linspace(0, 1, 1001)
    drawing = histogram_svg(values, scale_of(values), (0.5, 7.0))
    assert drawing.count("<rect") == BARS
    (mark,) = re.findall(r'<line x1="([\d.]+)"', drawing)
    assert float(mark) == pytest.approx(120, abs=1)


def test_in_python_a_page_is_written_and_says_whether_all_passed(tmp_path: Path) -> None:
    grids = [channel(), ring()]
    assert meshonet.quality_page(grids, tmp_path / "q.html", fail_on=["folded>0"])
    assert not meshonet.quality_page(grids, tmp_path / "q.html", fail_on=["max_angle>90"])
    assert "<h2>ring</h2>" in (tmp_path / "q.html").read_text()
    with pytest.raises(InputError, match=r"a report is a page; name it FILE\.html"):
        meshonet.quality_page(grids, tmp_path / "q.png")
