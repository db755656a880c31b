"""CGNS files in HDF5: structured zones."""
