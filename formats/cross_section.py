"""Cross-sections for sweeping: closed curves, domains, layouts, and planar grids, which stay unchanged."""

from collections.abc import Iterator

from meshonet.formats.registry import format_of, is_designation, read_grids, read_shapes
from meshonet.formats.source import open_source
from meshonet.geometry.blocks.grid import Grid
from meshonet.geometry.shapes.shape import Shape


def read_sections(text: str, fmt: str | None = None) -> Iterator[Grid | Shape]:
    """Yield the planar grids of a file, or the shapes of a file or designation without grids.

    `text` is a path or designation, ``naca:0012``. Layouts yield shapes. `fmt` is the format's name; None: it
    is recognised by name and content. Raises InputError: the file cannot be read.
    """
    if not is_designation(text):
        record = format_of(open_source(text), fmt)
        if record.read_grids is not None and record.name != "layout":
            return iter(read_grids(text, fmt))
    return iter(read_shapes(text, fmt))
