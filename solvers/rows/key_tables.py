"""The key sections of a row, from the middle one to hub and casing, the two ways at the same time."""

from __future__ import annotations

import contextvars
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from meshonet.geometry.errors import NoValidGridError
from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import thread_count
from meshonet.solvers.blocking.cascade.cascade_layout import straight_rows
from meshonet.solvers.blocking.cascade.passage import NEAR
from meshonet.solvers.rows.key_sections import SectionLayout, SectionPlan, next_section, planned
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.section_table import SectionTable, section_table
from meshonet.solvers.rows.span_lines import key_heights

KEYS = 9
"""Sections that are made as plane cascades."""
_PART = 0.6  # of the least room before or behind the blade that is left to blocks
_HALVINGS = 3


@dataclass(frozen=True, eq=False)
class KeyTables:
    """Key sections at `key_heights`, from hub to casing."""

    planes: tuple[SectionPlane, ...]
    tables: tuple[SectionTable, ...]


def key_tables(row: Row, first: float, growth: float, cells: int) -> KeyTables:
    """Return the key sections of a row, of about so many `cells` each.

    `first` and `growth` are those of the layers around the blade. Raises InputError: no room for layers,
    inlet or outlet; NoValidGridError: folds.
    """
    planes = _planes(row, first, growth)
    plan, middle = planned(planes, cells, opposite=row.tip_gap > 0.0 or row.hub_gap > 0.0)
    near, thickest = planes[0].cascade.near, planes[KEYS // 2].thickest
    table = section_table(plan, middle, longest=_longest(planes))
    half = KEYS // 2

    def chain(others: Sequence[SectionPlane]) -> list[SectionTable]:
        return _chain(plan, middle, table, others, plane_at)

    def plane_at(height: float) -> SectionPlane:
        return SectionPlane.of(row, height, first, growth).ending(near, thickest)

    ways = planes[half - 1 :: -1], planes[half + 1 :]
    if thread_count() > 1:
        with ThreadPoolExecutor(len(ways)) as pool:
            jobs = [pool.submit(contextvars.copy_context().run, chain, way) for way in ways]
            below, above = (job.result() for job in jobs)
    else:
        below, above = map(chain, ways)
    return KeyTables(tuple(planes), (*below[::-1], table, *above))


def _planes(row: Row, first: float, growth: float) -> list[SectionPlane]:
    """Return the key sections, in all of which straight rows lead to inlet and outlet."""
    planes = [SectionPlane.of(row, float(h), first, growth) for h in key_heights(KEYS)]
    before, behind = (min(NEAR, _PART * min(plane.room[k] for plane in planes)) for k in (0, 1))
    thickest = planes[KEYS // 2].thickest
    return [plane.ending((before, behind), thickest) for plane in planes]


def _longest(planes: Sequence[SectionPlane]) -> dict[int, float]:
    """Return the greatest lengths of the rows to inlet and outlet, by the number of their loop."""
    rows = [row for plane in planes for row in straight_rows(plane.cascade)]
    return {number: max(length for own, length, _ in rows if own == number) for number, _, _ in rows}


def _chain(
    plan: SectionPlan, section: SectionLayout, like: SectionTable, planes: Sequence[SectionPlane],
    plane_at: Callable[[float], SectionPlane],
) -> list[SectionTable]:  # fmt: skip
    """Return the tables of sections that follow one another, each from the one before."""
    tables = []
    for plane in planes:
        section = _reached(plan, section, plane, plane_at, _HALVINGS)
        tables.append(section_table(plan, section, like))
    return tables


def _reached(
    plan: SectionPlan, section: SectionLayout, plane: SectionPlane,
    plane_at: Callable[[float], SectionPlane], halvings: int,
) -> SectionLayout:  # fmt: skip
    """Return a section from another, where cells stay folded by way of that half-way between both."""
    try:
        return next_section(plan, section, plane)
    except NoValidGridError:
        if not halvings:
            raise
    between = plane_at(0.5 * (section.plane.height + plane.height))
    half = _reached(plan, section, between, plane_at, halvings - 1)
    return _reached(plan, half, plane, plane_at, halvings - 1)
