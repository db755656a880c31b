"""HDF5 datasets of many boundaries or grids of one size.

::

    attributes   format = "meshonet-boundary" or "meshonet-grid", version = 1, topology
    south, north (n, ni, 2)   west, east (n, nj, 2)   float64, corners shared
    nodes        (n, ni, nj, 2), grids only
    names, split, parts, provenance   (n,) text, where there is any
    parameters   (n, p), its attribute names (p,)
    sensors      (n, m, 2), sub-sampled boundary nodes, when they are wanted

Everything is chunked by sample, or by a few where these are small, and resizable along n. `parts`, a list of
``[name, side, start, stop]``, and `provenance` are JSON; the first grid's provenance stands in the file's
attributes too, for reading by eye. Grids of several blocks, or of blocks in space, have version 2::

    attributes   format = "meshonet-grid", version = 2, connections (JSON)
    blocks/0, blocks/1 ...   (n, ni, nj, 2), (n, ni, nj, nk, 3) or (n, ni, nj, 3)
    parts        rows are [name, side, start, stop, block, across, kind]

in place of the edges, `nodes` and the topology. https://docs.h5py.org
"""

from meshonet.formats.format import Format, later


def sniff(head: bytes) -> bool:
    """Say whether `head` starts as HDF5 files do; those of CGNS have a reader of their own."""
    return head.startswith(b"\x89HDF\r\n\x1a\n") and b"HDF5 MotherNode" not in head


FORMATS = (
    Format(
        name="hdf5",
        suffixes=(".h5", ".hdf5"),
        description="HDF5 dataset of boundaries or grids",
        read_shapes=later(f"{__name__}.read:read_shapes"),
        read_grids=later(f"{__name__}.read:read_grids"),
        write_grids=later(f"{__name__}.write:write_grids"),
        write_boundaries=later(f"{__name__}.write:write_boundaries"),
        sniff=sniff,
        names_patches=True,
        many=True,
        one_size=True,
    ),
)
