"""HDF5 datasets of many boundaries or grids of the same size.

::

    attributes   format = "meshonet-boundary" or "meshonet-grid", version = 1, topology
    south, north (n, ni, 2)   west, east (n, nj, 2)   float64, including the corner nodes
    nodes        (n, ni, nj, 2), grids only
    names, split, parts, provenance   (n,) text, optional
    parameters   (n, p), with their names (p,) as attribute
    sensors      (n, m, 2), selected boundary nodes, optional

All datasets are resizable along n. A chunk contains one sample, or several small samples. `parts`, a list of
``[name, side, start, stop]``, and `provenance` are JSON. Facts that are the same in all provenances are also
attributes of the file, where they are easy to read. Multi-block and three-dimensional grids have version 2::

    attributes   format = "meshonet-grid", version = 2, connections (JSON)
    blocks/0, blocks/1 ...   (n, ni, nj, 2), (n, ni, nj, nk, 3) or (n, ni, nj, 3)
    parts        rows are [name, side, start, stop, block, across, kind]

These replace the edges, `nodes` and the topology. https://docs.h5py.org
"""
