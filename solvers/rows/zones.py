"""Zones of the span: a gap at the hub, the blade, a gap at the tip."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.span_spacing import spaced_cells

PARTS, PARTS_CELLS = 42.0, 800_000
"""Cells along the span, if all were as long as in its middle, in a row of so many cells."""
# cells of a section: the first over log(growth), within the other two; fewer are too small at blade edges
_NEEDED, _FEWEST, _ENOUGH = 740.0, 1700, 8000
_INSIDE = 0.33  # cells inside the outline of the blade in a gap, relative to those of a section
_LONGER = 1.15  # than across the gap lines may be, which lean
GAP_ROWS = 17  # smallest number of cells across a gap


@dataclass(frozen=True)
class Zone:
    """A part of the span: a gap, or the blade."""

    low: float  # height of its lower end in the channel, 0 to 1
    high: float  # height of its upper end, 0 to 1
    ends: tuple[float, float]  # first and last cells along the span, in the unit of the row
    cells: int  # number of cells along the span
    gap: bool  # whether the zone is a gap


def section_cells(zones: Sequence[Zone], cells: int, growth: float) -> int:
    """Return the number of cells in each section of a row, for a grid with about `cells` cells in all.

    `zones` have the numbers of cells along the span. A section gets more cells if it needs them so that cells
    grow by at most the ratio `growth`.
    """
    return max(_needed(growth), int(cells / _sections(zones)))


def fewest_cells(zones: Sequence[Zone], growth: float) -> int:
    """Return about how many cells a whole blade row needs so that cells grow by at most `growth`."""
    return round(_needed(growth) * _sections(zones))


def _needed(growth: float) -> int:
    return min(max(round(_NEEDED / math.log(growth)), _FEWEST), _ENOUGH)


def _sections(zones: Sequence[Zone]) -> float:
    """Return how many times a section's cells there are, with those in gaps."""
    return sum(zone.cells * (1.0 + _INSIDE * zone.gap) for zone in zones)


def zones_of(row: Row, first: float, growth: float, cells: int) -> list[Zone]:
    """Return the zones (blade and gaps) of a row with about `cells` cells in total, from hub to casing.

    First cells in a gap are `first` high, or smaller so that `GAP_ROWS` cells fit into the gap.
    """
    channel = row.channel
    parts = PARTS * math.cbrt(cells / PARTS_CELLS)
    narrow = {gap: min(first, gap / GAP_ROWS) for gap in (row.hub_gap, row.tip_gap) if gap > 0.0}
    ends = narrow.get(row.hub_gap, first), narrow.get(row.tip_gap, first)
    width = channel.span * (channel.tip - channel.foot)
    zones = []
    if row.hub_gap > 0.0:
        zones.append(_gap(0.0, channel.foot, row.hub_gap, ends[0], growth))
    widest = _LONGER * channel.widest * (channel.tip - channel.foot)
    cells = spaced_cells(width, ends, growth, width / parts, spaced_cells(widest, ends, growth, widest, 8))
    zones.append(Zone(channel.foot, channel.tip, ends, cells, False))
    if row.tip_gap > 0.0:
        zones.append(_gap(channel.tip, 1.0, row.tip_gap, ends[1], growth))
    return zones


def _gap(low: float, high: float, width: float, first: float, growth: float) -> Zone:
    cells = spaced_cells(_LONGER * width, (first, first), growth, width / 4.0, GAP_ROWS)
    return Zone(low, high, (first, first), cells, True)
