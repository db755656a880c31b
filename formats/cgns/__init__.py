"""CGNS files in HDF5."""
