"""HDF5 datasets of many boundaries or grids of the same size (docs/reference/hdf5.md)."""
