"""`meshonet.stack`."""

from pathlib import Path
from typing import Any

from meshonet.formats.stack import stack_of
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.sections.stack import Stack, Tip
from meshonet.solvers.pipeline.stacks import make_stack, stack_surface
from meshonet.solvers.stacking.request import stack_request


def stack(
    sections: str | Path | Stack, *, tip: Tip | None = None, surface: bool = False, **parameters: Any
) -> Grid:
    """Return the volume grid around a wing or blade, or inside a duct, from cross-sections.

    Parameters
    ----------
    sections : str, Path or Stack
        The stack of sections, or its TOML file.
    tip : {'round', 'flat', 'open'}, optional
        Shape of the tip of a wing; None is that of the stack.
    surface : bool, optional
        Return the patches of the surface instead of a volume.
    **parameters
        Fields of `meshonet.StackRequest`, such as ``around``, ``span``, ``first_cell``, ``y_plus``,
        ``reynolds``, ``layers``, ``growth``, ``far_field``.

    Returns
    -------
    Grid
        The volume grid, or the surface patches.

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
    what = (sections if isinstance(sections, Stack) else stack_of(str(sections))).with_tip(tip)
    request = stack_request(**parameters)
    return stack_surface(what, request)[0] if surface else make_stack(what, request).grid
