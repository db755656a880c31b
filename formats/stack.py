"""Stacks of cross-sections in TOML, the input of ``meshonet stack``.

::

    kind = "wing"              # wing, blade or duct
    tip = "round"              # tip of a wing: round, flat or open
    between = "linear"         # interpolation: linear, or smooth by cubics through three or more sections
    tip_spacing = 0.001        # length of a wing's last cells along the span, in chords of the last section
    le_spacing = 0.002         # length of cells at leading edges, in chords of each section
    te_spacing = 0.001         # length of cells at trailing edges, likewise

    [[sections]]               # the root
    airfoil = "naca:2412"      # or a file, relative to the folder of this one
    chord = 1.0                # in the unit of the grid
    z = 0.0                    # position along the span

    [[sections]]
    airfoil = "tip.dat"
    chord = 0.5
    twist = -2.0               # degrees, positive nose up
    about = 0.25               # centre of the twist, in chords behind the leading edge; or [x, y]
    z = 3.0
    sweep = 20                 # sweep of the leading edge from the previous section in degrees; or x = 1.09
    dihedral = 5               # dihedral from the previous section in degrees; or y = 0.26

With ``kind = "row"`` it is a row of blades (`meshonet.formats.rows.read`).
"""

from __future__ import annotations

import math
from pathlib import Path

from meshonet.formats.rows.read import read_row
from meshonet.formats.section_shape import section_shape
from meshonet.formats.source import Source, open_source
from meshonet.formats.toml_table import Table, toml_table
from meshonet.geometry.errors import in_source
from meshonet.geometry.rows.row import Row
from meshonet.geometry.sections.section import QUARTER, Section
from meshonet.geometry.sections.stack import BETWEEN, KINDS, TIPS, Stack

_SPACINGS = "tip_spacing", "le_spacing", "te_spacing"
_STEEPEST = 85.0
"""Largest sweep and dihedral in degrees; at 90 the next section would be infinitely far away."""


def stack_of(text: str) -> Stack | Row:
    """Return the stack or the row of a file, or of standard input for ``-``.

    Raises InputError, with the place: a file that cannot be read or is not TOML; an unknown key; an invalid
    value; a section whose file has no airfoil or closed curve.
    """
    return read_stack(open_source(text))


def read_stack(source: Source) -> Stack | Row:
    """Return the stack or the row of a source (see `stack_of`)."""
    with in_source(source.name):
        data = toml_table(source)
        kind = data.word("kind", (*KINDS, "row"), "wing")
        if kind == "row":
            return read_row(data, source)
        if "kind" not in data.data and "blades" in data.data:
            raise data.error("kind", "is missing, and a wing has no blades", 'write kind = "row"')
        data.only("kind", "tip", "between", *_SPACINGS, "name", "about", "sections")
        about = data.pair("about", QUARTER)
        sections: list[Section] = []
        for row in data.rows("sections", least=2):
            sections.append(_section(row, about, sections, source.path.parent if source.path else Path()))
        return Stack(
            tuple(sections),
            kind=kind,  # type: ignore[arg-type]
            tip=data.word("tip", TIPS, "round"),  # type: ignore[arg-type]
            between=data.word("between", BETWEEN, "linear"),  # type: ignore[arg-type]
            **{key: data.number(key) for key in _SPACINGS if key in data.data},
            name=data.text("name", source.stem or "stack"),
        )


def _section(row: Table, about: tuple[float, float], before: list[Section], folder: Path) -> Section:
    row.only("airfoil", "outline", "chord", "z", "x", "y", "twist", "about", "sweep", "dihedral")
    z = row.number("z")
    if before and not z > before[-1].z:
        raise row.error("z", f"{z:g} is not behind {before[-1].z:g}", "give sections in order of z")
    return Section(
        section_shape(row, folder),
        row.positive("chord"),
        z,
        _along(row, "x", "sweep", z, before),
        _along(row, "y", "dihedral", z, before),
        row.number("twist", 0.0),
        row.pair("about", about),
    )


def _along(row: Table, direct: str, angle: str, z: float, before: list[Section]) -> float:
    """Return x or y of a section: the given value, or that given by an angle to the previous section."""
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
