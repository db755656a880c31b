"""Marches layers from a wall, with a prescribed thickness for each column."""

from collections.abc import Callable, Sequence

import numpy as np

from meshonet.geometry.arrays import Bools, Floats, distinct, ring_of
from meshonet.geometry.elementary import power
from meshonet.geometry.errors import InputError
from meshonet.geometry.layout.lattice import corner_jacobians
from meshonet.geometry.spacing.gradual_sizes import graded
from meshonet.geometry.spacing.growth import cells_for_growth, growth_ratio
from meshonet.kernels._native import hyperbolic_march
from meshonet.solvers.hyperbolic.march import AREA_SMOOTHING
from meshonet.solvers.hyperbolic.settings import RISING, MarchSettings

GAP_PART = 0.38  # largest fraction of the gap in front of a wall that its layers fill
SLOPE = 0.25  # largest change of the thickness of layers per length along the wall
MARCH_GROWTH = 1.2  # ratio of neighbouring levels of the march; layers are redistributed along lines later
THINNER = 0.6  # factor on the thickness after every march has folded
TRIES = 4  # thicknesses, the last a fifth of the first
BLUNT = "{base} 0.005"  # option that opens the sharp edge of an airfoil
AT_SHARP_EDGE = (
    f"use thinner first cells; at the sharp edge of an airfoil give {BLUNT}, "
    "or {te} round in place of a wedge"
)
"""Remedy where layers fold because a wall turns by nearly 180 degrees."""
FEWEST_CELLS = 4.0  # smallest thickness of layers in first cells


def marched(
    start: Floats, thickness: Floats, first: float, attempts: Sequence[MarchSettings]
) -> tuple[Floats | None, Bools]:
    """Return the nodes (n, m, 2) of the best of several marches, and a mask (n,) of columns that fold.

    Columns start at the closed wall `start` (n, 2), which has the domain on its left, with cells of the
    height `first`. They are `thickness` (n,) long. Nodes are None if all marches overflow.
    """
    cells = cells_for_growth(first, float(thickness.max()), MARCH_GROWTH)
    heights = distinct(thickness)  # most columns have the same
    growths = [growth_ratio(first, each, cells) if each > cells * first else 1.0 for each in heights]
    ratios = np.array(growths)[np.searchsorted(heights, thickness)]
    best, where = None, np.ones(len(start), dtype=bool)
    for settings in attempts:
        levels = _march(start, cells, first, ratios, settings)
        if not np.isfinite(levels).all():
            continue
        folded = folded_columns(levels)
        if best is None or folded.sum() < where.sum():
            best, where = levels, folded
        if not folded.any():
            break
    return best, where


def fitted(
    start: Floats, arcs: Floats, length: float, room: Floats, thickness: float, first: float,
    attempts: Sequence[MarchSettings], *, place: Callable[[int], str],
) -> Floats:  # fmt: skip
    """Return layers (n, m, 2) at a closed wall that do not fold: m nodes on each of n lines from the wall.

    They are `thickness` thick, or thinner where `room` (n,) is smaller. `start` (n, 2) are the nodes of the
    wall, `arcs` (n,) their arc lengths, and `length` is the length of the wall. `place` returns the position
    of a line as text for messages. Raises InputError if a gap is too narrow, or if all attempts fold.
    """
    check_room(room, first, place)
    least = FEWEST_CELLS * first
    thickness = max(thickness, least)  # of thick first cells
    folded = np.zeros(len(start), dtype=bool)
    for _ in range(TRIES):
        wanted = graded(np.minimum(thickness, room), arcs, length, SLOPE)
        if wanted.min() < 0.99 * least:
            break
        levels, folded = marched(start, wanted, first, attempts)
        if levels is not None and not folded.any():
            return levels
        thickness *= THINNER
    raise InputError(
        f"layers of {first:.3g} fold at the wall",
        f"{AT_SHARP_EDGE}; elsewhere smooth the wall, or leave its layers out",
        place=place(int(np.argmax(folded))),
    )  # fmt: skip


def check_room(room: Floats, first: float, place: Callable[[int], str]) -> None:
    """Raise InputError if `room` (n,) is too small for first cells of height `first`.

    `room` is `GAP_PART` times the gap at n points of a wall. `place` returns a point's position as text.
    """
    k = int(np.argmin(room))
    if room[k] < FEWEST_CELLS * first:
        raise InputError(
            f"a gap of {room[k] / GAP_PART:.3g} leaves no room for layers of {first:.3g}",
            "use thinner first cells, or none there",
            place=place(k),
        )


def _march(start: Floats, cells: int, first: float, ratios: Floats, settings: MarchSettings) -> Floats:
    """Return levels (n, cells + 1, 2) whose steps grow by `ratios` (n,)."""
    levels = np.empty((2, cells + 1, len(start)))
    levels[:, 0] = start.T
    most = float(ratios.max())
    knobs = (
        settings.dissipation, settings.even, settings.tolerated, settings.bend, 1.0 + settings.theta,
        AREA_SMOOTHING, settings.sweeps, round(RISING * cells),
    )  # fmt: skip
    steps = np.asarray(first * power(most, np.arange(cells)), dtype=np.float64)
    hyperbolic_march(levels[0], levels[1], steps, *knobs, ends=None, ratios=ratios / most)
    return np.ascontiguousarray(levels.transpose(2, 1, 0))


def folded_columns(levels: Floats) -> Bools:
    """Return which columns (n,) have a folded cell; `levels` (n, m, 2) are m closed curves of n nodes."""
    cells = ring_of(np.concatenate([levels, levels[:1]])).transpose(1, 2, 0, 3)
    return np.asarray((corner_jacobians(cells.reshape(-1, 4, 2)) <= 0.0).reshape(len(levels), -1).any(axis=1))
