"""Blade rows in TOML, an input of ``meshonet stack`` with ``kind = "row"`` (docs/guide/blade-rows.md)."""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import numpy as np

from meshonet.formats.rows.points import placed_blocks, point_blocks
from meshonet.formats.source import Source, open_source
from meshonet.formats.stack_table import section_shape
from meshonet.formats.toml_table import Table
from meshonet.geometry.arrays import Floats
from meshonet.geometry.blocks.motion import Motion
from meshonet.geometry.elementary import cos, sin
from meshonet.geometry.errors import InputError, in_place
from meshonet.geometry.rows.cylinder import on_cylinder
from meshonet.geometry.rows.dimensions import row_dimensions
from meshonet.geometry.rows.frame import AXES, UNITS, axis_along, axis_name
from meshonet.geometry.rows.row import Row
from meshonet.geometry.rows.trim import Plane, WallPlanes
from meshonet.geometry.sections.section import QUARTER, Section

KEYS = (
    "kind", "name", "blades", "profiles", "sections", "hub", "shroud", "tip_gap", "hub_gap", "inlet",
    "outlet", "axis", "coordinates", "unit",
)  # fmt: skip
_STEEPEST = 89.0  # largest stagger in degrees; at 90 the blades close the channel
_PROFILE = re.compile(r"profile (\d+)")
_PERCENT = re.compile(r"\s*([0-9.eE+-]+)\s*%\s*")


def read_row(data: Table, source: Source) -> Row:
    """Return the blade row in a table of a TOML file; paths are relative to the folder of `source`.

    Raises InputError, with the place: an unknown key; an invalid value; an unreadable file; see also `Row`.
    """
    data.only(*KEYS)
    folder = source.path.parent if source.path else Path()
    unit = data.word("unit", tuple(UNITS), "m")
    frame = _frame(data)
    hub, shroud = (_wall(data, key, folder, frame) for key in ("hub", "shroud"))
    planes = WallPlanes(_plane(data, "inlet"), _plane(data, "outlet"), axis_name(frame), unit)
    (hub, one), (shroud, other) = planes.trimmed(hub, 0), planes.trimmed(shroud, 1)
    if ("profiles" in data.data) == ("sections" in data.data):
        problem = "stands beside sections" if "profiles" in data.data else "is missing"
        raise data.error("profiles", problem, "give profiles or [[sections]]")
    notes = (*one, *other)
    if "profiles" in data.data:
        profiles, places = _profiles(data, folder, frame)
    else:
        made = [_section(row, folder) for row in data.rows("sections", least=2)]
        profiles = [points for points, _ in made]
        places = [f"sections[{k}]" for k in range(len(made))]
        notes += tuple(dict.fromkeys(note for _, own in made for note in own))
    blades = data.number("blades")
    if blades != round(blades):
        raise data.error("blades", f"{blades:g} is no whole number", "count them")
    turned = None if frame == axis_along(AXES["x"]) else frame
    name = data.text("name", source.stem or "row")

    def row(scale: float, tip: float = 0.0, foot: float = 0.0) -> Row:
        blade = tuple(points * scale for points in profiles)
        gaps = tip * scale, foot * scale
        return Row(blade, hub * scale, shroud * scale, int(blades), *gaps, name, notes, turned, unit)

    @cache
    def span() -> float:
        return row_dimensions(row(UNITS[unit])).span

    gaps: tuple[float, ...] = ()
    with _located(places):
        try:
            gaps = tuple(_gap(data, key, span) for key in ("tip_gap", "hub_gap"))
            return row(UNITS[unit], *gaps)
        except InputError:
            row(1.0, *gaps)  # so that the message has the numbers of the files
            raise


@contextmanager
def _located(places: Sequence[str]) -> Iterator[None]:
    """Add to errors of a profile where it is given."""
    try:
        yield
    except InputError as error:
        match = _PROFILE.fullmatch(error.place)
        if match:
            error.place += f" ({places[int(match[1]) - 1]})"
        raise


def _frame(data: Table) -> Motion:
    """Return what turns points of a file so that the axis is along x."""
    if isinstance(data.data.get("axis"), list):
        direction = data.vector("axis")
        if not any(direction):
            raise data.error("axis", "has no direction", "give [dx, dy, dz]")
        return axis_along(direction)
    return axis_along(AXES[data.word("axis", tuple(AXES), "x")])


