"""`meshonet.stack` and `meshonet.read_stack`."""

from pathlib import Path
from typing import Any

from meshonet.api.notes import noted, with_notes
from meshonet.formats.stack import stack_of
from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.rows.row import Row
from meshonet.geometry.sections.stack import Stack, Tip
from meshonet.solvers.pipeline.stacked import make_stacked, stacked_surface, with_tip


def stack(
    sections: str | Path | Stack | Row | Aircraft,
    *,
    tip: Tip | None = None,
    surface: bool = False,
    **parameters: Any,
) -> Grid:
    """Return the volume grid of a wing, a blade, a duct, a row of blades or an aircraft, from sections.

    Parameters
    ----------
    sections : str, Path, Stack, Row or Aircraft
        The stack of sections, the row of blades or the aircraft, or a TOML file that describes it.
    tip : {'round', 'flat', 'open'}, optional
        Shape of the tip of a wing; None: the tip given by the stack.
    surface : bool, optional
        Return the patches of the surface instead of a volume.
    **parameters
        Fields of `meshonet.StackRequest`, such as ``around``, ``span``, ``cells``, ``first_cell``,
        ``y_plus``, ``reynolds``, ``layers``, ``growth`` and ``far_field``. For a row, fields of
        `meshonet.RowRequest`: ``first_cell``, ``y_plus``, ``reynolds``, ``growth`` and ``cells``.

    Returns
    -------
    Grid
        The volume grid, or the surface patches. The `notes` of the grid say, for instance, that a trailing
        edge was opened, or how many cells the layers need.

    Raises
    ------
    InputError
        A file or parameter that cannot be used.
    NoValidGridError
        The grid has folded cells, and `allow_invalid` is not given.

    Examples
    --------
    >>> import meshonet
    >>> section = meshonet.read("naca:0012")
    >>> wing = meshonet.Stack((meshonet.Section(section, 1.0, 0.0), meshonet.Section(section, 0.5, 2.0)))
    >>> len(stack(wing, around=49, span=9, surface=True).blocks)
    3
    """
    what = sections if isinstance(sections, Stack | Row | Aircraft) else stack_of(str(sections))
    what = with_tip(what, tip, surface=surface)
    if surface and not isinstance(what, Row):
        return with_notes(*stacked_surface(what, **parameters))
    return noted(make_stacked(what, **parameters))


def read_stack(path: str | Path) -> Stack | Row | Aircraft:
    r"""Return the wing, blade, duct, blade row or aircraft that a TOML file of `stack` describes.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    Stack, Row or Aircraft
        A wing, blade or duct (`Stack`), a row of blades with lengths in metres, or an aircraft.

    Raises
    ------
    InputError
        The file cannot be read, or has a wrong key or value; the message gives the place.

    Examples
    --------
    >>> section = "[[sections]]\nairfoil = 'naca:0012'\nchord = {}\nz = {}\n"
    >>> _ = Path("wing.toml").write_text(section.format(1.0, 0.0) + section.format(0.5, 2.0))
    >>> read_stack("wing.toml").chord
    1.0
    """
    return stack_of(str(path))
