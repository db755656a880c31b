"""Zones of the span: a gap at the hub, the blade, a gap at the tip."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from meshonet.geometry.rows.row import Row
from meshonet.solvers.rows.span_spacing import spaced_cells

PARTS, PARTS_CELLS = 42.0, 800_000
"""Cells along the span away from walls, if all of it were divided like that, of a row of so many cells."""
_NEEDED, _FEWEST, _ENOUGH = 740.0, 1700, 8000
"""Fewest cells of a section, times the logarithm of the growth, within these bounds.

With fewer, cells at the edges of blades are too small for those between to grow as slowly.
"""
_INSIDE = 0.33
"""Cells inside the outline of the blade in a gap, in those of a section around it."""
_LONGER = 1.15  # than across the gap lines may be, which lean
GAP_ROWS = 17
"""Fewest cells across a gap."""


@dataclass(frozen=True)
class Zone:
    """A part of the span.

    Parameters
    ----------
    low, high : heights at which it begins and ends.
    ends : heights of its first and its last cells, in the unit of the row.
    cells : across it.
    gap : whether there is no blade in it.
    """

    low: float
    high: float
    ends: tuple[float, float]
    cells: int
    gap: bool


def section_cells(zones: Sequence[Zone], cells: int, growth: float) -> int:
    """Return how many cells a section has where the row has about `cells` in all, or what growth needs."""
    return max(_needed(growth), int(cells / _sections(zones)))


def fewest_cells(zones: Sequence[Zone], growth: float) -> int:
    """Return about how many cells a row has at least, so that they grow by `growth`."""
    return round(_needed(growth) * _sections(zones))


def _needed(growth: float) -> int:
    return min(max(round(_NEEDED / math.log(growth)), _FEWEST), _ENOUGH)


def _sections(zones: Sequence[Zone]) -> float:
    """Return how many times the cells of a section there are, with those inside gaps."""
    return sum(zone.cells * (1.0 + _INSIDE * zone.gap) for zone in zones)


def zones_of(row: Row, first: float, growth: float, cells: int) -> list[Zone]:
    """Return the zones of a row of about so many `cells`, from hub to casing.

    Cells in gaps start with `first`, or less where the gap is too narrow for `GAP_ROWS` of that.
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
