"""The options that say how high the cells at a wall are, and the solver they ask for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from meshonet.geometry.blocks.boundary import Boundary
    from meshonet.solvers.solution import Solution
    from meshonet_cli.options import LayerOptions, SpacingName


@dataclass(frozen=True)
class Layers:
    """What was asked of the cells at the wall.

    Parameters
    ----------
    wall_spacing : height of the first cell in chords.
    growth : largest ratio of neighbouring cells, or None.
    free_rows : whether growth decides how many rows there are.
    note : where the height comes from, when it was computed.
    """

    wall_spacing: float
    growth: float | None
    free_rows: bool
    note: str = ""


def read_layers(options: LayerOptions, res: str | None) -> Layers | None:
    """Return what the options ask for, None when they do not.

    Raises
    ------
    InputError
        options that need or exclude each other, values out of range.
    """
    from meshonet.geometry.errors import InputError
    from meshonet.geometry.spacing.y_plus import FORMULA, SOURCE, first_cell

    wall_spacing, y_plus, reynolds = options.wall_spacing, options.y_plus, options.reynolds
    chord_fraction, growth = options.chord_fraction, options.growth
    if wall_spacing is not None and y_plus is not None:
        raise InputError(
            "--wall-spacing and --y-plus both say how high the first cell is", "give one of them"
        )
    if (y_plus is None) != (reynolds is None):
        missing, given = ("--reynolds", "--y-plus") if reynolds is None else ("--y-plus", "--reynolds")
        raise InputError(f"{given} without {missing}", f"give {missing} as well")
    if y_plus is None and chord_fraction != 0.5:
        raise InputError("--chord-fraction without --y-plus", "give --y-plus and --reynolds as well")
    note = ""
    if y_plus is not None and reynolds is not None:
        wall_spacing = first_cell(y_plus, reynolds, chord_fraction)
        note = (
            f"y+ {y_plus:g} at Re {reynolds:g} and x/c {chord_fraction:g} is {wall_spacing:.6g} chords: "
            f"{FORMULA} ({SOURCE})"
        )
    if wall_spacing is None:
        return None
    if not 0 < wall_spacing < float("inf"):
        raise InputError(f"a wall spacing of {wall_spacing:g}", "use 1e-9 to 0.1", source="--wall-spacing")
    if growth is not None and not 1 < growth <= 10:
        raise InputError(
            f"a growth of {growth:g}", "give the ratio of neighbouring cells, such as 1.15", source="--growth"
        )
    return Layers(wall_spacing, growth, growth is not None and res is None, note)


def spacing_along(layers: Layers | None, asked: SpacingName) -> SpacingName:
    """Return the law of the wall nodes: for layers, cells that grow slowly unless told otherwise."""
    return "curvature" if layers is not None and asked == "auto" else asked


def march(boundary: Boundary, layers: Layers, constant: int = 1) -> Solution:
    """Return the grid marched from the wall of `boundary`, with `constant` equal first layers."""
    from meshonet.geometry.errors import InputError
    from meshonet.solvers.hyperbolic.march import check_layers, hyperbolic

    try:
        check_layers(layers.wall_spacing, layers.growth)
    except InputError as error:
        error.source = "--growth" if "growth" in error.problem else "--wall-spacing"
        raise
    solution = hyperbolic(
        boundary,
        wall_spacing=layers.wall_spacing,
        growth=layers.growth,
        free_rows=layers.free_rows,
        constant=constant,
    )
    return replace(solution, notes=(layers.note, *solution.notes) if layers.note else solution.notes)
