"""Models that are trained on solved grids, one a file, written once for numpy and torch."""
