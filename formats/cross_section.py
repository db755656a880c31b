"""Cross-sections for sweeping: closed curves, domains, layouts, and planar grids, which stay unchanged."""

from collections.abc import Iterator

from meshonet.formats.registry import format_of, is_designation, read_grids, read_shapes
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.shapes.shape import Shape


def read_sections(text: str, fmt: str | None = None) -> Iterator[Grid | Shape]:
    """Yield the planar grids of a file if its format contains grids, otherwise the shapes that it describes.

    `text` is a path or a designation such as ``naca:0012`` or ``circle:0.5``; designations and layouts yield
    shapes. `fmt` is the name of the file's format; None: it is recognised by the file's name and content.
    Raises InputError: a file that cannot be read.
    """
    if not is_designation(text):
        record = format_of(open_source(text), fmt)
        if record.read_grids is not None and record.name != "layout":
            return iter(read_grids(text, fmt))
    return iter(read_shapes(text, fmt))
