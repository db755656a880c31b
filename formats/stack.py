"""Stacks of cross-sections in TOML, the input of ``meshonet stack`` (docs/guide/wings.md)."""

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
    """Return the stack, blade row or aircraft in a TOML file, or in standard input for ``-``.

    Raises InputError, with the place: not TOML; an unknown key; an invalid value; a section without a shape.
    """
    return read_stack(open_source(text))


def read_stack(source: Source) -> Stack | Row | Aircraft:
    """Return the stack, blade row or aircraft in a TOML source; errors as `stack_of`."""
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
