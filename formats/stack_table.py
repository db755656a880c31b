"""The sections of a wing, fin, blade or duct in a table of TOML (docs/guide/wings.md)."""

import math
from pathlib import Path
from typing import Any

from meshonet.formats.registry import is_designation, read_shapes
from meshonet.formats.source import printable
from meshonet.formats.toml_table import Table
from meshonet.geometry.sections.section import MOST_CANT, MOST_NODES, QUARTER, Cant, Section
from meshonet.geometry.sections.stack import BETWEEN, KINDS, TIPS, Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline

_SPACINGS = "tip_spacing", "le_spacing", "te_spacing"
_STEEPEST = 85.0  # largest sweep and dihedral in degrees; at 90 the next section would be infinitely far away


def stack_table(data: Table, folder: Path, name: str, more: tuple[str, ...] = ()) -> Stack:
    """Return the stack of sections that a table describes; `more` lists keys that are permitted in addition.

    Paths are relative to `folder`. Raises InputError as `meshonet.formats.stack.stack_of`.
    """
    options = stack_options(data, name, ("about", "cant", *more))
    about, turn = data.pair("about", QUARTER), cant(data, 0.0)
    sections: list[Section] = []
    for row in data.rows("sections", least=2):
        sections.append(_section(row, about, turn if sections else 0.0, sections, folder))
    return Stack(tuple(sections), **options)


def stack_options(data: Table, name: str, more: tuple[str, ...]) -> dict[str, Any]:
    """Return the arguments of `Stack`, except the sections, from a table; `more` lists additional keys.

    Raises InputError if a key or a word is unknown, or if a value is not a number.
    """
    data.only("kind", "tip", "between", *_SPACINGS, "name", "sections", *more)
    words = (("kind", KINDS, "wing"), ("tip", TIPS, "round"), ("between", BETWEEN, "linear"))
    return {
        **{key: data.word(key, known, default) for key, known, default in words},
        **{key: data.number(key) for key in _SPACINGS if key in data.data},
        "name": data.text("name", name),
    }


def _nodes(row: Table) -> int | None:
    """Return the number of nodes of the panel before a section, at least 2."""
    if "nodes" not in row.data:
        return None
    count = row.number("nodes")
    if count != int(count) or not 2 <= count <= MOST_NODES:
        raise row.error("nodes", f"{count:g} nodes", f"use a whole number from 2 to {MOST_NODES}")
    return int(count)


def cant(data: Table, default: Cant) -> Cant:
    """Return the angle in degrees by which a section is turned about x, or the word ``panel``.

    This word means the mean of the wing's dihedral angles on both sides of the section. Without an entry
    ``cant`` in `data`, `default` is returned.
    """
    if "cant" not in data.data or data.data["cant"] == "panel":
        return "panel" if "cant" in data.data else default
    degrees = data.number("cant")
    if abs(degrees) > MOST_CANT:
        remedy = f"use -{MOST_CANT:g} to {MOST_CANT:g}, or panel"
        raise data.error("cant", f"{degrees:g} degrees", remedy)
    return degrees


def _section(
    row: Table, about: tuple[float, float], turn: Cant, before: list[Section], folder: Path
) -> Section:
    row.only(
        "airfoil", "outline", "chord", "z", "x", "y", "twist", "about", "sweep", "dihedral", "cant", "nodes"
    )
    z = row.number("z")
    if before and not z > before[-1].z:
        raise row.error("z", f"{z:g} is not behind {before[-1].z:g}", "give sections in order of z")
    return Section(
        section_shape(row, folder),
        row.positive("chord"),
        z,
        along(row, "x", "sweep", z, before),
        along(row, "y", "dihedral", z, before),
        row.number("twist", 0.0),
        row.pair("about", about),
        cant(row, turn),
        _nodes(row),
    )


def along(row: Table, direct: str, angle: str, z: float, before: list[Section]) -> float:
    """Return x or y of a section at the position `z`, from its table `row` and the sections `before` it.

    The value is that of the key `direct` (``x`` or ``y``), by default that of the previous section. Instead,
    the key `angle` (``sweep`` or ``dihedral``) may give the angle in degrees between the z axis and the line
    from the previous section. Raises InputError: both keys; an angle of the first section, or above 85
    degrees.
    """
    if angle not in row.data:
        return row.number(direct, getattr(before[-1], direct) if before else 0.0)
    if direct in row.data:
        raise row.error(angle, f"stands beside {direct}", "give one of them")
    if not before:
        raise row.error(angle, "there is no section before", f"give {direct}")
    degrees = row.number(angle)
    if abs(degrees) > _STEEPEST:
        raise row.error(angle, f"{degrees:g} degrees", f"use -{_STEEPEST:g} to {_STEEPEST:g}")
    return float(getattr(before[-1], direct) + (z - before[-1].z) * math.tan(math.radians(degrees)))


def section_shape(row: Table, folder: Path) -> Airfoil | Outline:
    """Return the shape of a section from its table; paths are relative to `folder`.

    Raises InputError: not exactly one of the keys `airfoil` and `outline`; a file without exactly one shape.
    """
    keys = [key for key in ("airfoil", "outline") if key in row.data]
    remedy = "name one file, or a designation such as naca:2412"
    if len(keys) != 1:
        problem = "stands beside outline" if keys else "is missing"
        raise row.error("airfoil", problem, remedy)
    text = row.text(keys[0])
    if not is_designation(text) and (folder / text).exists() and not (folder / text).is_file():
        raise row.error(keys[0], f"{printable(text)} is no regular file", remedy)
    with row.in_file_of(keys[0]):
        shapes = list(read_shapes(text if is_designation(text) else str(folder / text)))
    if len(shapes) != 1 or not isinstance(shapes[0], Airfoil | Outline):
        raise row.error(keys[0], f"{printable(text)} is not one airfoil or closed curve", remedy)
    shape = shapes[0]
    shape.notes = tuple(type(note)(f"{printable(text)}: {note}") for note in shape.notes)
    return shape
