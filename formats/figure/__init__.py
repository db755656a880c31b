"""Pictures of grids, drawn by matplotlib."""

from meshonet.formats.format import Format, later

_PICTURES = {"png": "picture of a grid"} | dict.fromkeys(
    ("svg", "pdf"), "picture of a grid, lines as vectors"
)

FORMATS = tuple(
    Format(
        name=kind,
        suffixes=(f".{kind}",),
        description=description,
        write_grids=later(f"{__name__}.figure:write_grids", kind=kind),
    )
    for kind, description in _PICTURES.items()
)
