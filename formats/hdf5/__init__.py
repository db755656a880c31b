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
