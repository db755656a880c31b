"""Stacks of sections in TOML: what ``meshonet stack`` reads.

::

    kind = "wing"              # wing, blade or duct
    tip = "round"              # of a wing: round, flat or open
    between = "linear"         # or smooth: cubics through three and more sections

    [[sections]]               # the root
    airfoil = "naca:2412"      # or a file, looked for beside this one
    chord = 1.0                # in any unit, which is that of the grid
    z = 0.0                    # along the span

    [[sections]]
    airfoil = "tip.dat"
    chord = 0.5
    twist = -2.0               # degrees, nose up
    about = 0.25               # chords behind the leading edge; [x, y] also sets a height
    z = 3.0
    sweep = 20                 # degrees of the leading edge from the section before; or x = 1.09
    dihedral = 5               # degrees, likewise; or y = 0.26
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from meshonet.formats.registry import is_designation, read_shapes
from meshonet.formats.source import Source, open_source, printable
from meshonet.geometry.errors import InputError, in_source
from meshonet.geometry.sections.section import QUARTER, Section
from meshonet.geometry.sections.stack import Stack
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline

_OF_STACK = ("kind", "tip", "between", "name", "about", "sections")
_OF_SECTION = ("airfoil", "outline", "chord", "z", "x", "y", "twist", "about", "sweep", "dihedral")


def stack_of(text: str) -> Stack:
    """Return the stack of a file, or of standard input for ``-``.

    Raises InputError: a file that cannot be read or is no TOML; a key that is not known, or a value that does
    not fit, with its place; a section's file that holds no airfoil or closed curve.
    """
    return read_stack(open_source(text))


def read_stack(source: Source) -> Stack:
    """Return the stack of a source (see `stack_of`)."""
    with in_source(source.name):
        try:
            data = tomllib.loads(source.read_bytes().decode("utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
            problem = f"is no TOML ({printable(str(error))})"
            raise InputError(problem, "see meshonet stack --help for an example") from None
        folder = source.path.parent if source.path else Path()
        return _stack(data, folder, source.stem)


def _stack(data: Mapping[str, Any], folder: Path, stem: str) -> Stack:
    _known(data, _OF_STACK, "")
    rows = data.get("sections")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows) or len(rows) < 2:
        raise InputError("has fewer than two", "give a table [[sections]] for each", place="sections")
    about = _about(data, "", QUARTER)
    sections: list[Section] = []
    for k, row in enumerate(rows):
        place = f"sections[{k}]"
        try:
            sections.append(_section(row, f"{place}.", about, sections[-1:], folder))
        except InputError as error:
            if not error.source and not error.place.startswith(place):
                error.place = f"{place}.{error.place}" if error.place else place
            raise
    words = {key: _text(data, key, "") for key in ("kind", "tip", "between", "name") if key in data}
    return Stack(tuple(sections), **{"name": stem, **words})  # type: ignore[arg-type]


def _section(
    row: Mapping[str, Any], at: str, about: tuple[float, float], before: list[Section], folder: Path
) -> Section:
    _known(row, _OF_SECTION, at)
    z = _number(row, "z", at)
    x, y = (_along(row, direct, angle, at, z, before) for direct, angle in (("x", "sweep"), ("y", "dihedral")))
    chord, twist = _number(row, "chord", at), _number(row, "twist", at, 0.0)
    shape = _shape(row, at, folder)
    return Section(shape, chord, z, x, y, twist, _about(row, at, about))


def _along(
    row: Mapping[str, Any], direct: str, angle: str, at: str, z: float, before: list[Section]
) -> float:
    """Return x or y of a section: its own, or by the angle of the line from the section before."""
    if angle not in row:
        return _number(row, direct, at, getattr(before[0], direct) if before else 0.0)
    if direct in row:
        raise InputError(f"has both {direct} and {angle}", "give one of them", place=at + angle)
    if not before:
        raise InputError("there is no section before", f"give {direct}", place=at + angle)
    degrees = _number(row, angle, at)
    if not abs(degrees) < 89:
        raise InputError(f"{degrees:g} degrees", "use more than -89 and less than 89", place=at + angle)
    return float(getattr(before[0], direct) + (z - before[0].z) * math.tan(math.radians(degrees)))


def _shape(row: Mapping[str, Any], at: str, folder: Path) -> Airfoil | Outline:
    keys = [key for key in ("airfoil", "outline") if key in row]
    if len(keys) != 1:
        problem = "has both airfoil and outline" if keys else "has no airfoil"
        raise InputError(problem, "name one file, or a designation such as naca:2412", place=at + "airfoil")
    text = _text(row, keys[0], at)
    beside = folder / text
    name = text if is_designation(text) or not text or Path(text).is_absolute() else str(beside)
    try:
        shapes = list(read_shapes(name))
    except InputError as error:
        error.place = ": ".join(filter(None, (error.source, error.place)))
        error.source = ""
        raise InputError(
            f"{error.place}: {error.problem}" if error.place else error.problem,
            error.remedy,
            place=at + keys[0],
        ) from None
    curves = [shape for shape in shapes if isinstance(shape, Airfoil | Outline)]
    if len(shapes) != 1 or len(curves) != 1:
        problem = f"{printable(text)} holds {len(shapes)} shapes" if len(shapes) != 1 else f"{text} is none"
        raise InputError(problem, "give a file with one airfoil or closed curve", place=at + keys[0])
    return curves[0]


def _known(row: Mapping[str, Any], keys: Collection[str], at: str) -> None:
    for key in row:
        if key not in keys:
            raise InputError("is not known", "use " + ", ".join(keys), place=at + printable(key))


def _number(row: Mapping[str, Any], key: str, at: str, default: float | None = None) -> float:
    value = row.get(key, default)
    if value is None:
        raise InputError("is missing", "give a number", place=at + key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f"{printable(repr(value))[:40]} is no number", "give one", place=at + key)
    try:
        return float(value)
    except OverflowError:
        raise InputError("is far too large", "give a finite number", place=at + key) from None


def _text(row: Mapping[str, Any], key: str, at: str) -> str:
    value = row[key]
    if not isinstance(value, str) or not value:
        raise InputError(f"{printable(repr(value))[:40]} is no text", "write it in quotes", place=at + key)
    return value


def _about(row: Mapping[str, Any], at: str, default: tuple[float, float]) -> tuple[float, float]:
    value = row.get("about", list(default))
    pair = value if isinstance(value, list) else [value, 0.0]
    if len(pair) != 2:
        raise InputError(f"has {len(pair)} numbers", "give x, or [x, y], in chords", place=at + "about")
    x, y = (_number({"about": each}, "about", at) for each in pair)
    return x, y
