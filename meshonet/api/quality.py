"""`meshonet.quality` and `meshonet.quality_page`."""

from collections.abc import Iterable, Sequence
from pathlib import Path

from meshonet import __version__
from meshonet.api.files import only
from meshonet.formats.figure.report.report import QualityPage
from meshonet.formats.output import whole_file
from meshonet.formats.registry import format_for_output, read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.errors import InputError
from meshonet.geometry.quality.gates import parse_gates
from meshonet.geometry.quality.report import QualityReport, quality_report
from meshonet.geometry.quality.wall_y_plus import Flow
from meshonet.geometry.threads import limited_to


def quality(
    grid: Grid | str | Path, *, profile: str | Sequence[str] = (), compare: Grid | str | Path | None = None,
    reynolds: float | None = None, length: float | None = None, threads: int | None = None,
) -> QualityReport:  # fmt: skip
    """Measure the quality of a grid: folded cells, angles, skewness, walls, growth.

    Parameters
    ----------
    grid : Grid, str or Path
        A grid, or a file with one.
    profile : str or sequence of str, optional
        Profiles of thresholds: ``openfoam``, ``pointwise``, ``verdict``, ``viscous``.
    compare : Grid, str or Path, optional
        Reference grid of the same size, or a file with one.
    reynolds : float, optional
        Reynolds number for which y+ of the first cells at each wall is reported. The wall shear stress is
        that of a turbulent flat plate.
    length : float, optional
        Reference length of `reynolds`, in the unit of the grid; None is 1.
    threads : int, optional
        Number of threads; None: one per core. The result does not depend on it.

    Returns
    -------
    QualityReport
        All metrics with their percentiles, the worst cells, walls and growth, and the verdicts of the
        profiles.

    Raises
    ------
    InputError
        A file that cannot be read or has several grids; a reference of another size; an unknown profile; a
        Reynolds number, length or number of threads out of its range.

    Examples
    --------
    >>> import numpy as np
    >>> x, y = np.meshgrid(np.linspace(0, 2, 5), np.linspace(0, 1, 3), indexing="ij")
    >>> report = quality(Grid.from_nodes(np.stack([x, y], axis=-1)))
    >>> report.quality.folded, report.quality["max_angle"].max
    (0, 90.0)
    """
    grid = single_grid(grid)
    reference = None if compare is None else single_grid(compare)
    with limited_to(threads):
        flow = None if reynolds is None else Flow(reynolds, 1.0 if length is None else length)
        return quality_report(grid, profile, reference, flow)


def quality_page(
    grids: Iterable[Grid | str | Path], output: str | Path, *,
    profile: str | Sequence[str] = (), fail_on: Sequence[str] = (),
) -> bool:  # fmt: skip
    """Write the quality of grids as an HTML page, and return whether all grids pass.

    Parameters
    ----------
    grids : iterable of Grid, str or Path
        Grids, or files with one each.
    output : str or Path
        Page to write, ``.html``.
    profile : str or sequence of str, optional
        Profiles of thresholds, as for `quality`.
    fail_on : sequence of str
        Gates, which are conditions by which a grid fails, such as ``max_angle>170``. A gate replaces the
        limit of a profile for the same metric.

    Returns
    -------
    bool
        True if all grids are without folded cells and pass all gates and all checks of the profiles.

    Raises
    ------
    InputError
        As for `quality`; an invalid gate; an output that cannot be written.

    Examples
    --------
    >>> import meshonet
    >>> made = meshonet.infer("naca:2412", res=(41, 17))
    >>> quality_page([made], "quality.html", fail_on=["folded>0"])
    True
    """
    gates = parse_gates(fail_on)
    if format_for_output(str(output)).name != "html":
        raise InputError("a report is a page", "name it FILE.html", parameter="output", source=str(output))
    page = QualityPage(gates, f"meshonet {__version__}")
    for number, source in enumerate(grids):
        grid = single_grid(source)
        label = str(source) if isinstance(source, str | Path) else grid.name or f"grid {number}"
        page.add(label, quality(grid, profile=profile))
    with whole_file(str(output)) as part:
        page.write(part)
    return page.passed


def single_grid(grid: Grid | str | Path) -> Grid:
    """Return the grid, or the only grid of a file. Raises InputError: unreadable; not exactly one grid."""
    if isinstance(grid, Grid):
        return grid
    return only(read_grids(str(grid)), grid, "a grid", "read them one by one")
