"""VTK's files: XML structured grids, single and as blocks, legacy structured grids, unstructured grids."""

from meshonet.formats.format import Format, Options, later


def is_vts(head: bytes) -> bool:
    """Say whether `head` is the start of a ``.vts`` file."""
    return b"<VTKFile" in head[:2048] and b"StructuredGrid" in head[:4096]


def is_vtm(head: bytes) -> bool:
    """Say whether `head` is the start of a ``.vtm`` file."""
    return b"<VTKFile" in head[:2048] and b"vtkMultiBlockDataSet" in head[:4096]


def is_legacy(head: bytes) -> bool:
    """Say whether `head` is the start of a legacy VTK file."""
    return head.startswith(b"# vtk DataFile")


def _legacy(options: Options = frozenset()) -> Format:
    return Format(
        name="vtk",
        suffixes=(".vtk",),
        description="legacy VTK structured grid",
        read_grids=later(f"{__name__}.legacy:read_grids"),
        write_grids=later(f"{__name__}.legacy:write_grids", options=options),
        write_extruded=later(f"{__name__}.legacy:write_extruded", options=options),
        sniff=is_legacy,
        names_patches=True,
        choices=(("binary", "ascii"),),
        variant=_legacy,
    )


FORMATS = (
    Format(
        name="vts",
        suffixes=(".vts",),
        description="VTK XML structured grid",
        read_grids=later(f"{__name__}.vts_read:read_grids"),
        write_grids=later(f"{__name__}.vts:write_grids"),
        write_extruded=later(f"{__name__}.vts:write_extruded"),
        sniff=is_vts,
        names_patches=True,
    ),
    Format(
        name="vtm",
        suffixes=(".vtm",),
        description="VTK multi-block file: an index and a folder of .vts",
        read_grids=later(f"{__name__}.vtm:read_grids"),
        write_grids=later(f"{__name__}.vtm:write_grids"),
        write_extruded=later(f"{__name__}.vtm:write_extruded"),
        sniff=is_vtm,
        names_patches=True,
        many=True,
        beside=True,
    ),
    _legacy(),
    Format(
        name="vtu",
        suffixes=(".vtu",),
        description="VTK XML unstructured grid, seams merged, patches by number",
        write_grids=later(f"{__name__}.vtu:write_grids"),
        write_extruded=later(f"{__name__}.vtu:write_extruded"),
    ),
)
