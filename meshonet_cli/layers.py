"""The options that say how high the cells at a wall are, and the solver they ask for."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

if TYPE_CHECKING:
    from geometry.boundary import Boundary
    from meshonet_cli.options import SpacingName
    from solvers.solution import Solution

Method: TypeAlias = "Callable[[Boundary], Solution]"

# fmt: off
WallSpacing = Annotated[
    float | None,
    typer.Option(
        "--wall-spacing", metavar="H", show_default=False,
        help="Height of the first cell at every wall node, in chords: a grid for boundary layers, marched "
        "from the wall (method hyperbolic).",
    ),
]
YPlus = Annotated[
    float | None,
    typer.Option(
        "--y-plus", metavar="Y", show_default=False,
        help="The same by its y+, estimated as on a flat plate; needs --reynolds.",
    ),
]
Reynolds = Annotated[
    float | None,
    typer.Option("--reynolds", metavar="RE", show_default=False, help="Reynolds number of the chord."),
]
ChordFraction = Annotated[
    float,
    typer.Option(
        "--chord-fraction", metavar="X", help="Where along the chord --y-plus is estimated, 0 to 1."
    ),
]
Growth = Annotated[
    float | None,
    typer.Option(
        "--growth", metavar="G", show_default=False,
        help="Largest ratio of neighbouring cells away from the wall, e.g. 1.15; without --res there are as "
        "many rows as it needs. [default: what the rows need]",
    ),
]
# fmt: on


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


def read_layers(
    wall_spacing: float | None,
    y_plus: float | None,
    reynolds: float | None,
    chord_fraction: float,
    growth: float | None,
    res: str | None,
) -> Layers | None:
    """Return what the options ask for, None when they do not.

    Raises
    ------
    InputError
        options that need or exclude each other, values out of range.
    """
    from geometry.errors import InputError
    from geometry.flat_plate import FORMULA, SOURCE, first_cell

    if wall_spacing is not None and y_plus is not None:
        raise InputError(
            "--wall-spacing and --y-plus both say how high the first cell is", "give one of them"
        )
    if (y_plus is None) != (reynolds is None):
        missing, given = ("--reynolds", "--y-plus") if reynolds is None else ("--y-plus", "--reynolds")
        raise InputError(f"{given} without {missing}", f"give {missing} as well")
    note = ""
    if y_plus is not None and reynolds is not None:
        wall_spacing = first_cell(y_plus, reynolds, chord_fraction)
        note = (
            f"y+ {y_plus:g} at Re {reynolds:g} and x/c {chord_fraction:g} is {wall_spacing:.6g} chords: "
            f"{FORMULA} ({SOURCE})"
        )
    if wall_spacing is None:
        if growth is not None:
            raise InputError("--growth without a first cell", "give --wall-spacing or --y-plus as well")
        return None
    from solvers.hyperbolic import check_layers

    try:
        check_layers(wall_spacing, growth)
    except InputError as error:
        error.source = error.source or ("--growth" if "growth" in error.problem else "--wall-spacing")
        raise
    return Layers(wall_spacing, growth, growth is not None and res is None, note)


def spacing_along(layers: Layers | None, asked: SpacingName) -> SpacingName:
    """Return the law of the wall nodes: for layers, cells that grow slowly unless told otherwise."""
    return "curvature" if layers is not None and asked == "auto" else asked


def marching(method: str, layers: Layers | None, unused: Mapping[str, object]) -> Method | None:
    """Return the solver that marches `layers`, or None when `method` is another one.

    Parameters
    ----------
    method : ``auto`` marches when there are layers.
    layers : asked for.
    unused : values by option, not None when given, of no use to a march.

    Raises
    ------
    InputError
        a method and options that do not go together.
    """
    from geometry.errors import InputError

    if layers is None and method != "hyperbolic":
        return None
    if layers is None:
        raise InputError(
            "--method hyperbolic without a first cell", "give --wall-spacing or --y-plus as well"
        )
    if method not in ("auto", "hyperbolic"):
        raise InputError(f"--method {method} cannot set the first cell", "use --method hyperbolic")
    for option, value in unused.items():
        if value is not None:
            raise InputError(f"{option} is of no use to a grid marched from the wall", f"drop {option}")
    return partial(_marched, layers=layers)


def _marched(boundary: Boundary, *, layers: Layers) -> Solution:
    from solvers.hyperbolic import hyperbolic

    solution = hyperbolic(
        boundary, wall_spacing=layers.wall_spacing, growth=layers.growth, free_rows=layers.free_rows
    )
    return replace(solution, notes=(layers.note, *solution.notes) if layers.note else solution.notes)
