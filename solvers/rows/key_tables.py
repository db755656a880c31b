"""The key sections of a row, from the middle one to hub and casing, the two ways at the same time."""

from __future__ import annotations

import contextvars
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from meshonet.geometry.rows.row import Row
from meshonet.geometry.threads import thread_count
from meshonet.solvers.rows.key_sections import SectionLayout, SectionPlan, next_section, planned
from meshonet.solvers.rows.section_plane import SectionPlane
from meshonet.solvers.rows.section_table import SectionTable, section_table
from meshonet.solvers.rows.span_lines import key_heights

KEYS = 9
"""Sections that are made as plane cascades."""


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
    planes = [SectionPlane.of(row, float(h), first, growth) for h in key_heights(KEYS)]
    plan, middle = planned(planes, cells, opposite=row.tip_gap > 0.0 or row.hub_gap > 0.0)
    table = section_table(plan, middle)
    half = KEYS // 2

    def chain(others: Sequence[SectionPlane]) -> list[SectionTable]:
        return _chain(plan, middle, table, others)

    ways = planes[half - 1 :: -1], planes[half + 1 :]
    if thread_count() > 1:
        with ThreadPoolExecutor(len(ways)) as pool:
            jobs = [pool.submit(contextvars.copy_context().run, chain, way) for way in ways]
            below, above = (job.result() for job in jobs)
    else:
        below, above = map(chain, ways)
    return KeyTables(tuple(planes), (*below[::-1], table, *above))


def _chain(
    plan: SectionPlan, section: SectionLayout, like: SectionTable, planes: Sequence[SectionPlane]
) -> list[SectionTable]:
    tables = []
    for plane in planes:
        section = next_section(plan, section, plane)
        tables.append(section_table(plan, section, like))
    return tables
