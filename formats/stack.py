"""Stacks of cross-sections in TOML, the input of ``meshonet stack``.

::

    kind = "wing"              # wing, blade or duct
    tip = "round"              # tip of a wing: round, flat or open
    between = "linear"         # interpolation: linear, or smooth by cubics through three or more sections
    tip_spacing = 0.001        # length of a wing's last cells along the span, in chords of the last section
    le_spacing = 0.002         # length of cells at leading edges, in chords of each section
    te_spacing = 0.001         # length of cells at trailing edges, likewise
    cant = "panel"             # cant of all sections but the root; default: 0, planes of constant z

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
    nodes = 21                 # along the span from the previous section on; default: as the whole span needs
    cant = 5                   # degrees about the chord line; or "panel": the mean dihedral of both panels

With ``kind = "row"`` it is a row of blades (`meshonet.formats.rows.read`), with ``kind = "aircraft"`` a body
with wings (`meshonet.formats.aircraft`).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from meshonet.formats.source import Source, open_source
from meshonet.formats.stack_table import stack_table
from meshonet.formats.toml_table import toml_table
from meshonet.geometry.errors import in_source
from meshonet.geometry.sections.stack import KINDS, Stack

if TYPE_CHECKING:
    from meshonet.geometry.aircraft.aircraft import Aircraft
    from meshonet.geometry.rows.row import Row


def stack_of(text: str) -> Stack | Row | Aircraft:
    """Return the stack, row or aircraft of a file, or of standard input for ``-``.

    Raises InputError, with the place: a file that cannot be read or is not TOML; an unknown key; an invalid
    value; a section whose file has no airfoil or closed curve.
    """
    return read_stack(open_source(text))


def read_stack(source: Source) -> Stack | Row | Aircraft:
    """Return the stack, row or aircraft of a source (see `stack_of`)."""
    with in_source(source.name):
        data = toml_table(source)
        kind = data.word("kind", (*KINDS, "row", "aircraft"), "wing")
        if kind == "row":
            from meshonet.formats.rows.read import read_row  # which wings do not need, nor aircraft

            return read_row(data, source)
        if kind == "aircraft":
            from meshonet.formats.aircraft import read_aircraft

            return read_aircraft(data, source)
        for key, what in (("blades", "row"), ("bodies", "aircraft")):
            if "kind" not in data.data and key in data.data:
                raise data.error("kind", f"is missing, and a wing has no {key}", f'write kind = "{what}"')
        return stack_table(data, source.path.parent if source.path else Path(), source.stem or "stack")
