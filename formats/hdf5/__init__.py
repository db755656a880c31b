"""HDF5: datasets of boundaries and grids, and what CGNS needs of it."""

from meshonet.formats.format import Format, later


def sniff(head: bytes) -> bool:
    """Say whether `head` starts as HDF5 files do; those of CGNS have a reader of their own."""
    return head.startswith(b"\x89HDF\r\n\x1a\n") and b"HDF5 MotherNode" not in head


FORMATS = (
    Format(
        name="hdf5",
        suffixes=(".h5", ".hdf5"),
        description="HDF5 dataset of boundaries or grids",
        read_shapes=later(f"{__name__}.dataset:read_shapes"),
        read_grids=later(f"{__name__}.dataset:read_grids"),
        write_grids=later(f"{__name__}.dataset:write_grids"),
        write_boundaries=later(f"{__name__}.dataset:write_boundaries"),
        sniff=sniff,
        names_patches=True,
        many=True,
        one_size=True,
    ),
)
