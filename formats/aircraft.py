"""Aircraft in TOML, an input of ``meshonet stack`` with ``kind = "aircraft"`` (docs/guide/aircraft.md)."""

from dataclasses import fields, replace
from pathlib import Path

import numpy as np

from meshonet.formats.rows.points import point_blocks
from meshonet.formats.source import Source, open_source, printable
from meshonet.formats.stack_table import along, section_shape, stack_options, stack_table
from meshonet.formats.toml_table import Table, toml_table
from meshonet.geometry.aircraft.aircraft import Aircraft
from meshonet.geometry.aircraft.axes import FILE_AXES, AircraftAxes
from meshonet.geometry.aircraft.body import Body
from meshonet.geometry.aircraft.body_section import BodySection
from meshonet.geometry.aircraft.fin import Fin
from meshonet.geometry.aircraft.lofted_body import LoftedBody
from meshonet.geometry.aircraft.surface_wing import SurfaceWing
from meshonet.geometry.arrays import Floats
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.sections.section import Section
from meshonet.geometry.sections.stack import Stack


def read_aircraft(data: Table, source: Source) -> Aircraft:
    """Return the aircraft that a table of a TOML file describes.

    Paths are relative to the folder of `source`. Raises InputError if a key is unknown, a value is invalid or
    a file is unreadable, or if there is not exactly one body.
    """
    data.only("kind", "name", "bodies", "wings", "half")
    folder = source.path.parent if source.path else Path()
    bodies, wings = data.rows("bodies"), data.rows("wings")
    if len(bodies) > 1:
        raise bodies[1].error("name", "a second one of bodies", "give one body")
    axes, notes = FILE_AXES, tuple[str, ...]()
    if "surface" in bodies[0].data:
        from meshonet.formats.aircraft_surface import surface_body  # which few aircraft need

        body, axes, notes = surface_body(bodies[0], folder)
    else:
        body = _body(bodies[0], folder)
    fins = [row.text("name", "fin") for row in wings if "plane" in row.data]
    wing, *others = [_wing(row, folder, body, axes, fins) for row in wings]
    name = data.text("name", source.stem or "aircraft")
    half = data.flag("half", default=True)
    return Aircraft(body, wing, name, half, tuple(others), axes, notes)


def _body(row: Table, folder: Path) -> Body:
    if "sections" in row.data:
        row.only("name", "sections")
        sections = tuple(_section(each, folder) for each in row.rows("sections", 4))
        with row.located():
            return LoftedBody(name=row.text("name", "fuselage"), sections=sections)
    row.only("name", "meridian", "y")
    meridian = _points(row, folder, "meridian", "x, r", 4)
    with row.located():
        return Body(meridian, row.number("y", 0.0), row.text("name", "fuselage"))


def _section(row: Table, folder: Path) -> BodySection:
    if "points" in row.data:
        row.only("x", "y", "points")
        points = _points(row, folder, "points", "y, z", 5)
        with row.located():
            return BodySection(row.number("x"), row.number("y", 0.0), points=points)
    row.only("x", "y", "width", "height", "exponent", "points")
    width, height = (row.number(key, 0.0) for key in ("width", "height"))
    with row.located():
        return BodySection(row.number("x"), row.number("y", 0.0), width, height, row.number("exponent", 2.0))


def _points(row: Table, folder: Path, key: str, columns: str, least: int) -> Floats:
    """Return the points (n, 2) of a key: a list, or the name of a file of two columns."""
    value = row.data.get(key)
    if isinstance(value, list):
        return np.array(row.pairs(key, least, columns))
    if not isinstance(value, str):
        remedy = f"name a file, or give [[{columns}], [{columns}]]"
        raise row.error(key, "is no file and no list of points", remedy)
    file = str(folder / row.text(key))
    with row.in_file_of(key):
        source = open_source(file)
        blocks = point_blocks(source, (columns,))
        if len(blocks) > 1:
            raise InputError(f"holds {len(blocks)} blocks of points", "give one curve", source=source.name)
    return blocks[0]


def _wing(row: Table, folder: Path, body: Body, axes: AircraftAxes, fins: list[str]) -> Stack | SurfaceWing:
    on = row.text("on", body.name)
    if on in fins:
        problem = f"a wing on the {printable(on)}, as in a T-tail, cannot be made"
        raise row.error("on", problem, f"use {body.name}")
    if on != body.name:
        raise row.error("on", f"{printable(on)} is no body", f"use {body.name}")
    if "surface" in row.data:
        from meshonet.formats.aircraft_surface import surface_wing

        return surface_wing(row, folder, axes)
    fin = "plane" in row.data
    if fin:
        row.word("plane", ("symmetry",), "symmetry")
    if "file" not in row.data:
        with row.located():
            return _fin(row, folder, ("on", "plane")) if fin else stack_table(row, folder, "wing", ("on",))
    row.only("on", "name", "file", "plane")
    file = str(folder / row.text("file"))
    with row.in_file_of("file"):
        source = open_source(file)
    with in_source(source.name):
        wing = stack_table(toml_table(source), source.path.parent if source.path else folder, "wing")
        if fin:
            return _fin_of(wing, row.text("name", "fin"))
    return replace(wing, name=row.text("name", wing.name))


def _fin(data: Table, folder: Path, more: tuple[str, ...]) -> Fin:
    """Return the fin of a table, which may also have the keys `more`; paths are relative to `folder`.

    Raises InputError: a section that is not symmetric; see also `stack_table`.
    """
    options = stack_options(data, "fin", more)
    sections: list[Section] = []
    for row in data.rows("sections", least=2):
        sections.append(_fin_section(row, sections, folder))
    return Fin(tuple(sections), **options)


def _fin_of(wing: Stack, name: str) -> Fin:
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
