"""Datasets of many boundaries or grids in HDF5."""
