"""CGNS files in HDF5: structured zones."""

from meshonet.formats.cgns.nodes import is_adf
from meshonet.formats.format import Format, later


def sniff(head: bytes) -> bool:
    """Say whether `head` is of a CGNS file, of either kind of container."""
    return is_adf(head) or (head.startswith(b"\x89HDF\r\n\x1a\n") and b"HDF5 MotherNode" in head)


FORMATS = (
    Format(
        name="cgns",
        suffixes=(".cgns",),
        description="CGNS structured zones in HDF5, with boundary conditions and families",
        read_grids=later(f"{__name__}.read:read_grids"),
        write_grids=later(f"{__name__}.write:write_grids"),
        write_extruded=later(f"{__name__}.write:write_extruded"),
        sniff=sniff,
        names_patches=True,
        many=True,
    ),
)
