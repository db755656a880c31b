"""Wings, blades and ducts from sections: the surface, and the volume that is marched or lofted."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from meshonet.geometry.blocks.block import Block
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.revolve import bent
from meshonet.geometry.errors import InputError
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.threads import limited_to
from meshonet.solvers.keywords import refuse_given
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.pipeline.wall_facts import wall_facts
from meshonet.solvers.solution import Solution
from meshonet.solvers.stacking.cell_count import with_counts
from meshonet.solvers.stacking.request import StackRequest
from meshonet.solvers.stacking.wing_surface import wing_surface
from meshonet.solvers.stages import stage

if TYPE_CHECKING:
    from meshonet.solvers.hyperbolic.volume.settings import VolumeMarch

_NEAR = 0.1  # deviation from the cells asked for, as a fraction, that is neither corrected nor noted
_TRIES = 3  # most wings that are made to come near to it
_BENT = math.radians(30.0)  # between panels, above which folded cells are put down to the bend
_UPRIGHT = math.radians(60.0)  # dihedral above which folded cells are put down to it
_REMEDY = "use more nodes {around}, a larger {first_cell} or a higher {base}"  # where cells fold


def stack_surface(stack: Stack, request: StackRequest | None = None) -> tuple[Grid, tuple[str, ...]]:
    """Return the surface patches of a wing or a blade, and notes.

    Raises InputError if the stack is a duct, or if node counts are too small.
    """
    if stack.kind == "duct":
        raise InputError("a duct has no surface of its own", "leave {surface} out", parameter="surface")
    request, more = _counted(stack, _with_panels(stack, request))
    shown = stack if stack.kind == "wing" else replace(stack, tip="open")
    grid, notes = wing_surface(shown, request.surface)
    return grid, (*notes, *more)


def make_stack(stack: Stack, request: StackRequest | None = None) -> Result:
    """Return the volume grid around a wing or a blade, or inside a duct, with its quality.

    Raises InputError if parameters do not suit the stack. Raises NoValidGridError if cells are folded and the
    request does not allow that.
    """
    request = _with_panels(stack, request)
    if stack.kind != "duct":
        request.check_far_field()
    seconds: dict[str, float] = {}
    with limited_to(request.threads):
        counted, notes = _counted(stack, request)
        if stack.kind != "wing":
            solution = _loft(stack, counted, seconds)
        elif request.cells is None:
            solution = _wing(stack, counted, seconds)
        else:
            solution, notes = _wing_of(request.cells, stack, request, counted, seconds)
        solution = replace(solution, notes=(*solution.notes, *notes))
        return judged(solution, seconds, request, remedy=_REMEDY)


def _wing_of(
    cells: int, stack: Stack, request: StackRequest, counted: StackRequest, seconds: dict[str, float]
) -> tuple[Solution, tuple[str, ...]]:
    """Return the volume around a wing with nearly `cells` cells, and notes; `counted` is tried first."""
    tried = [_wing(stack, counted, seconds)]
    rows = _rows(tried[0])
    while True:
        again, notes = with_counts(stack, request, cells, rows)
        made = min(tried, key=lambda each: abs(each.grid.cells - cells))
        far = abs(made.grid.cells - cells) > _NEAR * cells
        if again == counted or len(tried) == _TRIES or (len(tried) > 1 and not far):
            break
        tried.append(_wing(stack, again, seconds))
        counted, rows = again, (rows + _rows(tried[-1])) // 2
    if far and not notes:
        notes = (f"{made.grid.cells} cells, not {cells}: layers of cells change with the nodes on the wing",)
    return made, notes


def _rows(solution: Solution) -> int:
    return solution.grid.blocks[0].counts[2] - 1


def _with_panels(stack: Stack, request: StackRequest | None) -> StackRequest:
    """Return the request with the nodes along the span that all panels have, if these are given.

    Raises InputError: the request has another number of nodes along the span.
    """
    request = request or StackRequest()
    if stack.span is None:
        return request
    if request.span not in (None, stack.span):
        problem = f"{request.span} nodes, and the panels have {stack.span} nodes along the span"
        raise InputError(problem, "leave {span} out", parameter="span")
    return replace(request, span=stack.span)


def _counted(stack: Stack, request: StackRequest) -> tuple[StackRequest, tuple[str, ...]]:
    """Return the request with the nodes that its number of cells needs, if it has one, and notes."""
    if request.cells is None:
        return request, ()
    if stack.kind == "duct":
        refuse_given("a duct", {"cells": request.cells})
    if stack.kind == "blade":
        from meshonet.solvers.pipeline.lofts import blade_rows

        return with_counts(stack, request, request.cells, blade_rows(request))
    return with_counts(stack, request, request.cells, len(_march(stack, request).steps(stack.chord)))


def _march(stack: Stack, request: StackRequest) -> VolumeMarch:
    from meshonet.solvers.hyperbolic.volume.settings import VolumeMarch

    chord = stack.chord
    return VolumeMarch(
        first_cell=request.height() * chord, layers=request.layers, far_field=request.far_field * chord,
        symmetry="z", growth=request.growth,
    )  # fmt: skip


def _loft(stack: Stack, request: StackRequest, seconds: dict[str, float]) -> Solution:
    with stage("grid", seconds):
        from meshonet.solvers.pipeline.lofts import GROWTH, blade_volume, duct_volume

        grid, notes = (blade_volume if stack.kind == "blade" else duct_volume)(stack, request)
        if request.turn is not None:
            blocks = bent([block.nodes for block in grid.blocks], request.turn)
            grid = replace(grid, blocks=tuple(map(Block, blocks)))
    layered = stack.kind == "blade" or request.at_walls
    limit = request.growth or (math.inf if request.layers or not layered else GROWTH)
    if stack.kind == "duct":
        of_heights = request.height_notes(f"on a width of {stack.chord:.6g}", stack.chord)
    else:
        of_heights = request.height_notes(f"on a chord of {stack.chord:.6g}", scale=stack.chord)
    return Solution(grid, "loft", notes=(*notes, *of_heights), growth=limit)


def _wing(stack: Stack, request: StackRequest, seconds: dict[str, float]) -> Solution:
    """Return the volume marched from the surface of a wing, whose root is in a plane of symmetry."""
    if request.turn is not None:
        problem = "a wing is not turned about an axis"
        raise InputError(problem, "leave {revolve} out, or make a blade or duct", parameter="revolve")
    with stage("load", seconds):
        from meshonet.geometry.surface.surface import surface_of
        from meshonet.solvers.hyperbolic.volume.march import march_surface
    with stage("boundary", seconds):
        grid, notes = wing_surface(stack, request.surface)
        surface = surface_of(grid)
    chord = stack.chord
    settings = _march(stack, request)
    with stage("grid", seconds):
        solution = march_surface(surface, settings, wing=True, remedy=_remedy(stack))
    of_heights = request.height_notes(f"on a chord of {chord:.6g}", scale=chord)
    notes = (*notes, *of_heights, *solution.notes, *wall_facts(solution.grid))
    return replace(solution, grid=replace(solution.grid, name=stack.name), notes=notes)


def _remedy(stack: Stack) -> str:
    bends = abs(np.diff(stack.dihedrals, prepend=stack.dihedrals[0]))
    worst = int(bends.argmax())
    if bends[worst] > _BENT:
        angle, z = math.degrees(bends[worst]), stack.z[worst]
        where = f"at z={z:g}, where the dihedral changes by {angle:.0f} degrees"
        return f'give more sections {where}, with cant = "panel"'
    if stack.steep:
        return 'give the sections cant = "panel"'
    if abs(stack.dihedrals).max() > _UPRIGHT:
        return "give a wider bend, or less dihedral"
    return _REMEDY + (", or a larger tip_spacing" if stack.tip_spacing else ", or a nearer {far_field}")
