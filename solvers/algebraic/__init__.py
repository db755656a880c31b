"""Algebraic grids: transfinite interpolation, and coarse grids evaluated on finer ones."""
