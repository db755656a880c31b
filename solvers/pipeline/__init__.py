"""From a boundary to a checked grid: choice of method, coarse solves, fallbacks."""
