"""Nodes along the wall of an airfoil: at equal angles on a circle, or with cells of planned sizes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.arrays import Floats
from meshonet.geometry.conformal.spacing import conformal_knots
from meshonet.geometry.errors import InputError
from meshonet.geometry.spacing.laws import LAWS
from meshonet.geometry.spacing.sampling import Sampling

if TYPE_CHECKING:
    from meshonet.geometry.shapes.airfoil.airfoil import Airfoil


def wall_arcs(body: Airfoil, ni: int, sampling: Sampling) -> Floats:
    """Return the arc lengths (ni,) of the wall nodes, from 0 to the length of the curve.

    With the spacing ``conformal``, nodes have equal angles in a conformal map to the circle. With ``tanh`` or
    ``auto``, cells on each side grow by a hyperbolic tangent from the leading and from the trailing edge.
    ``tanh`` replaces ``cosine`` if a cell length is given or the trailing edge is blunt. ``curvature``: see
    `geometry.spacing.size_field`. If `le_spacing` or `te_spacing` is given, it is met within 1 %. Raises
    InputError: too few nodes.
    """
    least = 7 if body.half_base else 5
    if ni < least:
        raise InputError(f"{ni} nodes around an airfoil", f"use at least {least}")
    steps_given = sampling.le_spacing is not None or sampling.te_spacing is not None
    if steps_given and not LAWS[sampling.spacing].sets_ends:
        others = [name for name, law in LAWS.items() if law.sets_ends and name != "auto"]
        remedy = f"use {', '.join(others[:-1])} or {others[-1]} with it"
        raise InputError(f"{sampling.spacing} spacing leaves no cell size to choose", remedy)
    steps = sampling.corner_steps(ni - 1)
    if sampling.spacing == "conformal":
        blunt = body.half_base and not body.base_is_round
        corners = np.array([body.half_base, body.upper_end]) if blunt else np.zeros(0)
        at = None
        if sampling.base_nodes:
            from meshonet.geometry.shapes.airfoil.wall_plan import half_of_base

            half = half_of_base(ni - 1, sampling.base_nodes, sampling)
            at = np.array([half, ni - 1 - half])
        arcs = conformal_knots(body.curve, corners, ni, at, steps)
    else:
        from meshonet.geometry.shapes.airfoil.wall_plan import planned_arcs

        arcs = planned_arcs(body, ni, sampling)
    if not body.inner_corners.size:
        return arcs
    from meshonet.geometry.spacing.along_curve import on_corners

    ends = np.searchsorted(arcs, [body.half_base, body.upper_end])
    return on_corners(arcs, body.inner_corners, (int(ends[0]), int(ends[1])), steps[0])
