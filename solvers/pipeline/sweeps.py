"""Sweeps the planar grid of a section along a path and measures the volume."""

import re

from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.revolve import FLOWS, Revolution, revolved
from meshonet.geometry.curves.path import Path
from meshonet.geometry.quality.walls import wall_rows
from meshonet.geometry.shapes.shape import Shape
from meshonet.geometry.threads import limited_to
from meshonet.solvers.pipeline.cross_section import section_grid
from meshonet.solvers.pipeline.request import GridRequest
from meshonet.solvers.pipeline.result import Result, judged
from meshonet.solvers.solution import Solution
from meshonet.solvers.stages import stage
from meshonet.solvers.sweeping.sweep import Sweep, check_planes, reach_of, self_crossing, sweep, walled

SMALL = 0.1  # ratio of the sizes of the smaller and the larger end section below which there is a note
_REMEDY = "use a wider bend, a smaller section or more {planes}"  # where cells fold


def make_sweep(
    shape: Shape | Grid, path: Path | Revolution, request: GridRequest, settings: Sweep | None = None,
    around: int | None = None,
) -> Result:  # fmt: skip
    """Return the volume grid of a cross-section swept along a path or about an axis, with its quality.

    `request` and `around` are the options of the section's planar grid (`section_grid`). Raises InputError if
    parameters, section and path do not suit each other. Raises NoValidGridError if cells are folded and the
    request does not allow that.
    """
    seconds: dict[str, float] = {}
    with limited_to(request.threads):
        with stage("boundary", seconds):
            section, notes = section_grid(shape, request, around)
        with stage("grid", seconds):
            if isinstance(path, Revolution):
                check_planes(section, path.planes)
                grid = revolved(walled(section), path, FLOWS)
            else:
                grid = sweep(section, path, settings)
                if settings and settings.scale != 1.0:
                    notes = _tapered(notes, grid, settings.scale, layers=request.at_walls)
                notes = (*notes, *_crossing_notes(path, section))
        solution = Solution(grid, "sweep", notes=notes)
        return judged(solution, seconds, request, remedy=_REMEDY)


def _tapered(notes: tuple[str, ...], grid: Grid, scale: float, *, layers: bool) -> tuple[str, ...]:
    """Return the notes on a section with those on first cells, which change along the path with its size."""
    start = "at the start of the path: "
    notes = tuple(start + note if re.search(r"first[ -]cell", note) else note for note in notes)
    if layers:
        heights = ((row.name, row.height) for row in wall_rows(grid, grid.walls()))
        notes += tuple(
            f"{name}: first cells {h.min:.6g} to {h.max:.6g} along the path" for name, h in heights
        )
    if not SMALL <= scale <= 1.0 / SMALL:
        what = f"the section ends {scale:g} times as large as it begins"
        notes += (f"{what}: this {{scale}} is a taper; lengths of a grid are changed by that of convert",)
    return notes


def _crossing_notes(path: Path, section: Grid) -> tuple[str, ...]:
    crossing = self_crossing(path, reach_of(section))
    if crossing is None:
        return ()
    where = "({:.4g}, {:.4g}, {:.4g})".format(*crossing)
    return (f"the path comes back near itself: the volume may run through itself near {where}",)
