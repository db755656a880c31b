"""Quality report of one or more grids: one HTML file for screen and print."""

import heapq
import html
import itertools
from collections.abc import Sequence
from pathlib import Path

from meshonet.formats.figure.page.document import document, file_text
from meshonet.formats.figure.report.article import article, passed, size_words, verdict
from meshonet.geometry.quality.gates import Gate
from meshonet.geometry.quality.report import QualityReport

SHOWN = 20  # largest number of grids with pictures in a report; of more grids, the worst are shown


class QualityPage:
    """Quality page of grids, with details of up to `SHOWN` grids that failed or have the largest angles."""

    def __init__(self, gates: Sequence[Gate] = (), software: str = "meshonet") -> None:
        self._gates, self._software = tuple(gates), software
        self._rows: list[tuple[str, str, float, bool]] = []
        self._worst: list[tuple[tuple[bool, float], int, str, QualityReport]] = []
        self._numbers = itertools.count()

    def add(self, label: str, report: QualityReport) -> None:
        """Add the report of grid `label`. Raises InputError: the grid lacks a quantity that has a limit."""
        report = report.under(self._gates)
        good, angle = passed(report, self._gates), report.quality["max_angle"].max
        number = next(self._numbers)
        self._rows.append((label, size_words(report), angle, good))
        entry = (not good, angle), -number, label, report
        if len(self._worst) < SHOWN:
            heapq.heappush(self._worst, entry)
        else:
            heapq.heappushpop(self._worst, entry)

    @property
    def passed(self) -> bool:
        """Whether all grids added so far have passed."""
        return all(good for *_, good in self._rows)

    def text(self) -> str:
        """Return the page as HTML."""
        shown = sorted(self._worst, key=lambda entry: -entry[1])
        articles = [article(label, report, self._gates, -number) for _, number, label, report in shown]
        title = self._rows[0][0] if len(self._rows) == 1 else f"{len(self._rows)} grids"
        head = f"<h1>Grid quality</h1>\n{self._summary({-number for _, number, _, _ in shown})}"
        foot = f"<footer>Made by {self._software}. Metrics are defined in its page on quality.</footer>"
        style = file_text("meshonet.formats.figure.report", "report.css")
        return document(f"Grid quality: {title}", style, "\n".join([head, *articles, foot]))

    def write(self, path: Path) -> None:
        """Write the page."""
        path.write_text(self.text(), encoding="utf-8")

    def _summary(self, shown: set[int]) -> str:
        """Return the table of all grids, with links to the sections of the `shown` ones."""
        if len(self._rows) == 1:
            good = self._rows[0][3]
            return f"<p>{verdict('pass' if good else 'fail', 'passed' if good else 'failed')}</p>"
        failed = sum(not good for *_, good in self._rows)
        words = f"{len(self._rows)} grids, {failed or 'none'} failed"
        if len(self._rows) > SHOWN:
            words += f"; the {SHOWN} worst are shown below"
        rows = []
        for number, (label, size, angle, good) in enumerate(self._rows):
            name = html.escape(label)
            link = f'<a href="#grid-{number}">{name}</a>' if number in shown else name
            rows.append(
                f"<tr><td>{link}</td><td>{size}</td><td>{angle:.4g}</td>"
                f"<td>{verdict('pass' if good else 'fail')}</td></tr>"
            )
        head = "<tr><th>grid</th><th>size</th><th>max angle (deg)</th><th></th></tr>"
        return f"<p>{words}</p><table><thead>{head}</thead><tbody>{''.join(rows)}</tbody></table>"
