"""From a shape to a checked grid: choice of method, coarse solves, first cells, repair."""
