"""The sections of a fin in a table of TOML: like those of a wing, but upwards along y."""

from dataclasses import fields
from pathlib import Path

from meshonet.formats.section_shape import section_shape
from meshonet.formats.stack_table import along, stack_options
from meshonet.formats.toml_table import Table
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack


def fin_table(data: Table, folder: Path, more: tuple[str, ...]) -> Fin:
    """Return the fin of a table, which may also have the keys `more`; paths are relative to `folder`.

    Raises InputError: a section that is not symmetric; see also `stack_table`.
    """
    options = stack_options(data, "fin", more)
    sections: list[Section] = []
    for row in data.rows("sections", least=2):
        sections.append(_fin_section(row, sections, folder))
    return Fin(tuple(sections), **options)


def fin_of(wing: Stack, name: str) -> Fin:
    """Return a wing as a fin, whose span is along y; `name` is the name of the fin."""
    values = {field.name: getattr(wing, field.name) for field in fields(wing)}
    return Fin(**(values | {"name": name}))


def _fin_section(row: Table, before: list[Section], folder: Path) -> Section:
    row.only("airfoil", "chord", "y", "x", "sweep")
    y = row.number("y")
    if before and not y > before[-1].z:
        remedy = "give sections upwards; fins below a body are not made"
        raise row.error("y", f"{y:g} is not above {before[-1].z:g}", remedy)
    return Section(section_shape(row, folder), row.positive("chord"), y, along(row, "x", "sweep", y, before))
