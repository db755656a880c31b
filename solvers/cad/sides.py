r"""Division of the faces of a CAD file into patches by their corners, and numbers of cells on sides.

::

    four corners          two corners               no corner
    +---------+           +------                   . - - .        ring of four patches
    |         |    base   |         nodes across    /+----+\       around a core
    |         |           |         the nose        |+----+|
    +---------+           +------                   ` - - '
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from meshonet.geometry.arrays import Floats, Indices
from meshonet.geometry.cad.model import CadFace, CadModel
from meshonet.geometry.errors import InputError, SolverError
from meshonet.geometry.ties import nearest_whole
from meshonet.solvers.cad.edges import CORNER_DEG, corner_turns, length_of, place_on
from meshonet.solvers.whole_numbers import Row, difference, whole_numbers

_REFUSED = 5  # faces named in an error
_ACROSS = 8  # smallest number of cells across a base, and across the nose opposite to it
_BASE = 0.7  # largest ratio of the base to the opposite side


@dataclass(frozen=True)
class FacePlan:
    """Division of a face into patches; a side lists consecutive edges by their positions in the face's loop.

    A ``quad`` has four sides, a ``nose`` a short one and a long one, a ``disc`` a single one with all edges.
    """

    kind: Literal["quad", "nose", "disc"]
    sides: tuple[tuple[int, ...], ...]


def planned(model: CadModel) -> tuple[FacePlan, ...]:
    """Return the division of each face into patches.

    Raises InputError, with number, sides and place of a face: it cannot become patches.
    """
    plans, problems = [], []
    for number, face in enumerate(model.faces, 1):
        plan = _plan(model, face)
        if isinstance(plan, str):
            middle = [edge.points for use in face.uses if (edge := model.edges[use.edge])]
            points = np.concatenate([each(np.array([0.5])) for each in middle if each is not None])
            problems.append(f"face {number} near {place_on(points)} has {plan}")
        else:
            plans.append(plan)
    if problems:
        more = f" and {len(problems) - _REFUSED} faces more" if len(problems) > _REFUSED else ""
        remedy = "split it there in the CAD program into faces of four sides"
        raise InputError("; ".join(problems[:_REFUSED]) + more, remedy)
    return tuple(plans)


def _plan(model: CadModel, face: CadFace) -> FacePlan | str:
    """Return the plan of a face, or as text the property that prevents one."""
    if face.holes:
        return "a hole" if face.holes == 1 else f"{face.holes} holes"
    turns = corner_turns(model, face.uses)
    corners = np.flatnonzero(turns > CORNER_DEG)
    if len(face.uses) == 4 and len(corners) >= 3:
        corners = np.arange(4)
    if len(corners) == 4:
        return FacePlan("quad", _runs(corners, len(face.uses)))
    if len(corners) == 2:
        runs = _runs(corners, len(face.uses))
        lengths = [sum(_length(model, face, k) for k in run) for run in runs]
        short, long = runs if lengths[0] <= lengths[1] else runs[::-1]
        if min(lengths) > _BASE * max(lengths):
            return "two sides that meet in two corners"
        return FacePlan("nose", (short, long))
    if not len(corners):
        return FacePlan("disc", (tuple(range(len(face.uses))),))
    words = {1: "one corner", 3: "three sides"}
    return words.get(len(corners), f"{len(corners)} sides")


def _runs(corners: Indices, count: int) -> tuple[tuple[int, ...], ...]:
    """Return the positions of edges in a loop from each corner to the next."""
    ends = [*corners.tolist(), int(corners[0]) + count]
    return tuple(tuple(k % count for k in range(a, b)) for a, b in pairwise(ends))


def _length(model: CadModel, face: CadFace, k: int) -> float:
    points = model.edges[face.uses[k].edge].points
    return 0.0 if points is None else length_of(points)


def cell_counts(model: CadModel, plans: tuple[FacePlan, ...], wanted: Floats) -> Indices:
    """Return even numbers of cells (edges,) near `wanted` (edges,) that agree on opposite sides of patches.

    Raises InputError: there are no such numbers.
    """
    rows: list[Row] = []
    for face, plan in zip(model.faces, plans, strict=True):
        runs = [[face.uses[k].edge for k in side] for side in plan.sides]
        if plan.kind == "quad":
            rows += [difference(runs[0], runs[2]), difference(runs[1], runs[3])]
        elif plan.kind == "nose":
            rows.append(difference(runs[0], [], 0.5 * _ACROSS, np.inf))
            rows.append(difference(runs[1], runs[0], 1.0, np.inf))
        else:
            rows.append(difference(runs[0], [], 2.0, np.inf))
    halves = np.maximum(nearest_whole(0.5 * wanted), 1.0)
    try:
        return 2 * whole_numbers(halves, np.ones(len(halves)), [row for row in rows if row[0]])
    except SolverError as error:
        problem = "no numbers of cells agree on opposite sides of all faces"
        raise InputError(problem, "split faces with several edges on a side") from error
