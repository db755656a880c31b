"""The capabilities of all formats as a table."""

from meshonet.formats.format import Format
from meshonet.formats.table import TABLE

_HEAD = ("format", "endings", "reads", "writes", "names", "3D", "blocks", "many", "what it is", "options")
"""Headings of the columns of the table."""


def rows() -> list[dict[str, str]]:
    """Return one row for each file format: a dictionary from column heading to text."""
    return [dict(zip(_HEAD, _row(record), strict=True)) for record in TABLE.values()]


def _row(record: Format) -> tuple[str, ...]:
    return (
        record.name,
        " ".join(record.suffixes),
        _what(record.read_grids, record.read_shapes),
        _what(record.write_grids, record.write_boundaries, record.write_layouts),
        "yes" if record.names_patches else "",
        ", ".join(record.space),
        record.blocks,
        "yes" if record.many else "",
        record.description,
        " ".join("/".join(row) for row in record.choices),
    )


def _what(*functions: object) -> str:
    words = zip(("grids", "boundaries", "layouts"), functions, strict=False)
    return ", ".join(word for word, can in words if can)
