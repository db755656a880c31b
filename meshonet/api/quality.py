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
from meshonet.geometry.threads import limited_to


def quality(
    grid: Grid | str | Path, *, profile: str | Sequence[str] = (), compare: Grid | str | Path | None = None,
    threads: int | None = None,
) -> QualityReport:  # fmt: skip
    """Measure a grid: folded cells, angles, skewness, walls, growth.

    Parameters
    ----------
    grid : Grid, str or Path
        A grid, or a file that holds one.
    profile : str or sequence of str, optional
        Thresholds to judge by: ``openfoam``, ``pointwise``, ``verdict`` or ``viscous``, or several of them.
    compare : Grid, str or Path, optional
        Reference grid of the same size, or a file that holds one.
    threads : int, optional
        Threads that work on it, with the same result for any number; None: as many as there are cores.

    Returns
    -------
    QualityReport
        Every metric with its percentiles, the worst cells, walls and growth; the verdict of the profile.

    Raises
    ------
    InputError
        A file that cannot be read or holds several grids, a reference of another size, an unknown profile,
        no threads.

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
        return quality_report(grid, profile, reference)


def quality_page(
    grids: Iterable[Grid | str | Path], output: str | Path, *,
    profile: str | Sequence[str] = (), fail_on: Sequence[str] = (),
) -> bool:  # fmt: skip
    """Write the quality of grids as one page, and return whether all of them pass.

    Parameters
    ----------
    grids : iterable of Grid, str or Path
        Grids, or files that hold one each.
    output : str or Path
        Page to write, ``.html``.
    profile : str or sequence of str, optional
        Thresholds to judge by, as for `quality`.
    fail_on : sequence of str
        Gates, ``max_angle>170`` for instance; a limit for a figure that a profile has too replaces its.

    Returns
    -------
    bool
        Whether no cell is folded, no gate broken and no check of the profile failed.

    Raises
    ------
    InputError
        As `quality`; something that is no gate; an output that cannot be written.

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
    """Return the grid, or the only one of a file.

    Raises InputError: a file that cannot be read, or holds none or several.
    """
    if isinstance(grid, Grid):
        return grid
    return only(read_grids(str(grid)), grid, "a grid", "read them one by one")
