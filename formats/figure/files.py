"""Pictures of a grid in files: ``.png``, ``.svg``, ``.pdf``."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import BinaryIO

from meshonet.formats.figure.figure import draw
from meshonet.formats.figure.layers import DOTS, Colouring
from meshonet.formats.figure.space import draw_in_space
from meshonet.formats.figure.view import View, check_flat, flat_box
from meshonet.formats.format import only_one
from meshonet.geometry.blocks.grid import Grid

_WHOLE = View()
"""A view of the whole grid."""


def write(
    path: Path | BinaryIO,
    grid: Grid,
    kind: str = "png",
    colouring: Colouring | None = None,
    view: View = _WHOLE,
    dots: int = DOTS,
) -> None:
    """Draw `grid` into a file of `kind` ``png``, ``svg`` or ``pdf``; the same input gives the same bytes.

    Raises InputError: a view that shows nothing, or that grids in the plane do not have.
    """
    import matplotlib as mpl

    dates: dict[str, dict[str, str | None]] = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with mpl.rc_context({"svg.hashsalt": "meshonet", "svg.fonttype": "none"}):
        if grid.form == "plane":
            check_flat(view)
            figure = draw(grid, colouring, flat_box(view.zoom), view.every)
        else:
            figure = draw_in_space(grid, colouring, view)
        figure.savefig(path, format=kind, dpi=dots, metadata=dates.get(kind))


def write_grids(path: Path, grids: Iterable[Grid], *, kind: str) -> None:
    """Draw the only grid of `grids`, lines only."""
    write(path, only_one(grids, f"a .{kind} file"), kind)
