"""Aircraft: the grid around a body with its wings, measured."""

import math

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.dimensions import aircraft_dimensions
from meshonet.geometry.errors import InputError
from meshonet.geometry.threads import limited_to
from meshonet.solvers.aircraft.request import AircraftRequest
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import stage

_REMEDY = "use more nodes {around}, or a larger {first_cell}"  # where cells fold

_HIGHEST = 0.1  # largest height of first cells, in chords of the smallest section

_REACH = 0.8
"""Largest distance of the tip of a wing from the middle of the body, relative to that of the far field."""


def make_aircraft(aircraft: Aircraft, request: AircraftRequest | None = None) -> Result:
    """Return the grid around an aircraft or around its half, with the quality of the grid.

    Raises InputError if a wing does not begin in the body, does not leave it, or reaches the far field.
    Raises NoValidGridError if cells are folded and the request does not allow that.
    """
    request = request or AircraftRequest()
    seconds: dict[str, float] = {}
    request.check_far_field()
    sizes = aircraft_dimensions(aircraft, request.height(), request.far_field)
    shortest = min(float(wing.chords.min()) for wing in aircraft.wings)
    if sizes.first_cell > _HIGHEST * shortest:
        problem = f"first cells are {sizes.first_cell:g} high at a wing with a chord of {shortest:g}"
        raise InputError(problem, f"use at most {_HIGHEST:g} of it", parameter="first_cell")
    _refuse_far_tip(aircraft, sizes.far_field)
    with limited_to(request.threads):
        with stage("load", seconds):
            from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
        with stage("grid", seconds):
            grid, growth, notes = aircraft_grid(aircraft, request)
        notes = (*notes, *request.height_notes(f"on a chord of {sizes.chord:.6g}", sizes.chord))
        solution = Solution(grid, "aircraft", notes=notes, dimensions=sizes, growth=growth)
        return judged(solution, seconds, request, remedy=_REMEDY)


def _refuse_far_tip(aircraft: Aircraft, far: float) -> None:
    body = aircraft.body
    middle = 0.5 * float(body.meridian[0, 0] + body.meridian[-1, 0])
    for wing, (name, _) in zip(aircraft.wings, aircraft.patches, strict=True):
        x, y, z = wing.end
        away = math.hypot(x - middle, y - body.y, z)
        if away > _REACH * far:
            at = f"the tip of the {name} is {away:.6g} from the middle of the body"
            raise InputError(
                f"{at}, and the far field {far:.6g}", "put it further away", parameter="far_field"
            )
