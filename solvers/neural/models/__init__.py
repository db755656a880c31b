"""Models that are trained on solved grids, written once for numpy and torch."""
