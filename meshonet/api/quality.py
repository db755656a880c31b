"""`meshonet.quality`."""

from pathlib import Path

from meshonet.api.files import only
from meshonet.formats.registry import read_grids
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.quality.report import QualityReport, quality_report
from meshonet.geometry.threads import limited_to


def quality(
    grid: Grid | str | Path, *, profile: str | None = None, compare: Grid | str | Path | None = None,
    threads: int | None = None,
) -> QualityReport:  # fmt: skip
    """Measure a grid: folded cells, angles, skewness, walls, growth.

    Parameters
    ----------
    grid : Grid, str or Path
        A grid, or a file that holds one.
    profile : str, optional
        Thresholds to judge by: ``openfoam``, ``pointwise``, ``verdict`` or ``viscous``.
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


def single_grid(grid: Grid | str | Path) -> Grid:
    """Return the grid, or the only one of a file.

    Raises InputError: a file that cannot be read, or holds none or several.
    """
    if isinstance(grid, Grid):
        return grid
    nothing, several = (
        ("holds no grid", "use a file with one"),
        ("holds several grids", "read them one by one"),
    )
    return only(read_grids(str(grid)), str(grid), nothing, several)
