"""First cells at walls and growth ratios, measured on the grid for the report."""

import numpy as np

from meshonet.geometry.blocks.across import rows_at
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.blocks.vertices import vertices
from meshonet.geometry.quality.growth import Extreme, Growth, growth, growth_off_walls, most_of, ratios
from meshonet.geometry.quality.lines import Lines, lines, solid_lines
from meshonet.geometry.quality.walls import wall_rows
from meshonet.geometry.summary import named

_SAME = 1e-6  # relative tolerances for equal first cells and for growth above the limit


def wall_facts(grid: Grid) -> tuple[str, ...]:
    """Return notes on first cells and growth ratios at each wall of a multi-block grid."""
    notes = []
    for row in wall_rows(grid, grid.walls(), lines_without_percentiles(grid).by_wall):
        low, high = row.height.min, row.height.max
        cells = f"{low:.6g}" if high - low <= _SAME * high else f"{low:.6g} to {high:.6g}"
        rows = f", growth up to {row.growth.max:.3f} along lines from it" if row.growth else ""
        notes.append(f"{row.name}: first cells {cells}{rows}")
    return tuple(notes)


def growth_note(grid: Grid, limit: float, known: Lines | None = None) -> tuple[str, ...]:
    """Return a note with the greatest growth ratio along grid lines, and its node, if above `limit`.

    If this ratio is not on a line from a wall, the note also has the greatest ratio along lines from walls.
    If `grid` has several blocks, `known` may have its growth ratios; they are then not computed again.
    """
    ratios, leaving = _growth(grid, known)
    largest = most_of(ratios.families().values())
    if largest is None or largest.max <= limit * (1.0 + _SAME):
        return ()
    where = f"along {largest.along} at {_place(grid, largest)}, above the limit of {limit:g}"
    beside = ""
    if leaving and leaving.max < largest.max:
        beside = f"; along grid lines from walls it is {leaving.max:.3f}"
        if leaving.max > limit * (1.0 + _SAME):
            beside += f", at {_place(grid, leaving)}"
    return (f"the largest growth ratio is {largest.max:.3f}, {where}{beside}",)


def _place(grid: Grid, largest: Extreme) -> str:
    """Return the node of the greatest value, by its indices and coordinates."""
    block, *node = largest.at if len(largest.at) > 2 else (0, *largest.at)
    point = grid.blocks[block].nodes[tuple(node)]
    tiny = np.abs(point) < _SAME * np.abs(point).max()
    return f"{named(largest.at)} ({', '.join(map('{:.4g}'.format, np.where(tiny, 0.0, point)))})"


def jump_note(grid: Grid, most: float) -> tuple[str, ...]:
    """Return a note on the greatest size ratio of neighbouring cells along walls, if it exceeds `most`."""
    note: tuple[str, ...] = ()
    for wall in grid.walls():
        nodes = rows_at(grid, wall, 1)[0]
        jumps = ratios(nodes) if len(nodes) > 2 else np.zeros(0)
        if jumps.size and jumps.max() > most:
            k = int(jumps.argmax()) + 1
            most, (x, y) = float(jumps[k - 1]), nodes[k].tolist()
            note = (
                f"cells along {wall.name} jump in size by a factor of {most:.3g} at ({x:.6g}, {y:.6g}): see "
                "whether its outline has a step or a short side there, or use more nodes",
            )
    return note


def _growth(grid: Grid, known: Lines | None) -> tuple[Growth, Extreme | None]:
    """Return the ratios of neighbouring cells along each direction, and along lines from walls."""
    if grid.topology != "blocks":
        ratios = growth(grid)
        return ratios, growth_off_walls(ratios, grid.walls())
    known = known or lines_without_percentiles(grid)
    return known.growth, known.leaving


def lines_without_percentiles(grid: Grid) -> Lines:
    """Return growth ratios and turning angles along the grid lines of a multi-block grid."""
    return solid_lines(grid, percentiles=False) if grid.form == "volume" else lines(grid, vertices(grid))
