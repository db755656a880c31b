"""A comparison of programs that make structured grids: shapes by seed, judge, files; NumPy and h5py alone."""
