"""Options (fields of `GridRequest` and `Sampling`, settings of methods) and the grids that use each."""

from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from meshonet.geometry.errors import InputError


def _row(*options: str) -> frozenset[str]:
    return frozenset(" ".join(options).split())


COUNTED = ("ni", "nj", "nk")  # fields of `Sampling` that form the option ``res``
Counts: TypeAlias = int | tuple[int] | tuple[int, int] | tuple[int, int, int]
"""Number of nodes along all directions, or along each, or along xi only if growth determines the rows."""
_OFF_WALLS = _row("first_cell y_plus spacing_south spacing_north")
"""Options that prescribe first cells at the ends of grid lines along eta."""
ALWAYS = _row("sampling method settings repair allow_invalid percentiles history threads")
"""Fields of `GridRequest` that apply to all kinds of grids."""
SETTINGS = {"polish": "auto", "answer": "valid", "blending": "arclength"}
"""Defaults of settings; the default of all other settings is None."""


_SHAPE = "topology spacing le_spacing te_spacing far_field corners normalise te wake wake_nodes "
_SHAPE += "base base_nodes smooth refined"
_SIDES = "spacing_south spacing_north spacing_west spacing_east"
_FIRST = "first_cell y_plus reynolds chord_fraction length growth"

MARCHED = "a grid marched from the wall"
AROUND_BASE = "a C grid that keeps a base"
ONE = "a grid in the plane"
CHANNEL = "a channel with given wall nodes"
MANY = "a domain of many blocks"
SMOOTHED = "a domain of many blocks that are there already"
OFF_SURFACE = "marching from a surface"
INSIDE = "six faces"
JOINED = "blocks that are there already"
GIVEN_SECTION = "a section that is a grid"

_OF_MARCHED = _row("res", _SHAPE, _FIRST, "constant_layers repair_margin blocks refine", _SIDES)
_OF_ONE = _OF_MARCHED | _row("slide wall_angle coarse initial walls")
_OF_MANY = _row("res far_field te base smooth normalise", _FIRST, "constant_layers refine") | _row(
    "cells cell_size walls pitch inlet outlet layout periodic count"
)
USES: dict[str, frozenset[str]] = {
    MARCHED: _OF_MARCHED,
    AROUND_BASE: _OF_MARCHED - _row(_SIDES, "corners repair_margin"),
    ONE: _OF_ONE,  # and the settings of the method, which refuses others itself
    CHANNEL: _OF_ONE,  # with those of methods that are no networks
    MANY: _OF_MANY,
    SMOOTHED: _OF_MANY | _row("slide max_cycles"),
    OFF_SURFACE: _row(_FIRST, "far_field layers symmetry poles"),
    INSIDE: _row("res coarse blending tol max_cycles energy model answer"),
    "variational in space": _row("res coarse max_cycles energy"),
    "winslow in space": _row("res tol max_cycles"),
    "tfi in space": _row("res blending"),
    "a network in space": _row("res model answer"),
    JOINED: _row("slide max_cycles"),
    GIVEN_SECTION: frozenset(),
}
"""Options that apply, by the kind of grid."""

FOR_MANY = tuple(sorted(USES[MANY] - USES[ONE]))  # options of which each asks for many blocks
OF_SURFACE = _row("layers symmetry poles")  # options that only apply to marching from a surface
IN_SPACE = OF_SURFACE | _row("energy")  # options that do not apply to planar grids


def counted(res: Counts | None, options: Mapping[str, Any]) -> dict[str, Any]:
    """Return the node counts of a `Sampling` from `res`, by name.

    A single number is the count along xi and eta, but only along xi if `options` have a growth ratio.
    """
    if isinstance(res, int):
        by_growth = options.get("growth") and any(map(options.get, _OFF_WALLS))
        res = (res,) if by_growth else (res, res)
    return dict(zip(COUNTED, res or (), strict=False))


def refuse(options: Iterable[str], way: str) -> None:
    """Raise InputError if one of the `options` does not apply to the kind of grid `way`, a key of `USES`."""
    for name in options:
        if name not in USES[way]:
            raise InputError(f"{{{name}}} is of no use to {way}", f"drop {{{name}}}")