def _profiles(data: Table, folder: Path, frame: Motion) -> tuple[list[Floats], list[str]]:
    """Return the profiles (n, 3) with the axis along x, and where each is given."""
    polar = data.word("coordinates", ("xyz", "xrt"), "xyz") == "xrt"
    order = "x, r, theta" if polar else "x, y, z"
    files = _files(data, folder)
    with data.in_file_of("profiles"):
        blocks = [block for file in files for block in placed_blocks(file, (order,))]
    profiles = [points for points, _ in blocks]
    if polar:
        most = max(float(np.ptp(points[:, 2])) for points in profiles)
        if most > np.pi:
            raise data.error("coordinates", f"theta of a profile spans {most:.4g}", "give theta in radians")
        columns = [points.T for points in profiles]
        profiles = [np.stack([x, r * cos(theta), r * sin(theta)], axis=1) for x, r, theta in columns]
    else:
        profiles = [frame(points) for points in profiles]
    return profiles, [place for _, place in blocks]


def _files(data: Table, folder: Path) -> list[Source]:
    names = data.data["profiles"]
    names = names if isinstance(names, list) and names else [names]
    if not all(isinstance(name, str) and name for name in names):
        raise data.error("profiles", "are no files", 'name a file, "a.curve", or a list of files')
    return [open_source(str(folder / name)) for name in names]


def _wall(data: Table, key: str, folder: Path, frame: Motion) -> Floats:
    """Return x, r (n, 2) of hub or shroud, a file or a list."""
    if isinstance(data.data.get(key), list):
        return np.array(data.pairs(key, least=2))
    name = data.data.get(key)
    if not isinstance(name, str) or not name:
        problem = "is missing" if name is None else "is no file and no list of points"
        raise data.error(key, problem, "name a file, or give [[x, r], [x, r]]")
    with data.in_file_of(key):
        source = open_source(str(folder / name))
        blocks = point_blocks(source, ("x, y, z", "x, r"))
        if len(blocks) > 1 and any(len(block) > 1 for block in blocks[1:]):
            raise InputError(f"holds {len(blocks)} blocks of points", "give one curve", source=source.name)
    points = blocks[0]
    if points.shape[1] == 2:
        return points
    x, y, z = frame(points).T
    return np.stack([x, np.hypot(y, z)], axis=1)


def _plane(data: Table, key: str) -> Plane | None:
    """Return where inlet or outlet is: along the axis, or through points on hub and shroud."""
    value = data.data.get(key)
    if value is None:
        return None
    if not isinstance(value, list):
        return data.number(key)
    if len(value) != 2 or not all(isinstance(point, list) and len(point) == 2 for point in value):
        raise data.error(key, f"{value!r} is no plane", "give x, or [[x, r], [x, r]] on hub and shroud")
    ends = [Table({key: point}, data.place).pair(key, (0.0, 0.0)) for point in value]
    return ends[0], ends[1]


def _gap(data: Table, key: str, span: Callable[[], float]) -> float:
    """Return a gap, given as a length or as a percentage of the span."""
    value = data.data.get(key, 0.0)
    if isinstance(value, str):
        match = _PERCENT.fullmatch(value)
        try:
            part = float(match[1]) if match else math.nan
        except ValueError:
            part = math.nan
        if not 0.0 <= part < 50.0:
            raise data.error(key, f"{value!r} is no part of the span", 'give a length as a number, or "1 %"')
        return 0.01 * part * span() if part else 0.0
    gap = data.number(key, 0.0)
    if gap < 0.0:
        raise data.error(key, f"{gap:g} is negative", "use 0 or more")
    return gap


def _section(row: Table, folder: Path) -> tuple[Floats, tuple[str, ...]]:
    """Return the profile (n, 3) of an airfoil on a cylinder, and notes."""
    row.only("airfoil", "outline", "chord", "radius", "stagger", "about", "x", "theta")
    section = Section(section_shape(row, folder), row.positive("chord"), row.positive("radius"))
    stagger = row.number("stagger")
    if abs(stagger) > _STEEPEST:
        raise row.error("stagger", f"{stagger:g} degrees", f"use -{_STEEPEST:g} to {_STEEPEST:g}")
    with in_place(row.place):
        return on_cylinder(
            section, row.pair("about", QUARTER), math.radians(stagger), row.number("x", 0.0),
            math.radians(row.number("theta", 0.0)),
        )  # fmt: skip
