"""Aircraft: the grid around half a body with its wing, measured."""

from __future__ import annotations

from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.threads import limited_to
from meshonet.solvers.aircraft.request import AircraftRequest, aircraft_request
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import stage

_REMEDY = "use more nodes {around}, or a larger {first_cell}"  # where cells fold


def make_aircraft(aircraft: Aircraft, request: AircraftRequest | None = None) -> Result:
    """Return the grid around half an aircraft, measured.

    Raises InputError: a wing that does not begin in the body or does not leave it; NoValidGridError: cells
    are folded, and that was not allowed.
    """
    request = request or aircraft_request()
    seconds: dict[str, float] = {}
    chord = aircraft.wing.chord
    with limited_to(request.threads):
        with stage("load", seconds):
            from meshonet.solvers.aircraft.aircraft_grid import aircraft_grid
        with stage("grid", seconds):
            grid, notes = aircraft_grid(aircraft, request)
        note = request.height_note(f"on a chord of {chord:.6g}", chord)
        solution = Solution(grid, "aircraft", notes=(*notes, note) if note else notes)
        return judged(solution, seconds, request, remedy=_REMEDY)
