"""The airfoil or closed curve of a section that a table of TOML describes."""

from pathlib import Path

from meshonet.formats.registry import is_designation, read_shapes
from meshonet.formats.source import printable
from meshonet.formats.toml_table import Table
from meshonet.geometry.shapes.airfoil.airfoil import Airfoil
from meshonet.geometry.shapes.outline import Outline


def section_shape(row: Table, folder: Path) -> Airfoil | Outline:
    """Return the shape in the table of a section; paths are relative to `folder`.

    Raises InputError: not exactly one of the keys; a file without one airfoil or closed curve.
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
