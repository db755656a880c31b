"""Task of `quality`."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from meshonet import __version__
from meshonet.api.quality import quality
from meshonet.formats.figure.picture import Picture
from meshonet.formats.figure.report.report import QualityPage
from meshonet.formats.inputs import Inputs
from meshonet.formats.output import whole_file
from meshonet.formats.registry import format_for_output, picture_format, read_grids
from meshonet.formats.vtk.metrics import write_metrics
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.criteria import Criteria
from meshonet.geometry.quality.gates import Gate
from meshonet.geometry.quality.match_grids import GridMatcher, Pairing
from meshonet.solvers.stages import reached, stage
from meshonet_cli.batch.destination import Destination
from meshonet_cli.batch.sources import members_of
from meshonet_cli.report.quality import Measured
from meshonet_cli.terminal.session import Session


def measure_grids(
    inputs: Inputs, session: Session, *, fmt: str | None = None, criteria: Criteria | None = None,
    compare: str | None = None, pairing: Pairing = "auto", summary: bool = False,
    plot: str | None = None, html: str | None = None, per_cell: str | None = None,
    reynolds: float | None = None, length: float | None = None,
) -> int:  # fmt: skip
    """Measure each grid of `inputs`, print the reports and return the exit code.

    Parameters
    ----------
    compare, pairing : file with reference grids, and the rule that assigns grids to them.
    summary : whether to print one table for all grids.
    plot, per_cell, html : files for pictures, metrics of all cells, and the report page.
    reynolds, length : Reynolds number for y+, and its reference length.
    """
    gates, profiles = (criteria.gates, criteria.profiles) if criteria else ((), ())
    session.summary, session.judges = summary, criteria is not None
    outputs = [_picture_file(plot)] if plot else []
    outputs += [_metrics_file(per_cell)] if per_cell else []
    for destination in outputs:
        if inputs.more_than(1):
            destination.check_room()
        if destination.text == "-":
            raise InputError("standard output has the table", "write to a file", source="-")
    page = _page(html, gates) if html else None
    references = GridMatcher(read_grids(compare), pairing) if compare else None
    for item in members_of(inputs, partial(read_grids, fmt=fmt), session):
        with session.member(item.label, item.source):
            seconds: dict[str, float] = {}
            reference = None
            if references:
                with stage("compare", seconds):
                    reference = references.match(item.name)
            with stage("quality", seconds):
                report = quality(
                    item.what, profile=profiles, compare=reference, reynolds=reynolds, length=length
                ).under(gates)
                judgement = report.judgement(gates)
            measured = Measured(item, report, judgement, judged=criteria is not None)
            measured.seconds |= seconds
            for destination in outputs:
                if not item.only:
                    destination.check_several(item)
                with stage("write", measured.seconds):
                    destination.write(destination.path(item), [item.what])
            if summary:
                session.done += 1
            else:
                session.show(measured)
            session.judge(measured.row())
            if page:
                page.add(item.label, measured.report)
    if page and html and session.done:
        reached("write")
        with whole_file(html) as part:
            page.write(part)
    return session.finish()


def _page(output: str, gates: Sequence[Gate]) -> QualityPage:
    if Path(output).suffix.lower() not in (".html", ".htm"):
        raise InputError("a report is a page", "name it FILE.html", parameter="html", source=output)
    return QualityPage(gates, f"meshonet {__version__}")


def _picture_file(output: str) -> Destination:
    kind = picture_format(output).name
    return Destination(output, kind, put=partial(Picture().draw, kind))


def _metrics_file(output: str) -> Destination:
    name = format_for_output(output).name
    if name not in ("vts", "vtm"):
        remedy = "name it FILE.vts, or FILE.vtm for many blocks"
        raise InputError("only .vts and .vtm files hold metrics", remedy, source=output)
    return Destination(output, None, put=partial(write_metrics, many=name == "vtm"))
